#include "carnot/shooting/shoot/survey.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "carnot/shooting/linear/round_off.h"

namespace carnot::internal {
namespace {

// Times of [0, T], `samples` in all, that belong to segment i: [t_i, t_{i+1}), the last one closed.
std::vector<double> times_of_segment(const BoundaryValueProblem& problem,
                                     int segments,
                                     int i,
                                     long samples) {
  const StepPlan whole = StepPlan::equal(0, problem.time, 1);
  std::vector<double> times;
  const double start = problem.time * i / segments;
  const double end = problem.time * (i + 1) / segments;
  const double slack = kTimeRoundOff * problem.time;
  for (const double t : sample_times(whole, samples)) {
    const bool last = i + 1 == segments;
    if (t >= start - slack && (last || t < end - slack)) times.push_back(std::min(t, end));
  }
  return times;
}

template <class T>
void append(std::vector<T>& to, std::vector<T>& more) {
  if (to.empty()) {
    to = std::move(more);
  } else {
    to.insert(to.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
  }
}

// `work` was done before.
void append(Trajectory& to, Trajectory more, double work) {
  for (double& done : more.work) done += work;
  append(to.t, more.t);
  append(to.q, more.q);
  append(to.p, more.p);
  append(to.lambda, more.lambda);
  append(to.hamiltonian, more.hamiltonian);
  append(to.work, more.work);
}

}  // namespace

FlowSummary survey(const BoundaryValueProblem& problem,
                   const Knots& knots,
                   long steps,
                   long samples) {
  FlowSummary total;
  double initial = 0;
  std::vector<double> velocity(knots.dof), lambda(problem.dynamics.multipliers);
  for (int i = 0; i < knots.segments; ++i) {
    std::vector<double> z(knots.at(i), knots.at(i) + 2 * knots.dof);
    MonitorOptions options;
    options.times = times_of_segment(problem, knots.segments, i, samples);
    const std::span<const double> at(z);
    const StepPlan plan = knot_plan(problem, knots.segments, i, steps);
    const double energy =
        problem.dynamics
            .evaluate(plan.start, at.first(knots.dof), at.subspan(knots.dof), velocity, lambda)
            .hamiltonian;
    if (i == 0) initial = energy;
    FlowSummary part = problem.dynamics.monitored_flow(plan, z, options);
    total.report = part.report;
    if (!part.completed()) return total;
    total.action += part.action;
    total.length += part.length;
    total.energy_drift =
        std::max(total.energy_drift, part.energy_drift + std::abs(energy - initial));
    total.constraint_error = std::max(total.constraint_error, part.constraint_error);
    append(total.trajectory, std::move(part.trajectory), total.work);
    total.work += part.work;
  }
  return total;
}

Trajectory samples_of(const BoundaryValueProblem& problem,
                      const Knots& knots,
                      long steps,
                      long samples) {
  const long intervals = std::max(1L, samples - 1);
  const long each = (steps + intervals - 1) / intervals;
  return survey(problem, knots, each * intervals, samples).trajectory;
}

}  // namespace carnot::internal
