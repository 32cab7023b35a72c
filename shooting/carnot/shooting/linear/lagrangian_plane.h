// Lagrangian planes and their phases.
//
// The columns of (X, P) = (dq(t)/dp0, dp(t)/dp0) span a Lagrangian plane. With an orthonormal basis
// U = P + iX is unitary, and W = U U' depends on the plane only; its eigenvalues exp(i theta_j) are
// 1 as often as X has a kernel. Re W = PP' - XX' and Im W = PX' + XP' are symmetric and commute, so
// the eigenvectors of a general combination belong to both.
#pragma once

#include <Eigen/Core>

namespace carnot::internal {

// theta_j in (-pi, pi], smallest |theta_j| first. Their sum is the argument of det W, up to a
// multiple of 2 pi. `plane` is 2n x n with orthonormal columns.
Eigen::VectorXd phases_of(const Eigen::MatrixXd& plane);

// Coordinates in which planes are followed: (S^-1 X / c, S P c) takes the place of (X, P), with a
// symmetric S.
struct Balance {
  Eigen::MatrixXd s;
  Eigen::MatrixXd inverse;
};

// An orthonormal basis of what a symplectic map, 2n x 2n, makes of a plane, both planes in balanced
// coordinates of scale c. Not finite where the map makes too much of it.
Eigen::MatrixXd image_of(const Eigen::MatrixXd& map,
                         const Balance& balance,
                         double c,
                         const Eigen::MatrixXd& plane);

// What X P^-1, a symmetric matrix, says of a plane.
struct Graph {
  int kernel = 0;           // dimension of the kernel of X, up to round-off
  double regularity = 0;    // least over largest of the other singular values
  Eigen::MatrixXd balance;  // S: in coordinates S^-1 q, S'p all angles of the plane are moderate
};

Graph graph_of(const Eigen::MatrixXd& plane);

}  // namespace carnot::internal
