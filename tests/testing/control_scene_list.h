// The optimal-control scenes that every law is tried on.
#pragma once

#include "carnot/scenes/bicycle.h"
#include "carnot/scenes/boat.h"
#include "carnot/scenes/brockett.h"
#include "carnot/scenes/double_integrator.h"
#include "carnot/scenes/grushin.h"
#include "carnot/scenes/pendulum.h"
#include "testing/scene_list.h"

namespace carnot::test {

using ControlScenes = ::testing::Types<scenes::Grushin,
                                       scenes::Brockett,
                                       scenes::Bicycle,
                                       scenes::Pendulum,
                                       scenes::DoubleIntegrator,
                                       scenes::Boat>;
// f linear and l quadratic in u.
using LinearControlScenes = ::testing::Types<scenes::Grushin,
                                             scenes::Brockett,
                                             scenes::Bicycle,
                                             scenes::Pendulum,
                                             scenes::DoubleIntegrator>;
// Without drift besides: p -> -p reverses time.
using DriftlessScenes = ::testing::Types<scenes::Grushin, scenes::Brockett, scenes::Bicycle>;

template <>
inline scenes::Bicycle uneven<scenes::Bicycle>() {
  return {1.3};
}
template <>
inline scenes::DoubleIntegrator uneven<scenes::DoubleIntegrator>() {
  return {0.7, 0.4};
}
template <>
inline scenes::Boat uneven<scenes::Boat>() {
  return {0.6};
}

}  // namespace carnot::test
