// H and its derivatives at phase points side by side, for scenes of every kind.
//
// The algebraic variables are solved for: H(t, q, p) is stationary in them, and its second
// derivatives come from the Jacobian of the rate, (q', p') = (H_p, -H_q).
//
// A continuation in the drift needs a family of such functions. The part of H that is odd in p is
// what moves the configuration without momentum: p.f0 for q' = f0(q) + B u at a cost quadratic in
// u. So
//
//   H_d(t, q, p) = (1 + d)/2 H(t, q, p) + (1 - d)/2 H(t, q, -p)
//
// multiplies the drift by d and leaves everything else as it is; H_1 = H.
#pragma once

#include <vector>

#include "carnot/dynamics.h"
#include "carnot/system/system_functions.h"

namespace carnot::internal {

class HamiltonianTerms {
 public:
  // How many points are evaluated at once.
  static constexpr int kPoints = kErasedLanes;
  enum class Order { kFirst, kSecond };

  // Keeps a reference to the dynamics.
  explicit HamiltonianTerms(const Dynamics& dynamics, double drift = 1);

  // Number `point` of the next points: its time and, to be filled, q and p (n numbers each).
  void set(int point, double t, const double* q, const double* p);
  // At the first `count` points that were set; the second derivatives where they are wanted. False
  // where H cannot be evaluated at one of them; then everything is NaN.
  // Where the algebraic variables are found by Newton's method, it begins at what was found last at
  // the points of the same `group`.
  bool evaluate(int count, Order order, int group = 0);

  // Where holonomic constraints are kept as Dh q' = 0, momenta along Dh move nothing, and a path
  // from one point of the manifold to another need not be told at every interval to stay on it. So
  // at one point |N'p|^2 / 2 is added, with the normal directions N at q; it makes the equations
  // regular and vanishes at their solution.
  void fix_gauge(int point, const double* q);

  // H itself.
  [[nodiscard]] double value(int point) const { return value_[point]; }
  [[nodiscard]] double by_q(int point, int i) const { return by_q_[i * kPoints + point]; }
  [[nodiscard]] double by_p(int point, int i) const { return by_p_[i * kPoints + point]; }
  // Entry (i, j); of qp, i is that of q.
  [[nodiscard]] double qq(int point, int i, int j) const { return entry(qq_, point, i, j); }
  [[nodiscard]] double qp(int point, int i, int j) const { return entry(qp_, point, i, j); }
  [[nodiscard]] double pp(int point, int i, int j) const { return entry(pp_, point, i, j); }

 private:
  [[nodiscard]] double entry(const std::vector<double>& m, int point, int i, int j) const {
    return m[(i * n_ + j) * kPoints + point];
  }
  // Algebraic variables, and the momenta that they were found for.
  struct Found {
    std::vector<double> y;
    std::vector<double> p;
  };

  // Adds `weight` times H and its derivatives at (t, q, sign p).
  bool add(int count, double sign, double weight, Order order, Found& found);
  // The rates at z from the algebraic variables that were found for momenta nearby, or else from
  // the branch of the system.
  bool set_rates(Found& found);
  // Whether no momentum has changed by more than its own size.
  [[nodiscard]] bool is_near(const std::vector<double>& p) const;
  // The Jacobians of the rates at z, in rows.
  bool set_jacobians(int count, const std::vector<double>& y);

  const Dynamics& dynamics_;
  double drift_;
  int n_;
  // Rows of kPoints numbers.
  std::vector<double> t_;
  std::vector<double> z_;
  std::vector<double> z_dot_;
  std::vector<Found> found_;  // of each group, for p and for -p
  std::vector<double> jacobian_;
  std::vector<double> value_;
  std::vector<double> by_q_;
  std::vector<double> by_p_;
  std::vector<double> qq_;
  std::vector<double> qp_;
  std::vector<double> pp_;
  std::vector<double> normal_;  // N N', n x n
};

}  // namespace carnot::internal
