// The tangent of one RATTLE step, and what it keeps: the symplectic form of the manifold.
//
// Each substep of rattle.h is differentiated at its solution. With A = df/dz(U), D = Dh and N the
// second derivative of nu.h,
//
//   (I - h A/2) dU + (0, D0' dnu0) = (dq0, dp0 - N0 dq0),     2 D1 dU_q = D1 dq0,
//   (dq1, dp'') = (dq0, dp0 - N0 dq0 - D0' dnu0) + h A dU,
//   dp1 = dp'' - N1 dq1 - D1' dnu1,                            d(Dh H_p)(q1, p1) (dq1, dp1) = 0,
//
// a map of all of R^2n into the tangent space of the manifold at (q1, p1). J A and N are symmetric,
// D0 dq0 = 0 and D1 dq1 = 0 on the manifold, so there it is symplectic. Cost per substep: two rates
// on Jets with 2n directions, one LU of size 2n + l.
#pragma once

#include <array>

#include "carnot/numerics/canonical_structure.h"
#include "carnot/step/rattle.h"
#include "carnot/step/tangent.h"

namespace carnot {

template <class System_, class T_>
class Tangent<Rattle<System_, T_>> {
 public:
  using Step = Rattle<System_, T_>;
  using T = T_;
  static constexpr int kSize = Step::kSize;
  using Square = Matrix<T, kSize, kSize>;

  // M <- (dz+/dz) M for the step that `step` has just done. False when a linear system is
  // singular; M is then unchanged.
  [[nodiscard]] bool advance(const Step& step, Compensated<Square>& m) {
    Compensated<Square> next = m;
    failure_ = RateStatus::kNotFinite;
    for (int i = 0; i < step.tableau().stages(); ++i) {
      if (!kick_and_move(step, i, next) || !kick_back(step, i, next)) return false;
    }
    m = next;
    return true;
  }
  // M <- identity.
  void restart(Compensated<Square>& m) const {
    m = {identity<kSize, T>(), filled<kSize, kSize>(T(0))};
  }
  // Why the last advance() failed.
  [[nodiscard]] RateStatus failure() const { return failure_; }

 private:
  static constexpr int n = Step::kDof;
  static constexpr int l = Step::kHolonomic;
  static constexpr int kUnknowns = Step::Midpoint::kUnknowns;
  using Columns = Matrix<T, n, kSize>;

  static Vector<T, n> configuration(const Step& step, int node) {
    return part<0, n>(step.node(node));
  }

  // Notes why it is not.
  bool sound(RateStatus status) {
    if (status == RateStatus::kOk) return true;
    failure_ = status;
    return false;
  }

  // The second derivative of nu.h at a node.
  static Matrix<T, n, n> bend(const Step& step, int node, const Vector<T, l>& nu) {
    const auto hessians = holonomic_hessians(step.system().scene(), configuration(step, node));
    Matrix<T, n, n> sum = filled<n, n>(T(0));
    for (int i = 0; i < l; ++i) {
      for (int k = 0; k < n * n; ++k) sum.data()[k] += nu[i] * hessians[i].data()[k];
    }
    return sum;
  }

  // (dq0, dp0) -> (dq1, dp'').
  bool kick_and_move(const Step& step, int i, Compensated<Square>& m) {
    const auto& scene = step.system().scene();
    const T h = step.last_step() * step.tableau().b[i];
    Square a;
    if (!sound(phase_jacobian(
            step.system(), step.stage_time(i), step.stage(i), step.algebraic(i), a))) {
      return false;
    }
    const Matrix<T, l, n> dh0 = holonomic_jacobian(scene, configuration(step, i));
    const Matrix<T, l, n> dh1 = holonomic_jacobian(scene, configuration(step, i + 1));
    const Square start = sum_of(m);
    const Columns dq0 = upper_half(start);
    const Columns kick = product(bend(step, i, step.impulse_before(i)), dq0);
    const Matrix<T, l, kSize> turned = product(dh1, dq0);
    for (int j = 0; j < kSize; ++j) {
      for (int r = 0; r < kSize; ++r) at(r, j) = start(r, j) - (r < n ? T(0) : kick(r - n, j));
      for (int r = 0; r < l; ++r) at(kSize + r, j) = turned(r, j);
    }
    Step::Midpoint::kkt_matrix(h, a, dh0, dh1, matrix_);
    if (!lu_solve(kUnknowns, matrix_.data(), kSize, solution_.data())) return false;
    Square du;
    Matrix<T, l, kSize> dnu;
    for (int j = 0; j < kSize; ++j) {
      for (int r = 0; r < kSize; ++r) du(r, j) = at(r, j);
      for (int r = 0; r < l; ++r) dnu(r, j) = at(kSize + r, j);
    }
    Square increment = product(a, du);
    const Columns impulse = transposed_times(dh0, dnu);
    for (int j = 0; j < kSize; ++j) {
      for (int r = 0; r < kSize; ++r) increment(r, j) *= h;
      for (int r = 0; r < n; ++r) increment(n + r, j) -= kick(r, j) + impulse(r, j);
    }
    if (!all_finite(increment)) return false;
    m.add(increment);
    return true;
  }

  // (dq1, dp'') -> (dq1, dp1).
  bool kick_back(const Step& step, int i, Compensated<Square>& m) {
    const auto& scene = step.system().scene();
    const Vector<T, n> q = configuration(step, i + 1);
    Vector<T, System_::kAlgebraic> y = step.node_algebraic(i + 1);
    Vector<T, kSize> rate;
    Square jacobian;
    const T t = step.node_time(i + 1);
    if (!sound(phase_rate(step.system(), t, step.node(i + 1), y, rate))) return false;
    if (!sound(phase_jacobian(step.system(), t, step.node(i + 1), y, jacobian))) return false;
    const Vector<T, n> v = part<0, n>(rate);
    const Matrix<T, l, kSize> hidden = hidden_jacobian(scene, q, v, jacobian);
    const Matrix<T, l, n> dh = holonomic_jacobian(scene, q);
    Matrix<T, l, l> inverse;
    const Matrix<T, n, n> h_pp = momentum_hessian<n>(jacobian);
    if (!invert_normal_mass(dh, h_pp, inverse)) return false;

    Square moved = sum_of(m);
    const Columns dq = upper_half(moved);
    const Columns kick = product(bend(step, i + 1, step.impulse_after(i)), dq);
    for (int j = 0; j < kSize; ++j) {
      for (int r = 0; r < n; ++r) moved(n + r, j) -= kick(r, j);
    }
    const Matrix<T, l, kSize> violated = product(hidden, moved);
    const Matrix<T, l, kSize> dnu = product(inverse, violated);
    const Columns impulse = transposed_times(dh, dnu);
    Square increment = filled<kSize, kSize>(T(0));
    for (int j = 0; j < kSize; ++j) {
      for (int r = 0; r < n; ++r) increment(n + r, j) = -kick(r, j) - impulse(r, j);
    }
    m.add(increment);
    return true;
  }

  static Square sum_of(const Compensated<Square>& m) {
    Square sum = m.value;
    add_to(sum, m.compensation);
    return sum;
  }
  static Columns upper_half(const Square& m) {
    Columns half;
    for (int j = 0; j < kSize; ++j) {
      for (int r = 0; r < n; ++r) half(r, j) = m(r, j);
    }
    return half;
  }

  T& at(int i, int j) { return solution_[i * kSize + j]; }

  RateStatus failure_ = RateStatus::kNotFinite;
  // Scratch.
  typename Step::Midpoint::KktMatrix matrix_;
  std::array<T, kUnknowns * kSize> solution_;  // row-major
};

// The orthogonal projector P of R^2n onto the tangent space of {h = 0, Dh H_p = 0} at (q, p), which
// must lie on it: I - C'(C C')^-1 C with C the derivatives of both. False where they are dependent.
template <HolonomicSystem System, class T>
[[nodiscard]] bool manifold_projector(const System& system,
                                      const T& t,
                                      const Vector<T, 2 * System::kDof>& z,
                                      Matrix<T, 2 * System::kDof, 2 * System::kDof>& projector) {
  constexpr int n = System::kDof;
  constexpr int l = kHolonomicOf<System>;
  Vector<T, System::kAlgebraic> y = filled<System::kAlgebraic>(T(0));
  Vector<T, 2 * n> rate;
  Matrix<T, 2 * n, 2 * n> jacobian;
  if (phase_rate(system, t, z, y, rate) != RateStatus::kOk) return false;
  if (phase_jacobian(system, t, z, y, jacobian) != RateStatus::kOk) return false;
  const Vector<T, n> q = part<0, n>(z);
  const Vector<T, n> v = part<0, n>(rate);
  const Matrix<T, l, n> dh = holonomic_jacobian(system.scene(), q);
  const Matrix<T, l, 2 * n> hidden = hidden_jacobian(system.scene(), q, v, jacobian);
  Matrix<T, 2 * l, 2 * n> c;
  for (int i = 0; i < l; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      c(i, j) = j < n ? dh(i, j) : T(0);
      c(l + i, j) = hidden(i, j);
    }
  }
  Matrix<T, 2 * l, 2 * l> inverse;
  projector = identity<2 * n, T>();
  if (!invert_normal_mass(c, projector, inverse)) return false;
  const Matrix<T, 2 * l, 2 * n> dual = product(inverse, c);
  const Matrix<T, 2 * n, 2 * n> normal = transposed_times(c, dual);
  subtract_from(projector, normal);
  return true;
}

// max-norm of P'(M'JM - J)P: how far M, a derivative of the flow from a point where P projects on
// the tangent space, is from keeping the symplectic form of the manifold.
template <class T, int size>
T manifold_symplecticity_defect(const Matrix<T, size, size>& m,
                                const Matrix<T, size, size>& projector) {
  const auto j = canonical_structure<Matrix<T, size, size>>(size, size / 2);
  const Matrix<T, size, size> defect = product(m.transpose(), product(j, m)) - j;
  return product(projector, product(defect, projector)).cwiseAbs().maxCoeff();
}

}  // namespace carnot
