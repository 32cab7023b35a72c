#include "carnot/shooting/problem/manifold.h"

#include <algorithm>

namespace carnot::internal {

bool bring_to_manifold(const Dynamics& dynamics, double* q) {
  if (dynamics.holonomic == 0) return true;
  std::vector<double> z(q, q + dynamics.dof);
  z.resize(2 * z.size(), 0.0);
  if (!dynamics.project_on_manifold(0, z)) return false;
  std::copy_n(z.begin(), dynamics.dof, q);
  return true;
}

bool bring_to_manifold(const BoundaryValueProblem& problem, std::vector<double>& p0) {
  if (problem.dynamics.holonomic == 0) return true;
  std::vector<double> z = problem.from;
  z.insert(z.end(), p0.begin(), p0.end());
  if (!problem.dynamics.project_on_manifold(0, z)) return false;
  p0.assign(z.begin() + problem.dynamics.dof, z.end());
  return true;
}

}  // namespace carnot::internal
