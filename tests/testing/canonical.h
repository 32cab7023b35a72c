// The structure matrix of Darboux coordinates, written out once more for the tests.
#pragma once

#include <Eigen/Core>

namespace carnot::test {

// (0, -I; I, 0) of rank 2 `dof`, and zeros up to this size.
inline Eigen::MatrixXd canonical(int size, int dof) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(size, size);
  j.block(0, dof, dof, dof) = -Eigen::MatrixXd::Identity(dof, dof);
  j.block(dof, 0, dof, dof) = Eigen::MatrixXd::Identity(dof, dof);
  return j;
}

}  // namespace carnot::test
