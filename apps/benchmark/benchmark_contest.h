// Who takes part in `carnot benchmark`: a method with a step or a tolerance, ready to be run.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "benchmark/benchmark_trajectory.h"
#include "carnot/dynamics.h"

namespace carnot::apps {

// What one run came to. `z` is (q, p) at the end of the trajectory, of the first of a batch.
struct BenchmarkEnd {
  static constexpr int kMostSize = 8;
  std::array<double, kMostSize> z{};
  double evaluations = 0;  // of the right-hand side, per trajectory
  bool completed = false;
};

// What the timed run does, once more and watched.
struct BenchmarkWatch {
  double energy_drift = 0;
  std::string message;  // why it did not complete
};

struct Contestant {
  std::string method;
  std::string mode = "single";  // or "batch"
  bool peer = false;
  bool automatic = false;
  double step_or_tolerance = 0;
  long trajectories = 1;  // of one run
  std::function<BenchmarkEnd()> run;
  std::function<BenchmarkWatch()> watch;
};

// The problem that all of them solve.
struct BenchmarkProblem {
  BenchmarkTrajectory trajectory;
  std::vector<double> start;
  // H(q, p), from the scene.
  std::function<double(const double* z)> energy;
};

struct BenchmarkLadder {
  bool quick = false;
  // `per_decade` tolerances from 1e-2 to 10^-digits; two in all when quick.
  [[nodiscard]] std::vector<double> tolerances(int per_decade, int digits) const;
  // Of a step, as codes with step control take them: their errors at the end are larger.
  [[nodiscard]] std::vector<double> local_tolerances(int per_decade) const {
    return tolerances(per_decade, 15);
  }
};

BenchmarkProblem benchmark_problem(const BenchmarkTrajectory& trajectory);

// The methods of this program, by steps, by tolerances and in batches.
std::vector<Contestant> own_contestants(const BenchmarkProblem& problem,
                                        const BenchmarkLadder& ladder);

// Gauss methods by steps, for long runs: to round-off, and ended where stages change by less than
// kLongStop.
std::vector<Contestant> energy_contestants(const BenchmarkProblem& problem,
                                           const BenchmarkLadder& ladder);
inline constexpr double kLongStop = 1e-13;

// DOP853 with a choice of steps and a right-hand side by hand.
std::vector<Contestant> contrast_contestants(const BenchmarkProblem& problem,
                                             const BenchmarkLadder& ladder);

inline constexpr const char* kContrast = "dop853-adaptive";

}  // namespace carnot::apps
