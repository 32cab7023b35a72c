// The inner problem of RATTLE: a midpoint step and the impulse before it that ends on h(q) = 0.
//
// With z0 = (q0, p0), A = df/dz, D = Dh and L = h f(U), the equations for U and nu are
//
//   U = z0 - (0, D0' nu) + L/2,      h(q1) = 0  with  q1 = q0 + L_q.
//
// Newton's method: with r = z0 - (0, D0' nu) + L/2 - U, and q1 = 2 U_q - q0 when r = 0,
//
//   (I - h A/2) dU + (0, D0' dnu) = r,     2 D1 dU_q = -h(q1) + 2 D1 r_q.
//
// A is that of the node, so the error falls by h^2 in each iteration; where it does not fall, A is
// renewed at the iterate. It goes on until corrections stop falling at the size that the rounding
// errors of the equations explain: h(q1) then has the rounding error of q1 itself.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/numerics/lu.h"
#include "carnot/numerics/round_off.h"
#include "carnot/numerics/scalar.h"
#include "carnot/step/step_report.h"
#include "carnot/system/holonomic.h"
#include "carnot/system/phase_space.h"

namespace carnot {

// A point of the manifold and what the step from there needs of it.
template <class System, class T>
struct RattleNode {
  static constexpr int n = System::kDof;
  static constexpr int l = kHolonomicOf<System>;

  Vector<T, 2 * n> z;
  Vector<T, System::kAlgebraic> algebraic;
  Vector<T, 2 * n> rate;             // f
  Matrix<T, 2 * n, 2 * n> jacobian;  // A, here or at another p nearby
  Matrix<T, l, n> dh;                // D
  Matrix<T, l, l> inverse;           // of D H_pp D'
  Vector<T, l> force;                // 2 nu / h of the last substep, or zero
};

template <class System, class T>
class RattleMidpoint {
 public:
  static constexpr int kDof = System::kDof;
  static constexpr int kSize = 2 * kDof;
  static constexpr int kHolonomic = kHolonomicOf<System>;
  static constexpr int kUnknowns = kSize + kHolonomic;
  using Point = Vector<T, kSize>;
  using Square = Matrix<T, kSize, kSize>;
  using Impulse = Vector<T, kHolonomic>;
  using Algebraic = Vector<T, System::kAlgebraic>;
  using Node = RattleNode<System, T>;
  using KktMatrix = std::array<T, kUnknowns * kUnknowns>;  // row-major

  // Finds U, L and nu for a step of length h from the node, where z is the state with its rounding
  // error; t is the time of the midpoint. False, with the reason in the report, where they are not
  // found. Allocates nothing.
  [[nodiscard]] bool solve(const System& system,
                           const Node& node,
                           const T& t,
                           const T& h,
                           const State<T, kDof>& z,
                           StepReport& report) {
    first_guess(node, h, z);
    report.status = StepStatus::kStagesDiverged;  // until found
    if (!evaluate(system, t, h, z, report)) return false;
    if (!factor(system, node, h, node.jacobian, z)) return false;
    bool grace = true;
    T smallest = std::numeric_limits<T>::max();
    T last = smallest;
    int renewals = 0;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      find_correction(system, node, z);
      T size = correction_size();
      if (size == T(0)) return found(report);
      if (size <= T(kStalledRoundOff) && !(size < smallest / T(2))) {
        if (!grace || size <= T(1)) return found(report);
        grace = false;
      }
      if (iteration > 0 && size > T(kStalledRoundOff) && !(size < last / T(kContraction))) {
        if (++renewals > kMaxRenewals || !renew(system, node, t, h, z, report)) return false;
        find_correction(system, node, z);
        size = correction_size();
      }
      if (!all_finite(correction_)) return false;
      last = size;
      smallest = std::min(smallest, size);
      for (int i = 0; i < kSize; ++i) u_[i] += correction_[i];
      for (int i = 0; i < kHolonomic; ++i) impulse_[i] += correction_[kSize + i];
      if (!evaluate(system, t, h, z, report)) return false;
    }
    return false;
  }

  // The solution.
  [[nodiscard]] const Point& point() const { return u_; }
  [[nodiscard]] const Point& increment() const { return increment_; }
  [[nodiscard]] const Impulse& impulse() const { return impulse_; }
  [[nodiscard]] const Algebraic& algebraic() const { return algebraic_; }

  // The matrix of (dU, dnu) above.
  static void kkt_matrix(const T& h,
                         const Square& a,
                         const Matrix<T, kHolonomic, kDof>& dh0,
                         const Matrix<T, kHolonomic, kDof>& dh1,
                         KktMatrix& matrix) {
    const auto at = [&matrix](int i, int j) -> T& { return matrix[i * kUnknowns + j]; };
    matrix.fill(T(0));
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j < kSize; ++j) at(i, j) = T(i == j ? 1 : 0) - h / T(2) * a(i, j);
    }
    for (int i = 0; i < kHolonomic; ++i) {
      for (int j = 0; j < kDof; ++j) {
        at(kDof + j, kSize + i) = dh0(i, j);
        at(kSize + i, j) = T(2) * dh1(i, j);
      }
    }
  }

 private:
  static constexpr int kMaxIterations = 100;
  static constexpr int kMaxRenewals = 20;
  static constexpr int kContraction = 4;  // of a matrix that is worth keeping

  using Unknowns = Vector<T, kUnknowns>;

  void first_guess(const Node& node, const T& h, const State<T, kDof>& z) {
    const T half = h / T(2);
    for (int i = 0; i < kHolonomic; ++i) impulse_[i] = half * node.force[i];
    for (int i = 0; i < kSize; ++i) u_[i] = z.value[i] + half * node.rate[i];
    apply_impulse(node.dh, impulse_, u_);
    algebraic_ = node.algebraic;
  }

  static bool found(StepReport& report) {
    report.status = StepStatus::kOk;
    return true;
  }

  // L and q1 of U.
  bool evaluate(
      const System& system, const T& t, const T& h, const State<T, kDof>& z, StepReport& report) {
    Point f;
    const RateStatus status = phase_rate(system, t, u_, algebraic_, f);
    ++report.evaluations;
    if (status != RateStatus::kOk) {
      report.status = StepStatus::kRateFailed;
      report.rate = status;
      return false;
    }
    for (int i = 0; i < kSize; ++i) increment_[i] = h * f[i];
    for (int i = 0; i < kDof; ++i) q1_[i] = z.value[i] + (z.compensation[i] + increment_[i]);
    return true;
  }

  // (dU, dnu) by the inverse matrix at hand.
  void find_correction(const System& system, const Node& node, const State<T, kDof>& z) {
    Point moved;
    for (int i = 0; i < kSize; ++i) moved[i] = z.compensation[i] + increment_[i] / T(2);
    apply_impulse(node.dh, impulse_, moved);
    const Vector<T, kHolonomic> h = system.scene().holonomic(q1_);
    Unknowns residual;
    for (int i = 0; i < kSize; ++i) residual[i] = (z.value[i] - u_[i]) + moved[i];
    for (int i = 0; i < kHolonomic; ++i) {
      T sum = -h[i];
      for (int j = 0; j < kDof; ++j) sum += T(2) * dh1_(i, j) * residual[j];
      residual[kSize + i] = sum;
    }
    for (int i = 0; i < kUnknowns; ++i) {
      T sum(0);
      for (int j = 0; j < kUnknowns; ++j) sum += inverse_[i * kUnknowns + j] * residual[j];
      correction_[i] = sum;
    }
  }

  // A at the iterate.
  bool renew(const System& system,
             const Node& node,
             const T& t,
             const T& h,
             const State<T, kDof>& z,
             StepReport& report) {
    report.newton = true;
    Square a;
    const RateStatus status = phase_jacobian(system, t, u_, algebraic_, a);
    if (status == RateStatus::kOk) return factor(system, node, h, a, z);
    report.status = StepStatus::kRateFailed;
    report.rate = status;
    return false;
  }

  // The inverse of the matrix, and the rounding errors of the equations carried over to the
  // unknowns: corrections below that mean nothing.
  bool factor(const System& system,
              const Node& node,
              const T& h,
              const Square& a,
              const State<T, kDof>& z) {
    dh1_ = holonomic_jacobian(system.scene(), q1_);
    kkt_matrix(h, a, node.dh, dh1_, matrix_);
    inverse_.fill(T(0));
    for (int i = 0; i < kUnknowns; ++i) inverse_[i * kUnknowns + i] = T(1);
    if (!lu_solve(kUnknowns, matrix_.data(), kUnknowns, inverse_.data())) return false;
    using std::abs;
    Unknowns noise = filled<kUnknowns>(largest_entry(z.value) + largest_entry(u_));
    for (int i = 0; i < kHolonomic; ++i) {
      T sum(0);
      for (int j = 0; j < kDof; ++j) sum += abs(dh1_(i, j));
      noise[kSize + i] = sum * largest_entry(q1_);
    }
    for (int i = 0; i < kUnknowns; ++i) {
      T sum = std::numeric_limits<T>::min();  // never zero
      for (int j = 0; j < kUnknowns; ++j) sum += abs(inverse_[i * kUnknowns + j]) * noise[j];
      resolution_[i] = epsilon<T>() * sum;
    }
    return all_finite(resolution_);
  }

  // In units of the resolution.
  [[nodiscard]] T correction_size() const {
    using std::abs;
    T size(0);
    for (int i = 0; i < kUnknowns; ++i) {
      size = maximum<T>(size, abs(correction_[i]) / resolution_[i]);
    }
    return size;
  }

  Point u_;
  Point increment_;  // L
  Impulse impulse_;  // nu
  Algebraic algebraic_;
  Vector<T, kDof> q1_;
  // Scratch.
  KktMatrix matrix_;
  KktMatrix inverse_;
  Matrix<T, kHolonomic, kDof> dh1_;
  Unknowns correction_;
  Unknowns resolution_;
};

}  // namespace carnot
