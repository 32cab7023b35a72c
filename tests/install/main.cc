// A user's own scene in a user's own program, through the whole shooting layer.
//
// Martinet's flat structure with a mass in z: M = I, g = (y^2/2, 0, -1), so z' = y^2 x'/2. No
// frame, no names, no derivatives: only what a scene must have.
#include <carnot/load_scene.h>
#include <carnot/make_dynamics.h>
#include <carnot/shooting/find_geodesics.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <vector>

double smallest_eigenvalue(int n);  // of eigen_user.cc

namespace {

struct Ramp {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  template <class T>
  carnot::Matrix<T, 3, 3> mass(const carnot::Vector<T, 3>& /*q*/) const {
    const T zero = carnot::constant<T>(0);
    const T one = carnot::constant<T>(1);
    carnot::Matrix<T, 3, 3> m;
    m << one, zero, zero, zero, one, zero, zero, zero, one;
    return m;
  }

  template <class T>
  carnot::Matrix<T, 1, 3> constraints(const carnot::Vector<T, 3>& q) const {
    return {
        carnot::constant<T>(0.5) * q[1] * q[1], carnot::constant<T>(0), carnot::constant<T>(-1)};
  }
};

// |q(T) - to| of the extremal by this program's own instance of the flow; a NaN stays one.
double endpoint_error(const carnot::BoundaryValueProblem& problem,
                      const carnot::Geodesic& geodesic) {
  std::vector<double> z = problem.from;
  z.insert(z.end(), geodesic.p0.begin(), geodesic.p0.end());
  const carnot::FlowReport report = problem.dynamics.flow(geodesic.plan, z);
  if (!report.completed()) return INFINITY;
  return std::hypot(z[0] - problem.to[0], z[1] - problem.to[1], z[2] - problem.to[2]);
}

// The same problem from text has the same action.
bool text_agrees(const carnot::BoundaryValueProblem& problem, double action) {
  const carnot::TextScene ramp =
      carnot::scene_from_text("coordinates x, y, z\nmass = diag(1, 1, 1)\n0 = y^2 x' / 2 - z'\n");
  const carnot::GeodesicReport report =
      carnot::find_geodesics({carnot::make_dynamics(ramp), problem.from, problem.to, 1});
  return !report.geodesics.empty() &&
         std::abs(report.geodesics.front().action - action) < 1e-9 * action;
}

}  // namespace

int main() {
  const carnot::BoundaryValueProblem problem(
      carnot::make_dynamics(Ramp{}), {0, 0.5, 0}, {1, 1, 0.4});
  const carnot::GeodesicReport report = carnot::find_geodesics(problem);
  if (report.status != carnot::GeodesicStatus::kConverged || report.geodesics.empty()) {
    std::cerr << "no geodesic: " << report.message << '\n';
    return EXIT_FAILURE;
  }
  const carnot::Geodesic& geodesic = report.geodesics.front();
  const double error = endpoint_error(problem, geodesic);
  std::cout << "action " << geodesic.action << ", endpoint error " << error << ", constraint error "
            << geodesic.constraint_error << '\n';
  // No path is shorter than the straight line, of action |q1 - q0|^2 / 2.
  const bool good = error < 1e-9 && geodesic.action >= 0.5 * (1 + 0.25 + 0.16) &&
                    geodesic.constraint_error < 1e-12 && !geodesic.trajectory.t.empty();
  const bool same = text_agrees(problem, geodesic.action);
  return good && same && smallest_eigenvalue(12) > 0.4 ? EXIT_SUCCESS : EXIT_FAILURE;
}
