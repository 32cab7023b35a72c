// Kapitza's pendulum, whose pivot is shaken up and down: L depends on time.
//
// The pivot is at height Y(t) = amplitude cos(frequency t), theta is measured from hanging down.
// Per unit mass, without the terms of t alone,
//
//   L = length^2 theta'^2/2 + length Y' theta' sin(theta) + gravity length cos(theta),
//   H = (p - length Y' sin(theta))^2/(2 length^2) - gravity length cos(theta).
//
// H is not conserved: dH/dt = H_t = -L_t = -length Y'' theta' sin(theta). Without shaking it is.
// Upside down the pendulum is stable where amplitude^2 frequency^2 > 2 gravity length (for a fast,
// small shake). Source: Landau & Lifshitz, Mechanics (1976), sec. 30, after Kapitza (1951).
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct KapitzaPendulum {
  static constexpr int kDof = 1;
  static constexpr int kMultipliers = 0;
  static constexpr bool kTimeDependent = true;

  double length = 1;
  double gravity = 1;
  double amplitude = 0.1;
  double frequency = 20;

  template <class T>
  [[nodiscard]] T lagrangian(const T& t, const Vector<T, 1>& q, const Vector<T, 1>& v) const {
    using std::cos, std::sin;
    const T l = length;
    const T pivot = -amplitude * frequency * sin(frequency * t);  // Y'
    const T along = l * v[0];
    return 0.5 * along * along + pivot * along * sin(q[0]) + gravity * l * cos(q[0]);
  }

  static constexpr auto parameters() {
    using P = Parameter<KapitzaPendulum>;
    return std::array{
        P{"length", &KapitzaPendulum::length, "length", Range::positive(), "of the pendulum"},
        P{"gravity", &KapitzaPendulum::gravity, "length/time^2", Range{}, "acceleration downwards"},
        P{"amplitude",
          &KapitzaPendulum::amplitude,
          "length",
          Range::non_negative(),
          "of the pivot's motion"},
        P{"frequency",
          &KapitzaPendulum::frequency,
          "rad/time",
          Range::non_negative(),
          "of the pivot's motion"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "kapitza-pendulum";
    info.summary = "a pendulum on a pivot that is shaken up and down: L depends on time";
    info.reference = "Landau & Lifshitz, Mechanics (1976), sec. 30";
    info.configuration = {{"theta", "rad", 2 * std::numbers::pi}};
    info.symmetries.mirrors = {{-1}};
    return info;
  }
};

}  // namespace carnot::scenes
