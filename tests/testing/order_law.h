// The order of Gauss methods, measured on the vehicle in the potential -cos r: nonlinear, with no
// closed form that a method could be lucky on.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "carnot/scenes/vehicle_cosine.h"
#include "carnot/step/gauss.h"
#include "testing/order.h"
#include "testing/runs.h"

namespace carnot::test {

using OrderSystem = VelocityConstraints<scenes::VehicleCosine>;
constexpr int kOrderDuration = 3;

// The state after `steps` equal steps. The step has the precision of T, unlike that of a StepPlan.
template <int s, class T>
Vector<T, 8> end_point(const OrderSystem& system, int steps) {
  Gauss<OrderSystem, s, T> method(system);
  auto z = cast_state<T, 4>(vehicle_start(system));
  const T h = T(kOrderDuration) / T(steps);
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(method.step(T(i) * h, h, z).status, StepStatus::kOk);
  }
  return z.value;
}

// Slope of log(error) over log(h) for these numbers of steps, against a reference end point.
template <int s, class T>
LineFit measure_order(const OrderSystem& system,
                      const Vector<T, 8>& reference,
                      const std::vector<int>& step_counts) {
  // Round-off of a hundred steps, and errors small enough for the leading term to rule.
  const double plateau = 100 * static_cast<double>(std::numeric_limits<T>::epsilon());
  constexpr double kCeiling = 1e-2;
  std::vector<double> steps;
  std::vector<double> errors;
  for (const int count : step_counts) {
    const Vector<T, 8> error = end_point<s, T>(system, count) - reference;
    steps.push_back(static_cast<double>(kOrderDuration) / count);
    errors.push_back(static_cast<double>(error.cwiseAbs().maxCoeff()));
  }
  return fit_order(steps, errors, plateau, kCeiling);
}

inline void expect_order(const LineFit& fit, double order) {
  constexpr double kSlopeTolerance = 0.15;
  EXPECT_GE(fit.points, 3);
  EXPECT_GT(fit.correlation, 0.99);
  EXPECT_NEAR(fit.slope, order, kSlopeTolerance);
}

}  // namespace carnot::test
