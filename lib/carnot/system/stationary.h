// Systems whose algebraic variables are found by Newton's method: H_y(t, q, p, y) = 0.
//
// A system offers kDof (n), kAlgebraic (m, may be 0) and the template hamiltonian(t, q, p, y), and
// perhaps cold_start(t, q, p). Everything else comes from Jets of that one formula: y by
// stationary_newton.h, then q' = H_p and p' = -H_q from one gradient at the solution.
//
// No Jet passes through the iteration. With A = H_yy at the values, y <- y - A^-1 H_y on Jets
// leaves an error of one order more in the infinitesimals: one such step gives the derivatives of
// the implicit function, two those of second order on nested Jets.
#pragma once

#include <cmath>
#include <limits>

#include "carnot/numerics/gradient.h"
#include "carnot/numerics/scaled_lu.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/stationary_newton.h"

namespace carnot {

// The reals below a vector of Jets, and how many levels up it is.
template <class T, int n>
Vector<Real<T>, n> values_of(const Vector<T, n>& x) {
  Vector<Real<T>, n> values;
  for (int i = 0; i < n; ++i) values[i] = value_of(x[i]);
  return values;
}
template <class T>
constexpr int jet_levels() {
  if constexpr (kIsJet<T>) {
    return 1 + jet_levels<typename T::Scalar>();
  } else {
    return 0;
  }
}

// rate() of a system. y: warm start on entry (all zero: none), the solution on exit; its
// infinitesimal part on entry does not matter. Where none is found, y is unchanged.
// Cost, warm: one H on nested Jets of m in m directions, one on Jets of m and one on Jets of 2n.
template <class System, class T>
[[nodiscard]] RateStatus stationary_rate(const System& system,
                                         const T& t,
                                         const Vector<T, System::kDof>& q,
                                         const Vector<T, System::kDof>& p,
                                         Vector<T, System::kAlgebraic>& y,
                                         Rate<T, System::kDof>& out) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  if constexpr (m > 0) {
    using R = Real<T>;
    Vector<R, m> value = values_of(y);
    const RateStatus status =
        stationary_solve(system, R(value_of(t)), values_of(q), values_of(p), value);
    if (status != RateStatus::kOk) return status;
    for (int i = 0; i < m; ++i) y[i] = constant<T>(value[i]);
    if constexpr (kIsJet<T>) {
      using Equations = StationaryEquations<System, R>;
      const Equations equations{system, R(value_of(t)), values_of(q), values_of(p)};
      Vector<R, m> residual;
      Matrix<R, m, m> hessian;
      equations.linearize(value, residual, hessian);
      const ScaledLu<R, m> factor(hessian);
      if (!factor.regular()) return RateStatus::kNotIndexOne;
      for (int level = 0; level < jet_levels<T>(); ++level) {
        Vector<T, m> r = Equations::derivative(system, t, q, p, y);
        // The values are solved already: their rounding shall not move them.
        for (int i = 0; i < m; ++i) r[i] -= constant<T>(value_of(r[i]));
        const Vector<T, m> step = factor.solve(r);
        subtract_from(y, step);
      }
    }
  }
  using J = Jet<T, 2 * n>;
  Vector<T, 2 * n> z;
  for (int i = 0; i < n; ++i) {
    z[i] = q[i];
    z[n + i] = p[i];
  }
  const Vector<J, 2 * n> zj = seeded(z);
  const J h = system.hamiltonian(J(t), part<0, n>(zj), part<n, n>(zj), unseeded<J>(y));
  for (int i = 0; i < n; ++i) {
    out.q_dot[i] = h.v[n + i];
    out.p_dot[i] = -h.v[i];
  }
  return status_of(out);
}

// det H_yy and its condition |A| |A^-1| in the norm of largest column sums: infinite when A is
// singular to the last bit. No algebraic variables: 1 and 1.
template <class System>
[[nodiscard]] Regularity stationary_regularity(const System& system,
                                               double t,
                                               const Vector<double, System::kDof>& q,
                                               const Vector<double, System::kDof>& p,
                                               const Vector<double, System::kAlgebraic>& y) {
  constexpr int m = System::kAlgebraic;
  Regularity regularity{1, 1};
  if constexpr (m > 0) {
    const StationaryEquations<System, double> equations{system, t, q, p};
    Vector<double, m> residual;
    Matrix<double, m, m> a;
    equations.linearize(y, residual, a);
    const ScaledLu<double, m> factor(a);
    Matrix<double, m, m> inverse;
    for (int i = 0; i < m; ++i) {
      Vector<double, m> column = filled<m>(0.0);
      column[i] = 1;
      column = factor.solve(column);
      for (int j = 0; j < m; ++j) inverse(j, i) = column[j];
    }
    const auto norm = [](const auto& x) {
      Vector<double, m> sums = filled<m>(0.0);
      for (int j = 0; j < m; ++j) {
        for (int i = 0; i < m; ++i) sums[j] += std::abs(x(i, j));
      }
      return largest_entry(sums);
    };
    regularity.determinant = factor.determinant();
    regularity.condition =
        all_finite(inverse) ? norm(a) * norm(inverse) : std::numeric_limits<double>::infinity();
  }
  return regularity;
}

}  // namespace carnot
