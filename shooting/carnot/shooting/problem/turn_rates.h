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

// The rates of the coordinates with a period, in 1 / length. They are infinite for all others,
// where there is a potential, and where H(q, e_j) depends on a coordinate without a period: that
// may go on for ever. Whether it does is tried at random configurations, up to ten units from
// `problem.from`, so the problem should be in its natural scales. Costs some thousand evaluations
// of H.
std::vector<double> turn_rates(const BoundaryValueProblem& problem);

// No path from problem.from to problem.to is shorter.
double least_length(const BoundaryValueProblem& problem, const std::vector<double>& rates);

}  // namespace carnot::internal
