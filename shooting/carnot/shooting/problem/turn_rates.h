// How far angles can turn along a path, and so how long a path to an image of the target must be.
//
// Along a path of speed s = sqrt(2 H(q, p)) the inequality of Cauchy and Schwarz for the quadratic
// form H gives
//
//   |q_j'| = |e_j' H_pp p| <= sqrt(2 H(q, e_j)) sqrt(2 H(q, p)) = sqrt(2 H(q, e_j)) s.
//
// The largest sqrt(2 H(q, e_j)) of all q is the rate of coordinate j, and no path to q_j(T) is
// shorter than |q_j(T) - q_j(0)| / rate.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// The rates of the coordinates with a period, in 1 / length; infinite for all others, where nothing
// is known, and where there is a potential. Nothing is known where H(q, e_j) depends on coordinates
// without a period, too, since these go on for ever. Those of the problem start at its `from`, and
// are moved by a few of its units. Costs some thousand evaluations of H.
std::vector<double> turn_rates(const BoundaryValueProblem& problem);

// No path from problem.from to problem.to is shorter.
double least_length(const BoundaryValueProblem& problem, const std::vector<double>& rates);

}  // namespace carnot::internal
