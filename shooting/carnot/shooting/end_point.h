// Single shooting by Newton's method: the end point as a function of p0.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot {

// max |a_j - b_j|; NaN when one is not a number.
double largest_difference(const double* a, const double* b, int count);

// How many directions of p0 do not move q(t), by the singular values of dq(t)/dp0. Where one run
// can be verified, 1e-10 is far above round-off and far below what regular problems show (1e-6).
int nullity(const Eigen::MatrixXd& x);

// dq(t)/dp0 along the extremal from p0; z(t) in `z`. Nothing when the flow fails.
std::optional<Eigen::MatrixXd> end_point_jacobian(const BoundaryValueProblem& problem,
                                                  const std::vector<double>& p0,
                                                  double t,
                                                  long steps,
                                                  std::vector<double>& z);

// Newton's method on q(T) = to, to the tolerance or as far as it goes; steps of least norm where
// the Jacobian is singular. Returns the end point error that p0 reaches, and the Jacobian there.
double correct(const BoundaryValueProblem& problem,
               long steps,
               double tolerance,
               std::vector<double>& p0,
               Eigen::MatrixXd& jacobian);

// Where directions of p0 do not move the end point, the member of least norm, if it is one: on an
// abnormal extremal any multiple of the abnormal covector may be added. Newton's steps have least
// norm themselves, so this changes nothing else.
void reduce(const BoundaryValueProblem& problem,
            long steps,
            double tolerance,
            std::vector<double>& p0,
            Eigen::MatrixXd& jacobian);

}  // namespace carnot
