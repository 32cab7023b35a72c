// What is measured at the stages of a step.
#pragma once

#include <algorithm>
#include <array>

#include "carnot/system/measures.h"

namespace carnot {

// Its stages lie in rows of kErasedLanes.
template <class Stepper>
concept HasRows = Stepper::kRows;

namespace stage_measures {

// Of stages first, ..., first + count - 1.
template <class Stepper>
void measure_some(const typename Stepper::System& system,
                  const Stepper& step,
                  int first,
                  int count,
                  std::array<PointMeasures, kErasedLanes>& out) {
  constexpr int n = Stepper::kDof;
  constexpr int m = Stepper::System::kAlgebraic;
  std::array<double, kErasedLanes> time;
  std::array<double, kErasedLanes> weights;
  for (int l = 0; l < count; ++l) {
    time[l] = step.stage_time(first + l);
    weights[l] = step.last_step() * step.tableau().omega[first + l];
  }
  const auto at = [&](const double* z, const double* dq, const double* y) {
    measure_points(system, count, time.data(), weights.data(), z, dq, y, out.data());
  };
  if constexpr (HasRows<Stepper>) {
    at(step.stages().data(), step.increments().data(), step.algebraic().data());
  } else {
    std::array<double, kErasedLanes * 2 * n> z;
    std::array<double, kErasedLanes * n> dq;
    std::array<double, kErasedLanes * m> y;
    int used = m;
    if constexpr (IsErased<typename Stepper::System>) used = system.algebraic_count();
    for (int l = 0; l < count; ++l) {
      for (int k = 0; k < 2 * n; ++k) z[k * kErasedLanes + l] = step.stages()(k, first + l);
      for (int k = 0; k < n; ++k) dq[k * kErasedLanes + l] = step.increments()(k, first + l);
      const Vector<double, m> solution = step.algebraic(first + l);
      for (int k = 0; k < used; ++k) y[k * kErasedLanes + l] = solution[k];
    }
    at(z.data(), dq.data(), y.data());
  }
}

}  // namespace stage_measures

// Calls visit(b_i, measures of stage i) for every stage of the last step.
template <class Stepper, class Visit>
void measure_stages(const typename Stepper::System& system,
                    const Stepper& step,
                    const Visit& visit) {
  const auto& tableau = step.tableau();
  std::array<PointMeasures, kErasedLanes> measures;
  for (int first = 0; first < tableau.stages(); first += kErasedLanes) {
    const int count = std::min(kErasedLanes, tableau.stages() - first);
    stage_measures::measure_some(system, step, first, count, measures);
    for (int l = 0; l < count; ++l) visit(tableau.b[first + l], measures[l]);
  }
}

}  // namespace carnot
