// From geodesics to a picture of them:
//
//   const BoundaryValueProblem problem(make_dynamics(Coin{}), from, to);
//   const GeodesicReport report = find_geodesics(problem);
//   plots::write_figure("coin.png", problem.dynamics.info, plots::curves_of(report.geodesics));
//
// Whatever has a trajectory, an action, perhaps a length, and the values of the scene's extremes
// can be drawn; carnot::plots knows nothing of how it was found.
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/figure.h"

namespace carnot::plots {

template <class E>
concept Extremal = requires(const E& extremal) {
  { extremal.trajectory } -> std::convertible_to<const Trajectory&>;
  { extremal.action } -> std::convertible_to<double>;
  { extremal.length } -> std::convertible_to<std::optional<double>>;
  { extremal.extremes } -> std::convertible_to<const std::vector<std::pair<std::string, double>>&>;
};

template <class E>
concept KeepsToLimits = requires(const E& extremal) {
  extremal.limits.front().active;
};

// One curve for each, called "geodesic 1", "geodesic 2", .... The curves point at the trajectories
// of `extremals`, which must live as long.
template <Extremal E>
std::vector<Curve> curves_of(const std::vector<E>& extremals) {
  std::vector<Curve> curves;
  for (const E& extremal : extremals) {
    curves.push_back({"geodesic " + std::to_string(curves.size() + 1),
                      &extremal.trajectory,
                      extremal.action,
                      extremal.length,
                      extremal.extremes,
                      {}});
    if constexpr (KeepsToLimits<E>) {
      for (const auto& limit : extremal.limits) {
        auto& times = curves.back().on_limits;
        times.insert(times.end(), limit.active.begin(), limit.active.end());
      }
    }
  }
  return curves;
}
template <Extremal E>
std::vector<Curve> curves_of(const std::vector<E>&& extremals) = delete;  // they would be gone

}  // namespace carnot::plots
