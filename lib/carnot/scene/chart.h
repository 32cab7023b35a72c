// Coordinates that are singular somewhere: of scenes of any kind.
#pragma once

#include <cmath>
#include <concepts>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// chart(q) vanishes where the coordinates are singular, such as cos(theta) of Euler angles.
template <class S>
concept HasChart = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.chart(q) } -> std::convertible_to<double>;
};

// Nearer than this to a singularity of the chart, velocities lose half of their digits.
inline constexpr double kNearSingularChart = 1e-8;

// False where q is at a singularity of the chart; true for a scene without one.
template <class Scene, class T>
[[nodiscard]] bool regular_chart(const Scene& scene, const Vector<T, Scene::kDof>& q) {
  if constexpr (HasChart<Scene>) {
    using std::abs;
    return all(abs(value_of(scene.chart(q))) > Real<T>(kNearSingularChart));
  } else {
    return true;
  }
}

}  // namespace carnot
