// The methods of this program on a benchmark trajectory, all through Dynamics.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "benchmark/benchmark_contest.h"
#include "carnot/laws/step_choice.h"
#include "catalogue/scene_choice.h"

namespace carnot::apps {
namespace {

constexpr long kBatch = 64;
constexpr const char* kAdaptiveBatch = "dop853";

// What is known of a trajectory whose steps were chosen.
struct ChosenFlow {
  bool completed = false;
  std::string message;
  StepPlan plan;
  long evaluations = 0;
};

// From a tolerance alone to the end point, in place.
ChosenFlow flow_by_tolerance(const Dynamics& dynamics,
                             double duration,
                             double tolerance,
                             std::vector<double>& z) {
  if (dynamics.has_automatic_flow()) {
    const AutomaticFlow flow = dynamics.automatic_flow(0, duration, tolerance, z);
    if (flow.reached) return {true, "", flow.plan, flow.evaluations};
  }
  const StepChoice choice = choose_steps(dynamics, 0, duration, z, tolerance);
  StepPlan plan = StepPlan::equal(0, duration, std::max(1L, choice.count));
  plan.stop = choice.stop;
  if (choice.status != StepChoiceStatus::kOk) return {false, choice.message, plan, 0};
  const FlowReport report = dynamics.flow(plan, z);
  return {report.completed(),
          std::string(report.reason()),
          plan,
          choice.evaluations + report.evaluations};
}

// Many trajectories in place, one (q, p) after the other. Evaluations of all; negative on failure.
double flow_many(const Dynamics& dynamics,
                 const StepPlan& plan,
                 long count,
                 std::vector<double>& z) {
  const BatchReport report = dynamics.flow_batch(plan, static_cast<int>(count), z, 1);
  return report.failed > 0 ? -1 : static_cast<double>(report.evaluations);
}

void keep(const std::vector<double>& z, std::size_t size, BenchmarkEnd& end) {
  std::copy_n(z.begin(), size, end.z.begin());
}

BenchmarkWatch watch_plan(const Dynamics& dynamics, const StepPlan& plan, std::vector<double> z) {
  const FlowSummary summary = dynamics.monitored_flow(plan, z, {});
  return {summary.energy_drift, std::string(summary.report.reason())};
}

// stop: of the stage iteration, see StepPlan.
Contestant by_steps(const Dynamics& dynamics,
                    const BenchmarkProblem& problem,
                    long count,
                    double stop = 0) {
  StepPlan plan = StepPlan::equal(0, problem.trajectory.duration, count);
  plan.stop = stop;
  Contestant contestant;
  contestant.method = dynamics.method;
  contestant.step_or_tolerance = plan.step;
  contestant.run = [dynamics, plan, start = problem.start, z = problem.start]() mutable {
    z = start;
    const FlowReport report = dynamics.flow(plan, z);
    BenchmarkEnd end;
    end.completed = report.completed();
    end.evaluations = static_cast<double>(report.evaluations);
    keep(z, z.size(), end);
    return end;
  };
  contestant.watch = [dynamics, plan, start = problem.start] {
    return watch_plan(dynamics, plan, start);
  };
  return contestant;
}

Contestant by_tolerance(const Dynamics& dynamics,
                        const BenchmarkProblem& problem,
                        double tolerance) {
  const double duration = problem.trajectory.duration;
  Contestant contestant;
  contestant.method = dynamics.method;
  contestant.automatic = true;
  contestant.step_or_tolerance = tolerance;
  contestant.run = [=, start = problem.start, z = problem.start]() mutable {
    z = start;
    const ChosenFlow flow = flow_by_tolerance(dynamics, duration, tolerance, z);
    BenchmarkEnd end;
    end.completed = flow.completed;
    end.evaluations = static_cast<double>(flow.evaluations);
    keep(z, z.size(), end);
    return end;
  };
  contestant.watch = [=, start = problem.start]() -> BenchmarkWatch {
    std::vector<double> z = start;
    const ChosenFlow flow = flow_by_tolerance(dynamics, duration, tolerance, z);
    if (!flow.completed) return {0, flow.message};
    return watch_plan(dynamics, flow.plan, start);
  };
  return contestant;
}

// The first trajectory is the one of the problem, the others differ by up to a percent in p.
std::vector<double> batch_starts(const BenchmarkProblem& problem) {
  constexpr double kSpread = 1e-2;
  std::vector<double> starts;
  for (long i = 0; i < kBatch; ++i) {
    const double factor = 1 + kSpread * static_cast<double>(i) / kBatch;
    for (std::size_t k = 0; k < problem.start.size(); ++k) {
      const bool momentum = k >= problem.start.size() / 2;
      starts.push_back(problem.start[k] * (momentum ? factor : 1));
    }
  }
  return starts;
}

Contestant in_a_batch(const Dynamics& dynamics, const BenchmarkProblem& problem, long count) {
  Contestant contestant = by_steps(dynamics, problem, count);
  contestant.mode = "batch";
  contestant.trajectories = kBatch;
  const std::vector<double> starts = batch_starts(problem);
  const StepPlan plan = StepPlan::equal(0, problem.trajectory.duration, count);
  contestant.run = [=, size = problem.start.size(), z = starts]() mutable {
    z = starts;
    const double evaluations = flow_many(dynamics, plan, kBatch, z);
    BenchmarkEnd end;
    end.completed = evaluations >= 0;
    end.evaluations = evaluations / kBatch;
    keep(z, size, end);
    return end;
  };
  return contestant;
}

// The same from a tolerance alone: adaptive, so of the library's batches only.
Contestant batch_by_tolerance(const Dynamics& dynamics,
                              const BenchmarkProblem& problem,
                              double tolerance) {
  Contestant contestant;
  contestant.method = kAdaptiveBatch;
  contestant.mode = "batch";
  contestant.automatic = true;
  contestant.step_or_tolerance = tolerance;
  contestant.trajectories = kBatch;
  const double duration = problem.trajectory.duration;
  const std::size_t size = problem.start.size();
  const std::vector<double> starts = batch_starts(problem);
  auto run = [=, z = starts]() mutable {
    z = starts;
    const BatchReport report = dynamics.adaptive_batch(0, duration, tolerance, kBatch, z, 1);
    BenchmarkEnd end;
    end.completed = report.failed == 0;
    end.evaluations = static_cast<double>(report.evaluations) / kBatch;
    keep(z, size, end);
    return end;
  };
  contestant.run = run;
  contestant.watch = [run, energy = problem.energy, z = problem.start]() mutable -> BenchmarkWatch {
    const BenchmarkEnd end = run();
    return {std::abs(energy(end.z.data()) - energy(z.data())), end.completed ? "" : "a run failed"};
  };
  return contestant;
}

// `rungs` numbers of steps from `first` on, each `factor` times the one before. `first` is of a
// duration of ten; Heisenberg's problem turns about as often per unit of time.
struct StepLadder {
  const char* method;
  double first;
  double factor;
  int rungs;
};

constexpr double kRootTwo = 1.4142135623730951;
constexpr StepLadder kLadders[] = {{"midpoint", 50, 2, 8},
                                   {"gauss4", 20, 2, 7},
                                   {"lobatto8", 12, kRootTwo, 9},
                                   {"gauss8", 12, kRootTwo, 9},
                                   {"gauss12", 8, 1.25, 10},
                                   {"gauss16", 8, 1.15, 12},
                                   {"dop853", 20, kRootTwo, 9}};
constexpr const char* kAutomaticCoarse[] = {"gauss8", "gauss12"};
constexpr const char* kDefault = "gauss16";
constexpr const char* kBatched[] = {"gauss16"};

std::vector<long> counts_of(const StepLadder& ladder, double duration, bool quick) {
  std::vector<long> counts;
  for (int i = 0; i < ladder.rungs; ++i) {
    if (quick && i != ladder.rungs / 3 && i != ladder.rungs / 2) continue;
    counts.push_back(std::lround(ladder.first * duration / 10 * std::pow(ladder.factor, i)));
  }
  return counts;
}

}  // namespace

std::vector<double> BenchmarkLadder::tolerances(int per_decade, int digits) const {
  constexpr int kLargest = -2;
  if (quick) return {1e-5, 1e-9};
  std::vector<double> values;
  for (int i = per_decade * kLargest; i >= -per_decade * digits; --i) {
    values.push_back(std::pow(10.0, static_cast<double>(i) / per_decade));
  }
  return values;
}

BenchmarkProblem benchmark_problem(const BenchmarkTrajectory& trajectory) {
  const Dynamics dynamics = find_scene(trajectory.scene).make({}, kDefault);
  BenchmarkProblem problem{trajectory, benchmark_start<double>(trajectory), {}};
  problem.energy = [dynamics](const double* z) {
    std::array<double, BenchmarkEnd::kMostSize> q_dot{};
    std::array<double, BenchmarkEnd::kMostSize> lambda{};
    const auto n = static_cast<std::size_t>(dynamics.dof);
    return dynamics
        .evaluate(0,
                  {z, n},
                  {z + n, n},
                  std::span(q_dot).first(n),
                  std::span(lambda).first(dynamics.multipliers))
        .hamiltonian;
  };
  return problem;
}

std::vector<Contestant> energy_contestants(const BenchmarkProblem& problem,
                                           const BenchmarkLadder& ladder) {
  constexpr double kShortest = 0.1;
  constexpr double kLongest = 0.45;
  const double factor = ladder.quick ? 4 : std::sqrt(kRootTwo);
  std::vector<Contestant> all;
  for (const char* method : {kDefault, "gauss12"}) {
    const Dynamics dynamics = find_scene(problem.trajectory.scene).make({}, method);
    for (const double stop : {0.0, kLongStop}) {
      for (double h = kShortest; h < kLongest; h *= factor) {
        const long count = std::lround(problem.trajectory.duration / h);
        all.push_back(by_steps(dynamics, problem, count, stop));
        if (stop > 0) all.back().method += fmt::format(", stages to {:.0e}", stop);
      }
    }
  }
  return all;
}

std::vector<Contestant> own_contestants(const BenchmarkProblem& problem,
                                        const BenchmarkLadder& ladder) {
  constexpr int kDense = 3;
  constexpr int kDigits = 13;
  const SceneEntry& entry = find_scene(problem.trajectory.scene);
  const auto dynamics = [&](const char* method) { return entry.make({}, method); };
  std::vector<Contestant> all;
  for (const StepLadder& steps : kLadders) {
    for (const long count : counts_of(steps, problem.trajectory.duration, ladder.quick)) {
      all.push_back(by_steps(dynamics(steps.method), problem, count));
    }
  }
  for (const double tolerance : ladder.tolerances(kDense, kDigits)) {
    all.push_back(by_tolerance(dynamics(kDefault), problem, tolerance));
  }
  for (const char* method : kAutomaticCoarse) {
    for (const double tolerance : ladder.tolerances(1, kDigits)) {
      all.push_back(by_tolerance(dynamics(method), problem, tolerance));
    }
  }
  for (const char* method : kBatched) {
    for (const StepLadder& steps : kLadders) {
      if (std::string_view(steps.method) != method) continue;
      for (const long count : counts_of(steps, problem.trajectory.duration, ladder.quick)) {
        all.push_back(in_a_batch(dynamics(method), problem, count));
      }
    }
  }
  for (const double tolerance : ladder.tolerances(kDense, kDigits)) {
    all.push_back(batch_by_tolerance(dynamics(kDefault), problem, tolerance));
  }
  return all;
}

}  // namespace carnot::apps
