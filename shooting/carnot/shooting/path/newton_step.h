// When a damped step of Newton's method is taken; shared by discrete_newton.cc and newton_lanes.cc.
#pragma once

namespace carnot::internal {

inline constexpr double kShortestStep = 1.0 / 64;
// A residual that no step makes smaller is round-off up to here, relative to its size at the first
// iterate's momenta: that of coordinates far from zero, magnified near singular frames.
inline constexpr double kRoundedOff = 1e-6;

// Whether a step, a share of Newton's, makes the residual fall enough.
inline bool makes_fall(double step, double residual, double reached) {
  return reached < (1 - 0.1 * step) * residual;
}
// The same of the length of Newton's step, when the next one is made with the same matrix.
inline bool makes_shorter(double step, double length, double simplified) {
  return simplified < (1 - 0.25 * step) * length;
}

}  // namespace carnot::internal
