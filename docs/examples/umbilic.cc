// An umbilic of an ellipsoid by ten steps: kept by the midpoint rule, broken by an explicit method.
//
// The conjugate points of a point of an ellipsoid of three dimensions form two surfaces, which meet
// at hyperbolic umbilics. There the derivative J = dq(1)/dp(0) has rank one. Three momenta have to
// fulfil three equations for that if J belongs to a symplectic map, and four otherwise (Offen &
// Ober-Bloebaum, arXiv:2107.13853). So a symplectic method has the umbilic, too, a little beside;
// another one has none, however small its error is. The ellipsoid and the point are those of the
// article, the first of its umbilics is looked for.
#include <carnot/load_scene.h>
#include <carnot/plots/isolines.h>
#include <carnot/plots/series_plot.h>
#include <carnot/tableau/own_method.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

// w^2 + 0.9 x^2 + 1.6 z^2 + 1.2 y^2 = 1, with angles u, v, s of a sphere of three dimensions.
const std::string kEllipsoid = R"(coordinates u, v, s [angle]
kinetic = ((-sin(u) cos(v) cos(s) u' - cos(u) sin(v) cos(s) v' - cos(u) cos(v) sin(s) s')^2 +
  (cos(u) cos(v) cos(s) u' - sin(u) sin(v) cos(s) v' - sin(u) cos(v) sin(s) s')^2 / 0.9 +
  (cos(v) cos(s) v' - sin(v) sin(s) s')^2 / 1.6 + cos(s)^2 s'^2 / 1.2) / 2
)";

// The angles of the article's point x = 0.1, y = 0.05, z = 0.2, w > 0.
const double kS = std::asin(0.05 * std::sqrt(1.2));
const double kV = std::asin(0.2 * std::sqrt(1.6) / std::cos(kS));
const std::vector<double> kFrom{
    std::atan2(0.1 * std::sqrt(0.9), std::sqrt(1 - 0.9 * 0.01 - 1.2 * 0.0025 - 1.6 * 0.04)),
    kV,
    kS};

// J of so many steps over the time 1.
Matrix jacobian(const carnot::Dynamics& dynamics, const Vector& p, long steps) {
  std::vector<double> z = kFrom;
  z.insert(z.end(), p.data(), p.data() + 3);
  std::vector<double> m(36);
  if (!dynamics.tangent_flow(carnot::StepPlan::equal(0, 1, steps), z, m).completed()) {
    return Matrix::Constant(std::nan(""));
  }
  return Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(m.data()).topRightCorner<3, 3>();
}

// The momentum near p at which the two small singular values of J are the least: Gauss's and
// Newton's method on the part of J between their singular vectors, with derivatives by differences.
Vector nearest_umbilic(const carnot::Dynamics& dynamics, Vector p, long steps) {
  constexpr int kIterations = 30;
  const double h = 1e-5 * p.norm();
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::JacobiSVD<Matrix> svd(jacobian(dynamics, p, steps),
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
    const auto part = [&](const Vector& at) {
      const Eigen::Matrix2d b = svd.matrixU().rightCols<2>().transpose() *
                                jacobian(dynamics, at, steps) * svd.matrixV().rightCols<2>();
      return Eigen::Vector4d(b.reshaped());
    };
    Eigen::Matrix<double, 4, 3> derivative;
    for (int j = 0; j < 3; ++j) {
      const Vector aside = h * Vector::Unit(j);
      derivative.col(j) = (part(p + aside) - part(p - aside)) / (2 * h);
    }
    p -= derivative.colPivHouseholderQr().solve(part(p));
  }
  return p;
}

// Where det J vanishes, in a plane of momenta through `centre`: along it and across.
carnot::plots::SeriesPanel singular_momenta(const carnot::Dynamics& dynamics,
                                            const Vector& centre,
                                            long steps) {
  constexpr int kHalf = 60;
  const Vector along = centre.normalized();
  const Vector across = along.cross(Vector::UnitX()).normalized();
  std::vector<double> x, y;
  for (int i = -kHalf; i <= kHalf; ++i) {
    x.push_back(0.02 * i / kHalf);
    y.push_back(0.004 * i / kHalf);
  }
  std::vector<double> values;
  for (const double a : x) {
    for (const double b : y) {
      const Vector p = centre + centre.norm() * (a * across + b * along);
      values.push_back(jacobian(dynamics, p, steps).determinant());
    }
  }
  const carnot::plots::Isoline line = carnot::plots::isoline(x, y, values, 0);
  carnot::plots::SeriesPanel panel;
  panel.title = dynamics.method + ", " + std::to_string(steps) + " steps";
  panel.x.label = "momentum across / |p|";
  panel.y.label = "momentum along / |p|";
  panel.series = {{.title = "", .x = line.x, .y = line.y}};
  return panel;
}

}  // namespace

int main(int argc, char** argv) {
  const carnot::TextScene scene = carnot::scene_from_text(kEllipsoid, "ellipsoid");
  const carnot::OwnMethod explicit_rule =
      carnot::own_method({.name = "explicit midpoint", .a = {{0, 0}, {0.5, 0}}, .b = {0, 1}});
  const carnot::Dynamics exact = carnot::make_dynamics(scene);
  const Vector known = nearest_umbilic(exact, {-2.3417, -1.4940, 0.0465}, 64);

  carnot::plots::SeriesPage page;
  page.title = "Momenta of conjugate points near an umbilic of an ellipsoid";
  for (const carnot::Dynamics& dynamics :
       {carnot::make_dynamics(scene, "midpoint"), carnot::make_dynamics(scene, explicit_rule)}) {
    for (const long steps : {10, 20, 40}) {
      const Vector p = nearest_umbilic(dynamics, known, steps);
      const Vector values = jacobian(dynamics, p, steps).jacobiSvd().singularValues();
      const double second = values[1] / values[0];
      char size[16] = "round-off";
      if (second > 1e-12) std::snprintf(size, sizeof size, "%.1e", second);
      std::printf("%-17s  %ld steps: second singular value %s, %.3f away\n",
                  dynamics.method.c_str(),
                  steps,
                  size,
                  (p - known).norm() / known.norm());
      if (steps == 10) page.panels.push_back(singular_momenta(dynamics, p, steps));
    }
  }
  const std::string file = argc > 1 ? argv[1] : "umbilic.png";
  carnot::plots::write_series(file, page);
  std::printf("written: %s\n", file.c_str());
}
