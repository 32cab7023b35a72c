// An extremal at chosen times, as plain numbers for output and plots.
#pragma once

#include <vector>

#include "carnot/flow.h"

namespace carnot {

// One row per time; q, p of length n, lambda of length k.
struct Trajectory {
  std::vector<double> t;
  std::vector<std::vector<double>> q;
  std::vector<std::vector<double>> p;
  std::vector<std::vector<double>> lambda;
  std::vector<double> hamiltonian;
};

// Observer of flow() that records `samples` equidistant times of the plan, ends included. A sample
// between nodes is a shortened full-order step from the node before; the run itself is not touched.
template <class Stepper>
class Recorder {
 public:
  using System = typename Stepper::System;
  static constexpr int n = Stepper::kDof;
  static constexpr int k = System::kMultipliers;

  Recorder(const System& system, const StepPlan& plan, long samples, const State<double, n>& z)
      : system_(system), plan_(plan), samples_(samples), node_(z) {
    if (samples_ > 0) record(plan.start, z);
  }

  void operator()(long i, const State<double, n>& z) {
    const double from = plan_.time(i);
    const double to = plan_.time(i + 1);
    const double tolerance = kNodeTolerance * (to - from);
    while (next() < samples_ && std::abs(time(next()) - from) < std::abs(to - from) + tolerance) {
      const double t = time(next());
      if (std::abs(t - to) <= std::abs(tolerance)) {
        record(t, z);
        continue;
      }
      Stepper shortened(system_);
      State<double, n> between = node_;
      if (shortened.step(from, t - from, between).status != StepStatus::kOk) between = node_;
      record(t, between);
    }
    node_ = z;
  }

  [[nodiscard]] const Trajectory& trajectory() const { return trajectory_; }

 private:
  static constexpr double kNodeTolerance = 1e-9;  // of a step: nearer than this is the node

  [[nodiscard]] long next() const { return static_cast<long>(trajectory_.t.size()); }
  [[nodiscard]] double time(long i) const {
    const double fraction = static_cast<double>(i) / static_cast<double>(samples_ - 1);
    return i == samples_ - 1 ? plan_.end : plan_.start + fraction * (plan_.end - plan_.start);
  }

  void record(double t, const State<double, n>& z) {
    const Vector<double, n> q = z.value.template head<n>();
    const Vector<double, n> p = z.value.template tail<n>();
    Vector<double, System::kAlgebraic> y = Vector<double, System::kAlgebraic>::Zero();
    Vector<double, k> lambda = Vector<double, k>::Zero();
    Rate<double, n> rate;
    bool ok = system_.rate(t, q, p, y, rate) == RateStatus::kOk;
    ok = ok && system_.multipliers(q, p, rate.q_dot, lambda) == RateStatus::kOk;
    trajectory_.t.push_back(t);
    trajectory_.q.emplace_back(q.data(), q.data() + n);
    trajectory_.p.emplace_back(p.data(), p.data() + n);
    trajectory_.lambda.emplace_back(lambda.data(), lambda.data() + k);
    trajectory_.hamiltonian.push_back(ok ? system_.hamiltonian(t, q, p, y)
                                         : std::numeric_limits<double>::quiet_NaN());
  }

  const System& system_;
  StepPlan plan_;
  long samples_;
  State<double, n> node_;
  Trajectory trajectory_;
};

}  // namespace carnot
