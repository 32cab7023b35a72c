// Scenes as the program has them: compiled once, and not again for the tests of what a flow keeps.
#pragma once

#include <span>
#include <string>
#include <utility>

#include "carnot/dynamics.h"
#include "carnot/system/system_of.h"
#include "catalogue/scene_choice.h"
#include "testing/geometry_laws.h"

namespace carnot::test {

// The program's Dynamics of a scene with the parameters of this one.
template <class Scene>
Dynamics program_dynamics(const Scene& scene, const std::string& method) {
  apps::ParameterValues values;
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      values[parameter.name] = scene.*parameter.value;
    }
  }
  return apps::find_scene(scene.info().name).make(values, method);
}

// What such a Dynamics does with a state, and with a tangent that starts as the identity.
template <int n>
Run<n> run_of(Dynamics dynamics) {
  return [dynamics = std::move(dynamics)](double duration, long steps, auto& z, auto& m) {
    Eigen::Matrix<double, 2 * n, 2 * n, Eigen::RowMajor> rows;
    const auto plan = StepPlan::equal(0, duration, steps);
    const FlowReport report =
        dynamics.tangent_flow(plan, span_of(z.value), std::span<double>(rows.data(), 4 * n * n));
    z.compensation.setZero();
    m.value = rows;
    m.compensation.setZero();
    return report;
  };
}

}  // namespace carnot::test
