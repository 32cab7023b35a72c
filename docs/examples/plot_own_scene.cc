// A scene of one's own, with a picture of it: two ways for a coin to roll to where it shall be.
//
// Link with carnot::shooting and carnot::plots. Writes coin.png, or the file that is named.
#include <carnot/make_dynamics.h>
#include <carnot/plots/curves_of.h>
#include <carnot/scene/body.h>
#include <carnot/shooting/find_geodesics.h>

#include <cmath>
#include <iostream>
#include <numbers>

// An upright coin of mass 1 and radius 1 that rolls on a table without slipping: the point of
// contact (x, y), the heading theta, the angle phi it has turned about its axle.
struct Coin {
  static constexpr int kDof = 4;
  static constexpr int kMultipliers = 2;

  template <class T>
  carnot::Matrix<T, 4, 4> mass(const carnot::Vector<T, 4>& /*q*/) const {
    return carnot::diagonal<T>(1, 1, 0.25, 0.5);
  }

  // x' = phi' cos theta, y' = phi' sin theta.
  template <class T>
  carnot::Matrix<T, 2, 4> constraints(const carnot::Vector<T, 4>& q) const {
    using std::cos, std::sin;
    carnot::Matrix<T, 2, 4> g;
    g << 1, 0, 0, -cos(q[2]), 0, 1, 0, -sin(q[2]);
    return g;
  }

  // Without info() the picture shows q1, ..., q4 over time, and is titled Coin.
  carnot::SceneInfo info() const {
    constexpr double kTurn = 2 * std::numbers::pi;
    carnot::SceneInfo info;
    info.name = "coin";
    info.configuration = {
        {"x", "radius"}, {"y", "radius"}, {"theta", "rad", kTurn}, {"phi", "rad", kTurn}};
    info.drawing = {.view = carnot::Drawing::View::kPlane,
                    .body =
                        [](const double* q) {
                          constexpr double kShown = 0.15;  // of the radius
                          return std::vector{carnot::wheel({q[0], q[1]}, q[2], kShown)};
                        },
                    .glyph = "coin from above, small"};
    return info;
  }
};

int main(int argc, char** argv) {
  const carnot::BoundaryValueProblem problem(
      carnot::make_dynamics(Coin{}), {0, 0, 0, 0}, {1, 0.5, 1, 2});
  carnot::GeodesicOptions options;
  options.count = 2;
  const carnot::GeodesicReport report = carnot::find_geodesics(problem, options);
  if (report.geodesics.empty()) {
    std::cerr << report.message << '\n';
    return 1;
  }

  const std::string file = argc > 1 ? argv[1] : "coin.png";
  const auto curves = carnot::plots::curves_of(report.geodesics);
  carnot::plots::write_figure(file, problem.dynamics.info, curves);

  std::cout << curves.size() << " geodesics in " << file << '\n';
}
