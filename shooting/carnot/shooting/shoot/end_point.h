// Single shooting by Newton's method: the end point as a function of p0.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/units.h"

namespace carnot::internal {

// max |a_j - b_j|. NaN where a number is NaN.
double largest_difference(const double* a, const double* b, int count);

// The columns (dq(t)/dp0; dp(t)/dp0), 2n x n, along the extremal from p0; z(t) in `z`. Nothing when
// the flow fails.
std::optional<Eigen::MatrixXd> end_point_tangent(const BoundaryValueProblem& problem,
                                                 const std::vector<double>& p0,
                                                 double t,
                                                 long steps,
                                                 std::vector<double>& z);

// An orthonormal basis, n x nullity, of the directions of p0 that do not move q(t). In these the
// plane that the columns of the tangent span is within an angle `tolerance` of the vertical. Growth
// of the columns, which makes dq(t)/dp0 look singular, does not matter.
Eigen::MatrixXd kernel_of(const Units& units,
                          const Eigen::MatrixXd& tangent,
                          double tolerance = 1e-9);

// Newton's method on q(T) = to, to the tolerance or as far as it goes; steps of least norm where
// the Jacobian is singular, to `rank`. Returns the end point error that p0 reaches, and the tangent
// there.
double correct(const BoundaryValueProblem& problem,
               long steps,
               double tolerance,
               std::vector<double>& p0,
               Eigen::MatrixXd& tangent,
               double rank = kRankRoundOff);

// Where directions of p0 do not move the end point, p0 becomes the member of least norm, if that is
// the same path. This is so on an abnormal extremal, where any multiple of the abnormal covector
// may be added. Where two such directions meet, Newton's method converges slowly and its last steps
// are along them. So they are looked for with a generous tolerance.
void reduce(const BoundaryValueProblem& problem,
            long steps,
            double tolerance,
            std::vector<double>& p0,
            Eigen::MatrixXd& tangent);

}  // namespace carnot::internal
