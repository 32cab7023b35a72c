#include "benchmark/benchmark_energy.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <span>

#include "carnot/numerics/parallel.h"
#include "catalogue/scene_choice.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr const char* kMethod = "gauss16";
constexpr const char* kScenes[] = {"heisenberg", "vehicle"};

// One run, watched at 10^2, 10^3, ... steps.
struct LongRun {
  const char* scene;
  bool compensated;
  int start;
  std::vector<double> drifts;
};

// Starts whose multipliers stay bounded.
std::vector<double> start_of(const std::string& scene, int index) {
  std::mt19937_64 generator(index);
  std::uniform_real_distribution<double> some(-0.1, 0.1);
  const double first = some(generator);
  const double second = some(generator);
  if (scene == "vehicle") return {0, 0, 1.2 + first, 1.2, 1, 0, 0.1 + second, 0.1};
  return {0, 0, 0, 0.1, 0.3 + first / 10, 1 + second};
}

double energy_of(const Dynamics& dynamics, const std::vector<double>& z) {
  std::vector<double> q_dot(dynamics.dof);
  std::vector<double> lambda(dynamics.multipliers);
  const std::span at(z);
  return dynamics.evaluate(0, at.first(dynamics.dof), at.subspan(dynamics.dof), q_dot, lambda)
      .hamiltonian;
}

// Angles are rounded to eps of their size: they are kept within a turn.
void fold(const Dynamics& dynamics, std::vector<double>& z) {
  for (int i = 0; i < dynamics.dof; ++i) {
    const double period = dynamics.info.configuration[i].period;
    if (period > 0) z[i] = std::remainder(z[i], period);
  }
}

// Steps first, ..., last - 1. A flow keeps what its updates are rounded by to itself, so that one
// of a single step has nothing from the step before.
bool advance(
    const Dynamics& dynamics, bool compensated, long first, long last, std::vector<double>& z) {
  const long most = compensated ? last - first : 1;
  for (; first < last; first += most) {
    const double length = kEnergyStep * static_cast<double>(most);
    const auto plan = StepPlan::equal(kEnergyStep * static_cast<double>(first), length, most);
    if (!dynamics.flow(plan, z).completed()) return false;
    fold(dynamics, z);
  }
  return true;
}

// False when stopped.
bool run_long(LongRun& run, const std::vector<long>& counts, const Progress& progress) {
  constexpr long kLook = 100000;  // steps between two looks at Ctrl-C
  const Dynamics dynamics = find_scene(run.scene).make({}, kMethod);
  std::vector<double> z = start_of(run.scene, run.start);
  const double start = energy_of(dynamics, z);
  long done = 0;
  bool ok = true;
  for (const long count : counts) {
    while (ok && done < count) {
      const long next = std::min(count, done + kLook);
      ok = advance(dynamics, run.compensated, done, next, z);
      done = next;
      if (progress && !progress(static_cast<double>(done) / static_cast<double>(counts.back()))) {
        return false;
      }
    }
    const double drift = std::abs(energy_of(dynamics, z) - start) / std::abs(start);
    run.drifts.push_back(ok ? drift : std::numeric_limits<double>::quiet_NaN());
  }
  return true;
}

}  // namespace

std::vector<EnergyGrowth> energy_growth(const EnergyOptions& options, const Progress& progress) {
  std::vector<long> counts;
  for (long count = 100; count < options.steps; count *= 10) counts.push_back(count);
  counts.push_back(options.steps);
  std::vector<LongRun> runs;
  for (const char* scene : kScenes) {
    for (const bool compensated : {false, true}) {  // those that take longer first
      for (int i = 0; i < kEnergyStarts; ++i) runs.push_back({scene, compensated, i, {}});
    }
  }
  std::atomic<bool> stopped{false};
  std::vector<std::atomic<double>> done(runs.size());
  parallel_for(static_cast<int>(runs.size()), thread_count(options.threads), [&](int i) {
    const Progress part = [&](double fraction) {
      done[i] = fraction;
      double sum = 0;
      for (const auto& one : done) sum += one;
      return !progress || progress(sum / static_cast<double>(done.size()));
    };
    if (!stopped && !run_long(runs[i], counts, part)) stopped = true;
  });
  if (stopped) return {};
  std::vector<EnergyGrowth> growth;
  for (std::size_t first = 0; first < runs.size(); first += kEnergyStarts) {
    for (std::size_t k = 0; k < counts.size(); ++k) {
      double squares = 0;
      for (std::size_t i = first; i < first + kEnergyStarts; ++i) {
        squares += runs[i].drifts[k] * runs[i].drifts[k] / kEnergyStarts;
      }
      growth.push_back({runs[first].scene, runs[first].compensated, counts[k], std::sqrt(squares)});
    }
  }
  return growth;
}

BenchmarkProblem energy_problem() {
  constexpr double kTime = 1000;
  for (BenchmarkTrajectory trajectory : benchmark_trajectories()) {
    if (trajectory.scene != "vehicle") continue;
    trajectory.duration = kTime;
    return benchmark_problem(trajectory);
  }
  return {};
}

std::optional<EnergyResult> run_energy(const EnergyOptions& options,
                                       const std::vector<Contestant>& peers,
                                       const Progress& progress) {
  constexpr double kDrift = 0.3;  // of the work
  EnergyResult result;
  result.drift.problem = energy_problem();
  const BenchmarkLadder ladder{options.quick};
  std::vector<Contestant> all = energy_contestants(result.drift.problem, ladder);
  for (Contestant& contrast : contrast_contestants(result.drift.problem, ladder)) {
    all.push_back(std::move(contrast));
  }
  all.insert(all.end(), peers.begin(), peers.end());
  const TimingOptions timing = options.quick ? TimingOptions{2e-4, 1} : TimingOptions{2e-3, 5};
  if (!run_contest(all, timing, part_of(progress, 0, kDrift), result.drift)) return std::nullopt;
  result.growth = energy_growth(options, part_of(progress, kDrift, 1 - kDrift));
  if (result.growth.empty()) return std::nullopt;
  return result;
}

}  // namespace carnot::apps
