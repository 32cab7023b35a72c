#include "carnot/shooting/extremal/legendre.h"

#include <Eigen/Core>
#include <vector>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/shoot/survey.h"
#include "carnot/system/system_functions.h"

namespace carnot::internal {

bool satisfies_legendre(const BoundaryValueProblem& problem, const Knots& knots, long steps) {
  constexpr long kSamples = 65;
  constexpr double kRounding = 1e-10;  // of the largest eigenvalue
  const Dynamics& dynamics = problem.dynamics;
  if (dynamics.has_transcription() || dynamics.holonomic > 0) return true;
  const int n = dynamics.dof;
  const void* const system = dynamics.system.get();
  const Trajectory path = samples_of(problem, knots, steps, kSamples);
  std::vector<double> y(kMostAlgebraic * n);
  dynamics.functions->branch(system, y.data());
  std::vector<double> z_dot(2 * n);
  Eigen::MatrixXd jacobian(2 * n, 2 * n);
  for (std::size_t i = 0; i < path.t.size(); ++i) {
    std::vector<double> z = path.q[i];
    z.insert(z.end(), path.p[i].begin(), path.p[i].end());
    const auto evaluated = [&] {
      return dynamics.functions->rate(system, path.t[i], z.data(), y.data(), z_dot.data()) ==
                 RateStatus::kOk &&
             dynamics.functions->jacobian(system, path.t[i], z.data(), y.data(), jacobian.data()) ==
                 RateStatus::kOk;
    };
    if (!evaluated()) continue;  // what can be said is said of the others
    const Eigen::MatrixXd h_pp = jacobian.topRightCorner(n, n);
    const Eigen::VectorXd values = symmetric_eigen(0.5 * (h_pp + h_pp.transpose())).values;
    if (values[0] < -kRounding * values.cwiseAbs().maxCoeff()) return false;
  }
  return true;
}

}  // namespace carnot::internal
