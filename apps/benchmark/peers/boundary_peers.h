// Other people's solvers of boundary-value problems for `carnot benchmark --boundary-value`.
#pragma once

#include <vector>

#include "benchmark/benchmark_boundary.h"

namespace carnot::apps {

// ipopt and gsl-hybridsj.
std::vector<BoundarySolver> boundary_peers();

// Ipopt on the direct midpoint transcription: q holds the nodes, (intervals + 1) x n, of a path
// whose ends stay. True where Ipopt says that it has solved it; `action` is that of the
// transcription.
bool solve_with_ipopt(const Dynamics& dynamics, double h, std::vector<double>& q, double& action);

// Powell's hybrid method of the GNU Scientific Library, as in MINPACK, on q(T; p0) = to with the
// Jacobian of the tangent flow. True where it says that it has converged.
bool solve_with_gsl(const BoundaryValueProblem& problem, std::vector<double>& p0);

}  // namespace carnot::apps
