// Newton's method for H_y(t, q, p, y) = 0 at one phase point, on real numbers, m > 0.
//
// The method asks for H_y and H_yy only, by StationaryEquations or by whatever has the same
// functions. There, a system offers kDof (n), kAlgebraic (m) and the template hamiltonian(t, q, p,
// y), and perhaps cold_start(t, q, p); H_y and H_yy come from Jets in y.
//
// Two solutions y at one (q, p) are parted by points where det H_yy = 0. From a warm start Newton's
// method is to find the solution that belongs to it, so a step is shortened until what is left of
// it agrees with the (1 - a) of a linear equation: then the iterates follow the path
// H_y(y(s)) = (1 - s) H_y(y(0)), which crosses no such point, and det H_yy is watched besides.
// What is left is measured by the step that it asks for, H_yy^-1 H_y, which does not know of the
// units of the equations (Deuflhard, Newton Methods for Nonlinear Problems, 2004, sec. 3.1: affine
// invariance, restricted monotonicity).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include "carnot/numerics/evenly_spread.h"
#include "carnot/numerics/gradient.h"
#include "carnot/numerics/scaled_lu.h"
#include "carnot/system/index_one_system.h"

namespace carnot {

// A good first guess of y; without it, or where it fails, starts of Newton's own are tried.
template <class S>
concept HasColdStart = requires(const S& system, const Vector<double, S::kDof>& q) {
  { system.cold_start(0.0, q, q) } -> std::convertible_to<Vector<double, S::kAlgebraic>>;
};

template <class E>
concept HasFirstGuess = requires(const E& equations) {
  { equations.cold_start() } -> std::convertible_to<typename E::Unknowns>;
};

// H_y = 0 as equations for y at one (t, q, p). T is a real type, m > 0.
template <class System_, class T>
struct StationaryEquations {
  using System = System_;
  static constexpr int n = System::kDof;
  static constexpr int m = System::kAlgebraic;
  using Number = T;
  using Unknowns = Vector<T, m>;
  using Square = Matrix<T, m, m>;
  using Factor = ScaledLu<T, m>;

  const System& system;
  T t;
  Vector<T, n> q;
  Vector<T, n> p;

  // H_y on any scalar: one gradient.
  template <class U>
  static Vector<U, m> derivative(const System& system,
                                 const U& t,
                                 const Vector<U, n>& q,
                                 const Vector<U, n>& p,
                                 const Vector<U, m>& y) {
    using J = Jet<U, m>;
    return system.hamiltonian(J(t), unseeded<J>(q), unseeded<J>(p), seeded(y)).v;
  }

  [[nodiscard]] Vector<T, m> residual(const Vector<T, m>& y) const {
    return derivative(system, t, q, p, y);
  }

  // H_y and H_yy.
  void linearize(const Vector<T, m>& y, Vector<T, m>& residual, Matrix<T, m, m>& hessian) const {
    using J = Jet<T, m>;
    const Vector<J, m> rows =
        derivative<J>(system, J(t), unseeded<J>(q), unseeded<J>(p), seeded(y));
    for (int i = 0; i < m; ++i) {
      residual[i] = rows[i].a;
      for (int j = 0; j < m; ++j) hessian(i, j) = rows[i].v[j];
    }
  }

  [[nodiscard]] int size() const { return m; }
  // A guess of y, where the system has one.
  template <HasColdStart S = System>
  [[nodiscard]] Unknowns cold_start() const {
    return static_cast<const S&>(system).cold_start(t, q, p);
  }

  // How much H_y(y) moves when the last bits of q, p and y do: what its own rounding may be.
  [[nodiscard]] Vector<T, m> noise(const Vector<T, m>& y) const {
    const Vector<T, m> here = residual(y);
    Vector<T, m> sum = filled<m>(T(0));
    const auto add_change = [&](const Vector<T, m>& moved) {
      using std::abs;
      for (int i = 0; i < m; ++i) sum[i] += abs(moved[i] - here[i]);
    };
    for (const int few : {-7, -3, 4, 9}) {
      const T bits = T(1) + T(few) * epsilon<T>();
      StationaryEquations near = *this;
      for (int i = 0; i < n; ++i) {
        near.q[i] = bits * q[i];
        add_change(near.residual(y));
        near.q[i] = q[i];
        near.p[i] = bits * p[i];
        add_change(near.residual(y));
        near.p[i] = p[i];
      }
      Vector<T, m> moved = y;
      for (int i = 0; i < m; ++i) {
        moved[i] = bits * y[i];
        add_change(residual(moved));
        moved[i] = y[i];
      }
    }
    return sum;
  }
};

// Along which solutions Newton's method goes, and how far.
enum class Pursuit {
  kBranch,    // a step may not change det H_yy by more than a factor either, let alone its sign
  kAny,       // the solution may be any
  kAnyNearby  // as kAny, as long as steps are neither short nor many and det H_yy does not fall
};

// Damped Newton iteration; at most kMaxIterations linear systems.
template <class Equations>
class StationaryNewton {
 public:
  using T = typename Equations::Number;
  using Unknowns = typename Equations::Unknowns;
  using Square = typename Equations::Square;
  using Factor = typename Equations::Factor;
  static constexpr int kMaxIterations = 100;
  static constexpr int kMaxHalvings = 30;
  // Nearly all cold starts that end well need no more. (Appell's constraint: a third of all the
  // work was to follow guesses to where det H_yy vanishes, while another start is close.)
  static constexpr int kFewIterations = 25;
  static constexpr int kFewHalvings = 5;

  explicit StationaryNewton(const Equations& equations)
      : equations_(equations),
        residual_(equations.size()),
        step_(equations.size()),
        hessian_(equations.size(), equations.size()) {}

  // From y; on failure y is unchanged.
  [[nodiscard]] RateStatus solve(Pursuit pursuit, Unknowns& y) {
    x_ = y;
    fill(step_, std::numeric_limits<T>::max());
    last_length_ = T(1);
    singular_solution_ = false;
    equations_.linearize(x_, residual_, hessian_);
    if (!(all_finite(residual_) && all_finite(hessian_))) return RateStatus::kNotFinite;
    Factor factor(hessian_);
    const T first_determinant = factor.determinant();
    Progress progress = Progress::kMoved;
    const int most = pursuit == Pursuit::kAnyNearby ? kFewIterations : kMaxIterations;
    for (int i = 0; i < most && progress == Progress::kMoved; ++i) {
      if (!factor.regular()) {
        singular_solution_ = at_noise();
        return RateStatus::kNotIndexOne;
      }
      set_step(factor);
      progress = settled() ? Progress::kSettled : advance(pursuit, factor);
    }
    const bool fallen = fell(factor, first_determinant);
    if (pursuit == Pursuit::kAnyNearby && (fallen || progress != Progress::kSettled)) {
      return RateStatus::kNoSolution;
    }
    if (progress != Progress::kSettled) {
      if (!at_noise()) return RateStatus::kNoSolution;
      fill(step_, T(0));
    }
    if (fallen && singular_root(factor)) {
      singular_solution_ = true;
      return RateStatus::kNotIndexOne;
    }
    for (int i = 0; i < size(); ++i) y[i] = x_[i] + step_[i];
    return RateStatus::kOk;
  }

  // The last failure was that of a solution with a singular H_yy, not that of an iterate.
  [[nodiscard]] bool singular_solution() const { return singular_solution_; }

 private:
  enum class Progress { kMoved, kSettled, kStalled };

  [[nodiscard]] int size() const { return static_cast<int>(step_.size()); }
  static void fill(Unknowns& x, const T& value) { std::fill_n(x.data(), x.size(), value); }
  // Where the equations are linear it ends at the solution.
  void set_step(const Factor& factor) {
    step_ = factor.solve(residual_);
    for (int i = 0; i < size(); ++i) step_[i] = -step_[i];
  }

  // True when residual_ and step_ at x_ are round-off: the step may be added, but no more is known.
  [[nodiscard]] bool settled() const {
    using std::abs;
    const T few = T(8) * epsilon<T>();
    if (largest_entry(step_) <= few * largest_entry(x_)) return true;
    for (int i = 0; i < residual_.size(); ++i) {
      T size(0);
      for (int j = 0; j < residual_.size(); ++j) size += abs(hessian_(i, j) * x_[j]);
      if (!(abs(residual_[i]) <= few * size)) return false;
    }
    return true;
  }

  // x_ <- x_ + a step_ with the first a = 1, 1/2, ... that passes the tests; where the step before
  // was shortened, from twice its length on. When settled, step_ is what is left by the old factor,
  // else residual_, hessian_ and the factor are those of the new x_.
  [[nodiscard]] Progress advance(Pursuit pursuit, Factor& factor) {
    const Unknowns start = x_;
    const Unknowns step = step_;
    const T length = step.norm();
    const Unknowns residual = residual_;
    const Square hessian = hessian_;
    const bool nearby = pursuit == Pursuit::kAnyNearby;
    const T shortest = T(1) / T(std::int64_t{1} << (nearby ? kFewHalvings : kMaxHalvings));
    for (T a = last_length_ < T(0.5) ? T(2) * last_length_ : T(1); a >= shortest; a *= T(0.5)) {
      for (int i = 0; i < size(); ++i) x_[i] = start[i] + a * step[i];
      residual_ = equations_.residual(x_);
      set_step(factor);
      Unknowns away = step_;
      for (int i = 0; i < size(); ++i) away[i] -= (T(1) - a) * step[i];
      const T deviation = away.norm();
      if (!(deviation <= T(0.5) * a * length)) continue;  // also where it is not a number
      if (settled()) return Progress::kSettled;
      equations_.linearize(x_, residual_, hessian_);
      const Factor next(hessian_);
      const T ratio = next.determinant() / factor.determinant();
      if (all_finite(hessian_) &&
          (pursuit != Pursuit::kBranch || (ratio > T(0.25) && ratio < T(4)))) {
        factor = next;
        last_length_ = a;
        return Progress::kMoved;
      }
      hessian_ = hessian;
    }
    x_ = start;
    step_ = step;
    residual_ = residual;
    return Progress::kStalled;
  }

  // Where no step helps, or none ends: x_ may still be as good as the rounding of H_y allows.
  [[nodiscard]] bool at_noise() const {
    using std::abs, std::cbrt;
    const T third = cbrt(epsilon<T>());
    if (largest_entry(step_) <= third * third * largest_entry(x_)) return true;
    const Unknowns noise = equations_.noise(x_);
    for (int i = 0; i < size(); ++i) {
      if (!(abs(residual_[i]) <= noise[i])) return false;
    }
    return true;
  }

  // The iterates ran into a point where det H_yy is small against where they began.
  [[nodiscard]] static bool fell(const Factor& factor, const T& first_determinant) {
    using std::abs, std::cbrt;
    return !(abs(factor.determinant()) > cbrt(epsilon<T>()) * abs(first_determinant));
  }

  // Is it zero there within the rounding of the solution?
  [[nodiscard]] bool singular_root(const Factor& factor) const {
    const Unknowns radius = factor.solve(equations_.noise(x_));
    Unknowns residual(radius.size());
    Square hessian(radius.size(), radius.size());
    for (const int sign : {-1, 1}) {
      Unknowns beside = x_;
      for (int i = 0; i < size(); ++i) beside[i] += T(sign) * radius[i];
      equations_.linearize(beside, residual, hessian);
      const T ratio = Factor(hessian).determinant() / factor.determinant();
      if (!(ratio > T(0.5) && ratio < T(2))) return true;
    }
    return false;
  }

  const Equations& equations_;
  Unknowns x_;
  Unknowns residual_;
  Unknowns step_;
  Square hessian_;
  T last_length_ = T(1);  // of the last step, of the whole one
  bool singular_solution_ = false;
};

// Newton's method from starts of its own: the scene's, y = 0, and others of the size of the least
// squares step from 0.
template <class Equations>
[[nodiscard]] RateStatus pursue_from_starts(const Equations& equations,
                                            Pursuit pursuit,
                                            typename Equations::Unknowns& y) {
  using T = typename Equations::Number;
  using Unknowns = typename Equations::Unknowns;
  using Square = typename Equations::Square;
  const int m = equations.size();
  StationaryNewton<Equations> newton(equations);
  RateStatus result = RateStatus::kNotFinite;
  // True when there is no need to go on. "No solution" says more than "singular at the start".
  const auto settled = [&](const Unknowns& start) {
    Unknowns x = start;
    const RateStatus status = newton.solve(pursuit, x);
    if (status == RateStatus::kOk) y = x;
    const bool settles = status == RateStatus::kOk || newton.singular_solution();
    if (settles || (status != RateStatus::kNotFinite && result != RateStatus::kNoSolution)) {
      result = status;
    }
    return settles;
  };
  if constexpr (HasFirstGuess<Equations>) {
    if (settled(equations.cold_start())) return result;
  }
  Unknowns zero(m);
  std::fill_n(zero.data(), m, T(0));
  if (settled(zero)) return result;

  // Where H_yy is singular at 0, its least squares step: (A A + d I) x = -A r, d small.
  Unknowns residual(m);
  Square a(m, m);
  equations.linearize(zero, residual, a);
  const T size = largest_entry(a);
  if (!all_finite(residual) || !all_finite(a) || !(size > T(0))) return result;
  Square normal(m, m);
  Unknowns right(m);
  for (int i = 0; i < m; ++i) {
    right[i] = T(0);
    for (int k = 0; k < m; ++k) right[i] += a(i, k) * residual[k];
    for (int j = 0; j < m; ++j) {
      normal(i, j) = T(i == j ? std::numeric_limits<float>::epsilon() : 0) * size * size;
      for (int k = 0; k < m; ++k) normal(i, j) += a(i, k) * a(k, j);
    }
  }
  Unknowns start = typename Equations::Factor(normal).solve(right);
  for (int i = 0; i < m; ++i) start[i] = -start[i];
  const T radius = largest_entry(start);
  if (!all_finite(start) || !(radius > T(0))) return result;
  if (settled(start)) return result;

  constexpr int kMore = 8;
  for (int k = 1; k <= kMore; ++k) {
    Unknowns x = start;
    for (int i = 0; i < m; ++i) x[i] += radius * T(evenly_spread(k * m + i));
    if (settled(x)) return result;
  }
  return result;
}

// Cold: first without going far from any start, then as far as it takes. Which branch is found
// where there are several is not said: use a warm start.
template <class Equations>
[[nodiscard]] RateStatus stationary_cold_start(const Equations& equations,
                                               typename Equations::Unknowns& y) {
  const RateStatus nearby = pursue_from_starts(equations, Pursuit::kAnyNearby, y);
  if (nearby == RateStatus::kOk) return nearby;
  return pursue_from_starts(equations, Pursuit::kAny, y);
}

// Solves H_y = 0 on real numbers: warm from y, or cold where y is all zero. On failure y is
// unchanged.
template <class System, class T>
[[nodiscard]] RateStatus stationary_solve(const System& system,
                                          const T& t,
                                          const Vector<T, System::kDof>& q,
                                          const Vector<T, System::kDof>& p,
                                          Vector<T, System::kAlgebraic>& y) {
  const StationaryEquations<System, T> equations{system, t, q, p};
  if (largest_entry(y) == T(0)) return stationary_cold_start(equations, y);
  return StationaryNewton(equations).solve(Pursuit::kBranch, y);
}

}  // namespace carnot
