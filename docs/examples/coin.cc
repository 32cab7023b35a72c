#include <carnot/make_dynamics.h>
#include <carnot/shooting/find_geodesics.h>

#include <cmath>
#include <iostream>

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
};

int main() {
  const carnot::BoundaryValueProblem problem(
      carnot::make_dynamics(Coin{}), {0, 0, 0, 0}, {1, 0.5, 1, 2});
  const carnot::GeodesicReport report = carnot::find_geodesics(problem);
  if (report.geodesics.empty()) {
    std::cerr << report.message << '\n';
    return 1;
  }
  const carnot::Geodesic& best = report.geodesics.front();
  std::cout << "action " << best.action << ", p0";
  for (const double p : best.p0) std::cout << ' ' << p;
  std::cout << '\n';
}
