// The curves that constraints alone make extremal, where two directions are admissible.
//
// A curve is abnormal where a covector p, nowhere zero, annihilates the admissible directions along
// it and moves with it. With p = G'lambda, the 1-form w = lambda.G and a velocity v in ker G,
//
//   p' = d/dq (lambda.G v),   so   G'lambda' = W v,   W_ij = d_i (lambda.G)_j - d_j (lambda.G)_i,
//
// which is solvable for lambda' only where W v annihilates ker G, too. With b1, b2 a basis of ker G
// and v a combination of both that means
//
//   c(q, p) = b1.W b2 = 0;   -c is p.[X1, X2] for fields X1, X2 with these values.
//
// Let D_i be the derivative along v = b_i, with the p' above. That c stays zero says which way to
// go: v1 D_1 c + v2 D_2 c = 0, so up to its speed v = D_2 c b1 - D_1 c b2. (On fields it is the
// same as p.[X2, [X1, X2]] X1 - p.[X1, [X1, X2]] X2.) Where both derivatives vanish the velocity is
// not told by them; such points end a curve here.
//
// Through each point of four dimensions there is one such curve at most, but for the size of p,
// unless c vanishes for all p; in three there is one where the point is on the surface c = 0.
// Source: Liu & Sussmann, Shortest paths for sub-Riemannian metrics on rank-two distributions,
// Memoirs of the AMS 564 (1995), sec. 4; Agrachev & Sachkov, Control Theory from the Geometric
// Viewpoint, 2004, sec. 20.6; Montgomery, A Tour of Subriemannian Geometries, 2002, ch. 3.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

// Everything by q at one point: M, G with its derivatives, a basis of ker G.
class SingularField {
 public:
  // Keeps a reference.
  explicit SingularField(const Dynamics& dynamics);

  // Whether there can be such curves at all: n >= 3 coordinates, constraints on velocities alone
  // and no force, with two admissible directions at q.
  [[nodiscard]] static bool suits(const Dynamics& dynamics, const Eigen::VectorXd& q);

  // Covectors p at q, as columns, that annihilate ker G and of which every combination has c = 0.
  [[nodiscard]] Eigen::MatrixXd covectors(const Eigen::VectorXd& q);

  struct Rate {
    Eigen::VectorXd velocity;  // of length 1 in the metric
    Eigen::VectorXd force;     // p'
  };
  // Nothing where the velocity is not told, where there are not two admissible directions, or where
  // a potential acts. Of the two signs of the velocity it is the same one along a curve.
  [[nodiscard]] std::optional<Rate> rate(const Eigen::VectorXd& q, const Eigen::VectorXd& p);

  // Of momenta that drive the same curve. With p = M v + G'lambda the curve at speed 1 is a normal
  // extremal, too, where
  //
  //   p' = d/dq (v.M v / 2 + lambda.G v)   and   B'(p - M v) = 0 all along.
  //
  // `columns` hold p in the first column and what may be added to it, which is homogeneous, in the
  // others; and so does what is returned. `violations` are those of the second equation.
  struct Drive {
    Eigen::MatrixXd force;
    Eigen::MatrixXd violations;  // 2 rows
  };
  [[nodiscard]] Drive drive(const Eigen::VectorXd& q,
                            const Eigen::VectorXd& velocity,
                            const Eigen::MatrixXd& columns);
  // An orthonormal basis of all that annihilates ker G at q.
  [[nodiscard]] Eigen::MatrixXd annihilator(const Eigen::VectorXd& q);
  // max |G v| at q.
  [[nodiscard]] double violation(const Eigen::VectorXd& q, const Eigen::VectorXd& velocity);
  // M v.
  [[nodiscard]] Eigen::VectorXd momentum(const Eigen::VectorXd& q, const Eigen::VectorXd& velocity);

 private:
  // Evaluates M, G and their derivatives at q. False where ker G has not two dimensions, or where a
  // potential acts.
  bool set(const Eigen::VectorXd& q);
  // A number of M or G, followed by its derivatives.
  [[nodiscard]] const double* mass(int i, int j) const {
    return entries_.data() + (i * (i + 1) / 2 + j) * row_;
  }
  [[nodiscard]] const double* constraint(int a, int j) const {
    return entries_.data() + (n_ * (n_ + 1) / 2 + a * n_ + j) * row_;
  }
  // d_i (lambda.G)_j.
  [[nodiscard]] Eigen::MatrixXd slopes(const Eigen::VectorXd& lambda) const;
  // d_w G.
  [[nodiscard]] Eigen::MatrixXd moved(const Eigen::VectorXd& w) const;
  // The second derivatives of lambda.G v by q.
  [[nodiscard]] Eigen::MatrixXd curvature(const Eigen::VectorXd& v,
                                          const Eigen::VectorXd& lambda) const;

  const Dynamics& dynamics_;
  int n_;
  int k_;
  int row_;  // length of a row of entries
  std::vector<double> entries_;
  Eigen::VectorXd q_;
  Eigen::MatrixXd m_;
  Eigen::MatrixXd g_;
  Eigen::MatrixXd inverse_;  // the pseudo-inverse of G
  Eigen::MatrixXd rows_;     // n x (n - 2), orthonormal: what annihilates ker G
  Eigen::MatrixXd basis_;    // n x 2, orthonormal: ker G
};

}  // namespace carnot::internal
