// gauss8 with its tangent on each of ChartedScenes, compiled once for the tests of the flows.
#pragma once

#include "carnot/flow/tangent_flow.h"
#include "carnot/step/gauss.h"
#include "testing/charted_scenes.h"
#include "testing/geometry_laws.h"

namespace carnot::test {

// Advances z, and m with it, by equal steps over `duration`.
template <class Scene>
FlowReport gauss8_run(const Scene& scene,
                      double duration,
                      long steps,
                      State<double, Scene::kDof>& z,
                      TangentState<Scene::kDof>& m) {
  using System = VelocityConstraints<Scene>;
  const System system(scene);
  Gauss<System, 4> method(system);
  const auto go_on = [](long, const auto&, const auto&) { return true; };
  return tangent_flow(method, StepPlan::equal(0, duration, steps), z, m, go_on);
}

template <class Scene>
using Gauss8Run =
    FlowReport(const Scene&, double, long, State<double, Scene::kDof>&, TangentState<Scene::kDof>&);

extern template Gauss8Run<scenes::Martinet> gauss8_run;
extern template Gauss8Run<scenes::Engel> gauss8_run;
extern template Gauss8Run<scenes::Trailers<3>> gauss8_run;
extern template Gauss8Run<scenes::Satellite> gauss8_run;
extern template Gauss8Run<scenes::PlateBall> gauss8_run;
extern template Gauss8Run<scenes::FallingCat> gauss8_run;

}  // namespace carnot::test
