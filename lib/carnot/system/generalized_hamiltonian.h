// Generalized Hamiltonian scenes (Prop. 3 and 4 of McLachlan et al. 2013): J z' = grad H(z).
//
// With z = T (q, p, y) of darboux.h, H(q, p, y) = H(T (q, p, y)) is a system of index 1 wherever
// H_yy is regular: y by Newton's method, q' = H_p, p' = -H_q. A Runge-Kutta method commutes with
// linear maps, so it takes the same steps in z as in (q, p, y) and preserves the form 1/2 dz ^ J dz
// if it is symplectic (Prop. 3), whatever T is.
//
// Index 1 is essential. A holonomic constraint written as lambda h(q) has H_yy = 0: then the
// midpoint rule takes every (q, p) for a start, puts the constraint on its midpoints only, and does
// not converge (end of section 3 there). Where H_yy is singular everywhere that is tried, the
// constructor refuses the scene; where it is singular at a point, rate() says kNotIndexOne.
//
// y is reported as the multipliers. There is no g(q, q') beside H_y = 0, which rate() solves:
// constraint() is zero and a constraint error of 0 says nothing here.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "carnot/numerics/darboux.h"
#include "carnot/numerics/evenly_spread.h"
#include "carnot/numerics/gradient.h"
#include "carnot/scene/generalized_hamiltonian_scene.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/stationary.h"

namespace carnot {

// Minus the Lagrangian: H - p.v is stationary in x = (p, y) at the Legendre transform of v. With
// `held`, y in H is that instead, and x has the same y.
template <class System>
struct LegendreTransform {
  static constexpr int kDof = System::kDof;
  static constexpr int kAlgebraic = kDof + System::kAlgebraic;

  const System& system;
  const Vector<double, System::kAlgebraic>* held = nullptr;

  template <class T>
  [[nodiscard]] T hamiltonian(const T& t,
                              const Vector<T, kDof>& q,
                              const Vector<T, kDof>& v,
                              const Vector<T, kAlgebraic>& x) const {
    const Vector<T, kDof> p = part<0, kDof>(x);
    Vector<T, System::kAlgebraic> y = part<kDof, System::kAlgebraic>(x);
    T sum = -dot(p, v);
    if (held != nullptr) {
      for (int i = 0; i < System::kAlgebraic; ++i) {
        const T distance = y[i] - constant<T>((*held)[i]);
        sum += constant<T>(0.5) * distance * distance;
        y[i] = constant<T>((*held)[i]);
      }
    }
    return sum + system.hamiltonian(t, q, p, y);
  }
};

template <GeneralizedHamiltonianScene Scene>
class GeneralizedHamiltonian {
 public:
  static constexpr int kSize = Scene::kSize;
  static constexpr int kDof = Scene::kDof;
  static constexpr int kAlgebraic = kSize - 2 * kDof;
  static constexpr int kMultipliers = kAlgebraic;
  static constexpr bool kAutonomous = true;
  static_assert(kDof > 0 && kAlgebraic >= 0, "the rank of J is 2 kDof, at most kSize");

  using Square = Matrix<double, kSize, kSize>;

  // The same point in the coordinates that the integrators see.
  template <class T>
  struct Point {
    Vector<T, kDof> q;
    Vector<T, kDof> p;
    Vector<T, kAlgebraic> y;
  };

  // Throws std::invalid_argument when J is not finite, not antisymmetric, zero or not of rank
  // 2 kDof, when the scene's own T is wrong, and when the index is more than 1 everywhere.
  explicit GeneralizedHamiltonian(Scene scene) : scene_(std::move(scene)) {
    const DarbouxForm form = coordinates(scene_);
    std::copy(form.basis.begin(), form.basis.end(), basis_.data());
    std::copy(form.inverse.begin(), form.inverse.end(), inverse_.data());
    if constexpr (kAlgebraic > 0) refuse_higher_index();
  }

  [[nodiscard]] const Scene& scene() const { return scene_; }
  // T of z = T (q, p, y).
  [[nodiscard]] const Square& basis() const { return basis_; }

  // z = T (q, p, y).
  template <class T>
  [[nodiscard]] Vector<T, kSize> from_darboux(const Vector<T, kDof>& q,
                                              const Vector<T, kDof>& p,
                                              const Vector<T, kAlgebraic>& y) const {
    Vector<T, kSize> x;
    for (int i = 0; i < kDof; ++i) {
      x[i] = q[i];
      x[kDof + i] = p[i];
    }
    for (int i = 0; i < kAlgebraic; ++i) x[2 * kDof + i] = y[i];
    return apply(basis_, x);
  }

  // (q, p, y) = T^-1 z.
  template <class T>
  [[nodiscard]] Point<T> to_darboux(const Vector<T, kSize>& z) const {
    const Vector<T, kSize> x = apply(inverse_, z);
    Point<T> point;
    for (int i = 0; i < kDof; ++i) {
      point.q[i] = x[i];
      point.p[i] = x[kDof + i];
    }
    for (int i = 0; i < kAlgebraic; ++i) point.y[i] = x[2 * kDof + i];
    return point;
  }

  // Solves H_y = 0 by Newton's method from y, or from a start of its own where y is all zero.
  template <class T>
  [[nodiscard]] RateStatus rate(const T& t,
                                const Vector<T, kDof>& q,
                                const Vector<T, kDof>& p,
                                Vector<T, kAlgebraic>& y,
                                Rate<T, kDof>& out) const {
    return stationary_rate(*this, t, q, p, y, out);
  }

  template <class T>
  [[nodiscard]] T hamiltonian(const T& /*t*/,
                              const Vector<T, kDof>& q,
                              const Vector<T, kDof>& p,
                              const Vector<T, kAlgebraic>& y) const {
    return scene_.hamiltonian(from_darboux(q, p, y));
  }

  // lambda = y.
  template <class T>
  [[nodiscard]] RateStatus multipliers(const T& /*t*/,
                                       const Vector<T, kDof>& /*q*/,
                                       const Vector<T, kDof>& /*p*/,
                                       const Vector<T, kAlgebraic>& y,
                                       Vector<T, kMultipliers>& lambda) const {
    lambda = y;
    return RateStatus::kOk;
  }

  // Zero: there are none but H_y = 0.
  template <class T>
  [[nodiscard]] Vector<T, kMultipliers> constraint(const Vector<T, kDof>& /*q*/,
                                                   const Vector<T, kDof>& /*v*/) const {
    return filled<kMultipliers>(constant<T>(0));
  }

  // NaN: no metric.
  template <class T>
  [[nodiscard]] T speed(const Vector<T, kDof>& /*q*/, const Vector<T, kDof>& /*v*/) const {
    return constant<T>(std::numeric_limits<Real<T>>::quiet_NaN());
  }

  // The p of a velocity. Where H is regular in (p, y), v alone gives both, lambda is only where
  // Newton's method starts, and every velocity is admissible. Where it is not, as for velocity
  // constraints, p solves H_p = v at y = lambda; what is then left of H_y, over |v|, is returned
  // and v becomes the velocity at p. NaN, also in v, where there is no p.
  [[nodiscard]] double admissible_momentum(double t,
                                           const Vector<double, kDof>& q,
                                           Vector<double, kDof>& v,
                                           const Vector<double, kMultipliers>& lambda,
                                           Vector<double, kDof>& p) const {
    constexpr double kRegular = 1e8;  // at this condition half of the digits are left
    LegendreTransform<GeneralizedHamiltonian> transform{*this};
    Vector<double, kDof + kAlgebraic> x;
    for (int i = 0; i < kDof; ++i) x[i] = v[i];
    for (int i = 0; i < kMultipliers; ++i) x[kDof + i] = lambda[i];
    const bool regular = stationary_regularity(transform, t, q, v, x).condition < kRegular;
    if (!regular) transform.held = &lambda;
    bool found = stationary_solve(transform, t, q, v, x) == RateStatus::kOk;
    if (!found) x = filled<kDof + kAlgebraic>(0.0);  // no start at all
    found = found || stationary_solve(transform, t, q, v, x) == RateStatus::kOk;
    p = part<0, kDof>(x);
    double violated = 0;
    if (found && !regular) found = admissible_velocity(t, q, p, lambda, v, violated);
    if (found) return violated;
    v = filled<kDof>(std::numeric_limits<double>::quiet_NaN());
    return std::numeric_limits<double>::quiet_NaN();
  }

  // Of H_yy.
  [[nodiscard]] Regularity regularity(double t,
                                      const Vector<double, kDof>& q,
                                      const Vector<double, kDof>& p,
                                      const Vector<double, kAlgebraic>& y) const {
    return stationary_regularity(*this, t, q, p, y);
  }

  // The solution y nearest to lambda: on its branch.
  [[nodiscard]] RateStatus branch(double t,
                                  const Vector<double, kDof>& q,
                                  const Vector<double, kDof>& p,
                                  const Vector<double, kMultipliers>& lambda,
                                  Vector<double, kAlgebraic>& y) const {
    y = lambda;
    if constexpr (kAlgebraic > 0) {
      return stationary_solve(*this, t, q, p, y);
    } else {
      return RateStatus::kOk;
    }
  }

 private:
  static std::span<const double> numbers(const Square& a) {
    return {a.data(), static_cast<std::size_t>(a.size())};
  }
  static DarbouxForm coordinates(const Scene& scene) {
    const Square j = scene.structure_matrix();
    if constexpr (HasDarbouxBasis<Scene>) {
      const Square basis = scene.darboux_basis();
      return darboux_form(numbers(j), kSize, kDof, numbers(basis));
    } else {
      return darboux_form(numbers(j), kSize, kDof);
    }
  }

  template <class T>
  static T scaled(const T& x, double factor) {
    if constexpr (kIsJet<T>) {
      T result;
      result.a = scaled(x.a, factor);
      for (int i = 0; i < T::kDirections; ++i) result.v[i] = scaled(x.v[i], factor);
      return result;
    } else {
      return T(factor) * x;
    }
  }

  // Most matrices of interest are sparse.
  template <class T>
  static Vector<T, kSize> apply(const Square& matrix, const Vector<T, kSize>& x) {
    Vector<T, kSize> result = filled<kSize>(constant<T>(0));
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        if (matrix(i, j) != 0) result[i] += scaled(x[j], matrix(i, j));
      }
    }
    return result;
  }

  // The velocity at p, on the branch of lambda, and how far lambda was from it: |H_y| / |v|.
  bool admissible_velocity(double t,
                           const Vector<double, kDof>& q,
                           const Vector<double, kDof>& p,
                           const Vector<double, kMultipliers>& lambda,
                           Vector<double, kDof>& v,
                           double& violated) const {
    if constexpr (kAlgebraic > 0) {
      const StationaryEquations<GeneralizedHamiltonian, double> equations{*this, t, q, p};
      const double size = v.norm();
      violated = equations.residual(lambda).norm();
      if (size > 0) violated /= size;
    }
    Vector<double, kAlgebraic> y = lambda;
    Rate<double, kDof> rate_at_p;
    if (rate(t, q, p, y, rate_at_p) != RateStatus::kOk) return false;
    v = rate_at_p.q_dot;
    return true;
  }

  // Looks at H_yy in a few points that no scene has chosen.
  void refuse_higher_index() const {
    constexpr int kPoints = 6;
    bool singular = false;
    for (int k = 0; k < kPoints; ++k) {
      Vector<double, kSize> z;
      for (int i = 0; i < kSize; ++i) z[i] = evenly_spread(k * kSize + i + 1);
      Matrix<double, kAlgebraic, kSize> derivatives;
      if (!kernel_derivatives(z, derivatives)) continue;
      if (regular_in_kernel(derivatives)) return;
      singular = true;
    }
    if (!singular) return;  // H is not finite there: rate() will see
    throw std::invalid_argument(
        "index higher than 1: H_yy is singular wherever it was tried, y being the kernel variables "
        "of J. A holonomic constraint written as lambda h(q) is of this kind; the method does not "
        "converge there");
  }

  // (H_yq, H_yp, H_yy) at z. False where they are not finite.
  bool kernel_derivatives(const Vector<double, kSize>& z,
                          Matrix<double, kAlgebraic, kSize>& derivatives) const {
    using J = Jet<double, kSize>;
    using Equations = StationaryEquations<GeneralizedHamiltonian, double>;
    const Vector<J, kSize> x = seeded(apply(inverse_, z));
    const Vector<J, kAlgebraic> rows = Equations::derivative(
        *this, J(0), part<0, kDof>(x), part<kDof, kDof>(x), part<2 * kDof, kAlgebraic>(x));
    for (int i = 0; i < kAlgebraic; ++i) {
      for (int j = 0; j < kSize; ++j) derivatives(i, j) = rows[i].v[j];
    }
    return all_finite(derivatives);
  }

  // Whether H_yy is regular, its round-off set to zero. The columns of T for y are exact to a few
  // eps, so that a derivative in y has as much of the other derivatives in it.
  static bool regular_in_kernel(const Matrix<double, kAlgebraic, kSize>& derivatives) {
    constexpr double kRoundOff = kRankTolerance * kSize * std::numeric_limits<double>::epsilon();
    Matrix<double, kAlgebraic, kAlgebraic> hessian;
    Vector<double, kAlgebraic> size = filled<kAlgebraic>(0.0);
    for (int i = 0; i < kAlgebraic; ++i) {
      for (int j = 0; j < kSize; ++j) size[i] += std::abs(derivatives(i, j));
      for (int j = 0; j < kAlgebraic; ++j) hessian(i, j) = derivatives(i, 2 * kDof + j);
    }
    for (int i = 0; i < kAlgebraic; ++i) {
      for (int j = 0; j < kAlgebraic; ++j) {
        if (std::abs(hessian(i, j)) <= kRoundOff * (size[i] + size[j])) hessian(i, j) = 0;
      }
    }
    return ScaledLu<double, kAlgebraic>(hessian).regular();
  }

  Scene scene_;
  Square basis_;
  Square inverse_;
};

}  // namespace carnot
