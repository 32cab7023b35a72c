// Single shooting by Newton's method: the conditions at the target as functions of the unknowns x
// at the start (ends.h). Where no end is free x is p0.
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

// The columns (dq(t)/dx; dp(t)/dx), 2n x n, along the extremal from x; z(t) in `z`. In the rows of
// coordinates that are free at the target, q_j and p_j are exchanged for p_j and -q_j: what is
// asked for comes first. Nothing when the flow fails.
std::optional<Eigen::MatrixXd> end_point_tangent(const BoundaryValueProblem& problem,
                                                 const std::vector<double>& x,
                                                 double t,
                                                 long steps,
                                                 std::vector<double>& z);

// An orthonormal basis, n x nullity, of the directions of x that do not move the end. In these the
// plane that the columns of the tangent span is within an angle `tolerance` of the vertical. Growth
// of the columns, which makes the tangent look singular, does not matter.
Eigen::MatrixXd kernel_of(const Units& units,
                          const Eigen::MatrixXd& tangent,
                          double tolerance = 1e-9);

// Newton's method on the conditions at the target, to the tolerance or as far as it goes; steps of
// least norm where the Jacobian is singular, to `rank`. Returns by how much x misses the target
// (ends.h), and the tangent there.
double correct(const BoundaryValueProblem& problem,
               long steps,
               double tolerance,
               std::vector<double>& x,
               Eigen::MatrixXd& tangent,
               double rank = kRankRoundOff);

// Newton's method from afar: a few steps of at most half the size of the momenta, until they are
// short. What it ends at is for correct().
void approach(const BoundaryValueProblem& problem, long steps, std::vector<double>& x);

// Where directions of x do not move the end point, x becomes the member of least norm, if that is
// the same path. This is so on an abnormal extremal, where any multiple of the abnormal covector
// may be added. Where two such directions meet, Newton's method converges slowly and its last steps
// are along them. So they are looked for with a generous tolerance.
void reduce(const BoundaryValueProblem& problem,
            long steps,
            double tolerance,
            std::vector<double>& x,
            Eigen::MatrixXd& tangent);

}  // namespace carnot::internal
