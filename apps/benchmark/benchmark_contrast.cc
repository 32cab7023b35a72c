// DOP853 as general solvers run it, but inlined with a right-hand side by hand.
#include <algorithm>
#include <cmath>

#include "benchmark/benchmark_contest.h"
#include "benchmark/benchmark_dop853.h"
#include "benchmark/benchmark_rates.h"

namespace carnot::apps {
namespace {

template <class Rate>
Contestant contestant(const BenchmarkProblem& problem, double tolerance) {
  const double duration = problem.trajectory.duration;
  Contestant made;
  made.method = kContrast;
  made.peer = true;
  made.automatic = true;
  made.step_or_tolerance = tolerance;
  made.run = [duration, tolerance, start = problem.start] {
    BenchmarkEnd end;
    std::copy(start.begin(), start.end(), end.z.begin());
    const Dop853Report report = AdaptiveDop853<Rate>(Rate{}, tolerance).run(duration, end.z.data());
    end.completed = report.completed;
    end.evaluations = static_cast<double>(report.evaluations);
    return end;
  };
  made.watch = [duration, tolerance, problem] {
    BenchmarkWatch watch;
    std::vector<double> z = problem.start;
    const double energy = problem.energy(z.data());
    const Dop853Report report =
        AdaptiveDop853<Rate>(Rate{}, tolerance).run(duration, z.data(), [&](const double* node) {
          watch.energy_drift =
              std::max(watch.energy_drift, std::abs(problem.energy(node) - energy));
        });
    if (!report.completed) watch.message = "the step became too short";
    return watch;
  };
  return made;
}

}  // namespace

std::vector<Contestant> contrast_contestants(const BenchmarkProblem& problem,
                                             const BenchmarkLadder& ladder) {
  constexpr int kDense = 3;
  std::vector<Contestant> all;
  for (const double tolerance : ladder.local_tolerances(kDense)) {
    all.push_back(with_rate(problem.trajectory.scene, [&](auto rate) {
      return contestant<decltype(rate)>(problem, tolerance);
    }));
  }
  return all;
}

}  // namespace carnot::apps
