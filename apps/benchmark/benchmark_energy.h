// carnot benchmark --energy: what becomes of H in long runs, and what that costs.
//
// Two questions. What does a drift cost: largest |H - H0| over T = 1000 of the vehicle, against the
// CPU time of the run. How does round-off grow: |H - H0| over 10^2, 10^3, ... steps, which is a
// random walk, of the root of the steps, where nothing in a step is rounded the same way every time
// (Brouwer's law); with what the last rounding left carried along, and without.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmark/benchmark_contest.h"
#include "benchmark/benchmark_rows.h"

namespace carnot::apps {

struct EnergyOptions {
  long steps = 1000000;  // the longest run
  int threads = 0;       // of the long runs; 0: all cores
  bool quick = false;
};

// Root mean square of |H - H0| / |H0| at the end of runs from several starts.
struct EnergyGrowth {
  std::string scene;
  bool compensated = true;
  long steps = 0;
  double drift = 0;
};

struct EnergyResult {
  BenchmarkScene drift;  // rows without an error: nothing is known of the end
  std::vector<EnergyGrowth> growth;
};

inline constexpr double kEnergyStep = 0.2;  // of all long runs
inline constexpr int kEnergyStarts = 6;

// The vehicle of the other benchmarks, to T = 1000.
BenchmarkProblem energy_problem();

// How round-off grows up to options.steps. Empty when stopped.
std::vector<EnergyGrowth> energy_growth(const EnergyOptions& options, const Progress& progress);

// `peers` take part as they are. Nothing when stopped.
std::optional<EnergyResult> run_energy(const EnergyOptions& options,
                                       const std::vector<Contestant>& peers,
                                       const Progress& progress);

}  // namespace carnot::apps
