#include "carnot/shooting/manifold.h"

#include <algorithm>

namespace carnot {

bool bring_to_manifold(const Segment& segment, double* q) {
  if (segment.holonomic == 0) return true;
  std::vector<double> z(q, q + segment.dof);
  z.resize(2 * z.size(), 0.0);
  if (!segment.project_on_manifold(0, z.data())) return false;
  std::copy_n(z.begin(), segment.dof, q);
  return true;
}

bool bring_to_manifold(const BoundaryValueProblem& problem, std::vector<double>& p0) {
  if (problem.segment.holonomic == 0) return true;
  std::vector<double> z = problem.from;
  z.insert(z.end(), p0.begin(), p0.end());
  if (!problem.segment.project_on_manifold(0, z.data())) return false;
  p0.assign(z.begin() + problem.segment.dof, z.end());
  return true;
}

}  // namespace carnot
