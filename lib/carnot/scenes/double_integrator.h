// The linear-quadratic regulator of a mass on a line: x' = v, v' = u, cost (a x^2 + b v^2 + u^2)/2.
//
// u = p_v, and p_x' = a x, p_v' = b v - p_x, so x'''' = b x'' - a x: linear, drift and all. With
// a = b = 0, the least effort, x is a cubic of time. Invariants: H.
// Source: Bryson & Ho, Applied Optimal Control (1975), ch. 5.
#pragma once

#include <array>
#include <cmath>
#include <complex>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct DoubleIntegrator {
  static constexpr int kDof = 2;
  static constexpr int kControls = 1;

  double position_weight = 1;  // a
  double velocity_weight = 1;  // b

  template <class T>
  [[nodiscard]] Vector<T, 2> drift(const Vector<T, 2>& q) const {
    return {q[1], 0};
  }

  template <class T>
  [[nodiscard]] Matrix<T, 2, 1> frame(const Vector<T, 2>& /*q*/) const {
    return {0, 1};
  }

  template <class T>
  [[nodiscard]] T state_cost(const Vector<T, 2>& q) const {
    return 0.5 * (position_weight * q[0] * q[0] + velocity_weight * q[1] * q[1]);
  }

  // d/dq [p.(f0 + F u) - l].
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_gradient(const Vector<T, 2>& q,
                                            const Vector<T, 2>& p,
                                            const Vector<T, 1>& /*u*/) const {
    return {-position_weight * q[0], p[0] - velocity_weight * q[1]};
  }

  // (q, p) at time t of the extremal with (q0, p0) at time 0.
  //
  // With g the solution that starts from g = g' = g'' = 0, g''' = 1,
  //   x = x(0) (g''' - b g') + x'(0) (g'' - b g) + x''(0) g' + x'''(0) g.
  [[nodiscard]] Vector<double, 4> closed_form(const Vector<double, 2>& q0,
                                              const Vector<double, 2>& p0,
                                              double t) const {
    const double a = position_weight;
    const double b = velocity_weight;
    std::array<double, 7> g = fundamental(t);
    for (int k = 4; k < 7; ++k) g[k] = b * g[k - 2] - a * g[k - 4];
    const std::array<double, 4> start{q0[0], q0[1], p0[1], b * q0[1] - p0[0]};
    std::array<double, 4> x{};  // x and three derivatives
    for (int k = 0; k < 4; ++k) {
      x[k] = start[0] * (g[k + 3] - b * g[k + 1]) + start[1] * (g[k + 2] - b * g[k]) +
             start[2] * g[k + 1] + start[3] * g[k];
    }
    return {x[0], x[1], b * x[1] - x[3], x[2]};
  }

  static constexpr auto parameters() {
    using P = Parameter<DoubleIntegrator>;
    return std::array{P{"position_weight",
                        &DoubleIntegrator::position_weight,
                        "1/time^4",
                        Range::non_negative(),
                        "weight of x^2 against that of u^2"},
                      P{"velocity_weight",
                        &DoubleIntegrator::velocity_weight,
                        "1/time^2",
                        Range::non_negative(),
                        "weight of v^2 against that of u^2"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "double-integrator";
    info.summary = "linear-quadratic control of a mass: x' = v, v' = u";
    info.reference = "Bryson & Ho, Applied Optimal Control (1975), ch. 5";
    info.configuration = {{"x", "length", 0}, {"v", "length/time", 0}};
    info.symmetries.mirrors = {{-1, -1}};
    return info;
  }

 private:
  // g, g', g'', g''' at t. The exponents are roots of r^4 = b r^2 - a. With s1, s2 = r^2 and
  // e(s) = sinh(sqrt(s) t)/sqrt(s), entire in s, the k-th derivative of g is the divided difference
  // over s1, s2 of the k-th derivative of e in t: e, cosh(sqrt(s) t), s e, s cosh(sqrt(s) t).
  [[nodiscard]] std::array<double, 7> fundamental(double t) const {
    using Complex = std::complex<double>;
    const Complex root =
        std::sqrt(Complex(velocity_weight * velocity_weight - 4 * position_weight));
    const Complex s1 = 0.5 * (velocity_weight + root);
    const Complex s2 = 0.5 * (velocity_weight - root);
    const auto e = [t](Complex s) {
      return s == 0.0 ? Complex(t) : std::sinh(std::sqrt(s) * t) / std::sqrt(s);
    };
    const auto c = [t](Complex s) { return std::cosh(std::sqrt(s) * t); };
    if (root != 0.0) {
      const auto difference = [&](Complex first, Complex second) {
        return ((first - second) / root).real();
      };
      return {difference(e(s1), e(s2)),
              difference(c(s1), c(s2)),
              difference(s1 * e(s1), s2 * e(s2)),
              difference(s1 * c(s1), s2 * c(s2))};
    }
    const double s = s1.real();  // b^2 = 4 a: the derivatives by s
    const double e_s = s == 0 ? t * t * t / 6 : (t * c(s).real() - e(s).real()) / (2 * s);
    const double c_s = 0.5 * t * e(s).real();
    return {e_s, c_s, e(s).real() + s * e_s, c(s).real() + s * c_s};
  }
};

}  // namespace carnot::scenes
