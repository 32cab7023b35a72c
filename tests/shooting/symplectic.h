// A symplectic matrix to try things on.
#pragma once

#include <Eigen/Core>

namespace carnot::test {

// A product of shears q += S p, p += S q with a symmetric S.
inline Eigen::MatrixXd symplectic_shear(int n) {
  const Eigen::MatrixXd s =
      Eigen::MatrixXd::NullaryExpr(n, n, [](auto i, auto j) { return 1.0 / (1 + i + j); });
  Eigen::MatrixXd first = Eigen::MatrixXd::Identity(2 * n, 2 * n);
  Eigen::MatrixXd second = first;
  first.topRightCorner(n, n) = s;
  second.bottomLeftCorner(n, n) = s;
  return first * second;
}

}  // namespace carnot::test
