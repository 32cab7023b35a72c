// An extremal at chosen times, as plain numbers for output and plots.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "carnot/flow/flow.h"
#include "carnot/flow/stage_measures.h"
#include "carnot/system/measures.h"

namespace carnot {

// Observer of flow() that records the state at given times of the plan, in its direction. A time
// between nodes is reached by a shortened full-order step from the node before; the run itself is
// not touched. A sample that fails is NaN.
template <class Stepper>
class Recorder {
 public:
  using System = typename Stepper::System;
  static constexpr int n = Stepper::kDof;
  static constexpr int k = System::kMultipliers;
  using Algebraic = Vector<double, System::kAlgebraic>;

  // `step` is ready for the first step.
  Recorder(const StepPlan& plan,
           std::vector<double> times,
           const Stepper& step,
           const State<double, n>& z)
      : plan_(plan), times_(std::move(times)), node_(z), branch_(step.branch()) {
    reserve(times_.size());
    const double tolerance = kNodeTolerance * std::abs(plan.length(0));
    if (times_.empty() || std::abs(times_[0] - plan.start) > tolerance) return;
    record(step.system(), times_[0], z, branch_, 0);
  }
  Recorder(const StepPlan& plan, long samples, const Stepper& step, const State<double, n>& z)
      : Recorder(plan, sample_times(plan, samples), step, z) {}

  // `work` is the integral of H_t up to the node that the step has reached.
  void operator()(long i, const Stepper& step, const State<double, n>& z, double work) {
    const double from = plan_.time(i);
    const double to = plan_.time(i + 1);
    const double tolerance = kNodeTolerance * std::abs(to - from);
    while (next() < times_.size() &&
           std::abs(times_[next()] - from) <= std::abs(to - from) + tolerance) {
      const double t = times_[next()];
      if (std::abs(t - to) <= tolerance) {
        record(step.system(), t, z, step.branch(), work);
        continue;
      }
      Stepper shortened(step.system(), step.tableau());
      shortened.start_on(branch_);
      State<double, n> between = node_;
      double work_between = work_;
      if (shortened.step(from, t - from, between).status == StepStatus::kOk) {
        measure_stages(step.system(), shortened, [&](double b, const PointMeasures& at) {
          if (b != 0) work_between += (t - from) * b * at.power;
        });
      } else {
        std::fill_n(between.value.data(), 2 * n, std::numeric_limits<double>::quiet_NaN());
      }
      record(step.system(), t, between, shortened.branch(), work_between);
    }
    node_ = z;
    work_ = work;
    branch_ = step.branch();
  }

  // Hands over what was recorded.
  [[nodiscard]] Trajectory take() { return std::move(trajectory_); }

 private:
  static constexpr double kNodeTolerance = 1e-9;  // of a step: nearer than this is the node

  [[nodiscard]] std::size_t next() const { return trajectory_.t.size(); }

  void reserve(std::size_t samples) {
    trajectory_.t.reserve(samples);
    trajectory_.q.reserve(samples);
    trajectory_.p.reserve(samples);
    trajectory_.lambda.reserve(samples);
    trajectory_.hamiltonian.reserve(samples);
    trajectory_.work.reserve(samples);
  }

  void record(const System& system, double t, const State<double, n>& z, Algebraic y, double work) {
    const Vector<double, n> q(z.value.data());
    const Vector<double, n> p(z.value.data() + n);
    Vector<double, k> lambda;
    std::fill_n(lambda.data(), k, 0.0);
    Rate<double, n> rate;
    bool ok = system.rate(t, q, p, y, rate) == RateStatus::kOk;
    ok = ok && system.multipliers(t, q, p, y, lambda) == RateStatus::kOk;
    trajectory_.t.push_back(t);
    trajectory_.q.emplace_back(q.data(), q.data() + n);
    trajectory_.p.emplace_back(p.data(), p.data() + n);
    trajectory_.lambda.emplace_back(lambda.data(), lambda.data() + multiplier_count(system));
    trajectory_.hamiltonian.push_back(ok ? system.hamiltonian(t, q, p, y)
                                         : std::numeric_limits<double>::quiet_NaN());
    trajectory_.work.push_back(work);
  }

  StepPlan plan_;
  std::vector<double> times_;
  State<double, n> node_;
  Algebraic branch_;
  double work_ = 0;  // up to node_
  Trajectory trajectory_;
};

}  // namespace carnot
