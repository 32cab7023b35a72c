// Other people's solvers of boundary-value problems for `carnot benchmark --boundary-value`,
// `--limits` and `--drift`.
#pragma once

#include <vector>

#include "benchmark/benchmark_boundary.h"
#include "benchmark/benchmark_direct.h"

namespace carnot::apps {

// ipopt and gsl-hybridsj.
std::vector<BoundarySolver> boundary_peers();

// ipopt.
DirectSolver direct_peer();

// Ipopt on the direct midpoint transcription: q holds the nodes, (intervals + 1) x n, of a path
// whose ends stay and whose other nodes keep to the limits of the problem. The action of the
// transcription where Ipopt says that it has solved it.
std::optional<double> solve_with_ipopt(const BoundaryValueProblem& problem, std::vector<double>& q);

// Powell's hybrid method of the GNU Scientific Library, as in MINPACK, on q(T; p0) = to with the
// Jacobian of the tangent flow. True where it says that it has converged.
bool solve_with_gsl(const BoundaryValueProblem& problem, std::vector<double>& p0);

}  // namespace carnot::apps
