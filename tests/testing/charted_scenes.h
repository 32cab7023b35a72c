// The scenes that have singular charts or more symmetries than planar ones, for laws that choose
// their points with care.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "carnot/scenes/engel.h"
#include "carnot/scenes/falling_cat.h"
#include "carnot/scenes/martinet.h"
#include "carnot/scenes/plate_ball.h"
#include "carnot/scenes/satellite.h"
#include "carnot/scenes/trailers.h"
#include "testing/runs.h"

namespace carnot::test {

// Three trailers stand for one and two, which are the same text.
using ChartedScenes = ::testing::Types<scenes::Martinet,
                                       scenes::Engel,
                                       scenes::Trailers<3>,
                                       scenes::Satellite,
                                       scenes::PlateBall,
                                       scenes::FallingCat>;

// Rigid motions of the plane are symmetries.
using MorePlanarScenes = ::testing::Types<scenes::Trailers<3>, scenes::PlateBall>;
// The coordinates are singular somewhere.
using ChartScenes = ::testing::Types<scenes::Satellite, scenes::PlateBall>;

// The scene with parameters that are all different, so that no factor 0 or 1 hides a mistake.
template <class Scene>
Scene uneven_scene() {
  if constexpr (std::is_same_v<Scene, scenes::Satellite>) {
    return {1.7, 0.6};
  } else if constexpr (std::is_same_v<Scene, scenes::Trailers<3>>) {
    return {0.3};
  } else {
    return {};
  }
}

// In [-scale, scale]^n, and not near a singularity of the chart.
template <class Scene>
Vector<double, Scene::kDof> regular_configuration(const Scene& scene,
                                                  Generator& generator,
                                                  double scale) {
  Vector<double, Scene::kDof> q = random_vector<Scene::kDof>(generator, scale);
  if constexpr (HasChart<Scene>) {
    constexpr double kFar = 0.4;  // numbers grow like 1 / chart^2
    while (std::abs(scene.chart(q)) < kFar) q = random_vector<Scene::kDof>(generator, scale);
  }
  return q;
}

// A start from which a flow over a time of 1 stays away from the singularities of the chart:
// attitudes near the identity, slow turns.
template <class Scene>
State<double, Scene::kDof> regular_state(const Scene& /*scene*/, Generator& generator) {
  constexpr int n = Scene::kDof;
  const double size = HasChart<Scene> ? 0.4 : 1;
  const Vector<double, n> q = random_vector<n>(generator, size);
  const Vector<double, n> p = random_vector<n>(generator, size);
  return make_state<double, n>(q, p);
}

}  // namespace carnot::test
