// The end point as a cubic polynomial of p0 about a known extremal, and its inverse.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {

class EndPointModel {
 public:
  static constexpr int kMostDof = kMostSmall;
  static constexpr long kSteps = 64;  // of its tangent flows
  using Vector = SmallVector;
  using Matrix = SmallMatrix;

  // From the derivatives of q(T) at p0 (length n <= kMostDof), by n^2 + n + 1 tangent flows; the
  // second and third are differences of the first.
  EndPointModel(const BoundaryValueProblem& problem, const Vector& p0);

  // False where dq(T)/dp0 is singular, or so large that single shooting loses its digits.
  [[nodiscard]] bool invertible() const { return invertible_; }

  struct Prediction {
    Vector change;   // of p0,
    Matrix inverse;  // of dq(T)/dp0 there,
    double error;    // and how far from its target q(T) may be expected, max-norm
  };
  // What takes q(T) as near to q(T) + change as the model leads. No allocation.
  [[nodiscard]] Prediction move_end(const Vector& change) const;

 private:
  // Newton's method from `at` to where the model's end changes by `change`.
  [[nodiscard]] bool solve(const Vector& change, Prediction& at) const;

  bool invertible_ = false;
  Matrix jacobian_;            // J = dq(T)/dp0,
  Matrix inverse_;             // its inverse,
  std::vector<Matrix> bend_;   // dJ/dp_j,
  std::vector<Matrix> twist_;  // d2J/dp_i dp_j, i <= j: 00, 01, 11, 02, ..; twice that for i < j
};

}  // namespace carnot::internal
