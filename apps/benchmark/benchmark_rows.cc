#include "benchmark/benchmark_rows.h"

#include <algorithm>
#include <cmath>

#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

// What is timed for each row.
struct TimedCalls {
  std::vector<std::function<void()>> calls;
  std::vector<long> trajectories;  // of each call
};

// Runs each once: what it delivers, and who is worth timing.
bool try_all(const std::vector<Contestant>& contestants,
             const Progress& progress,
             BenchmarkScene& scene,
             TimedCalls& timed) {
  const std::string name(scene.problem.trajectory.scene);
  double done = 0;
  for (const Contestant& c : contestants) {
    if (progress && !progress(done++ / static_cast<double>(contestants.size()))) return false;
    const BenchmarkEnd end = c.run();
    const double error = scene.reference.error(end.z.data());
    const BenchmarkWatch watch = c.watch();
    if (!end.completed || !std::isfinite(error) || !std::isfinite(watch.energy_drift)) {
      const std::string why = watch.message.empty() ? "it left the finite numbers" : watch.message;
      scene.failures.push_back({name, c.method, c.mode, c.step_or_tolerance, why});
      continue;
    }
    scene.rows.push_back({name,
                          c.method,
                          c.mode,
                          c.peer,
                          c.automatic,
                          c.step_or_tolerance,
                          error,
                          0,
                          end.evaluations,
                          watch.energy_drift});
    timed.calls.emplace_back([run = c.run] { (void)run(); });
    timed.trajectories.push_back(c.trajectories);
  }
  return true;
}

// The rows of a curve that no other one beats in both time and error: errors fall.
std::vector<BenchmarkRow> best_rows(const BenchmarkCurve& curve) {
  std::vector<BenchmarkRow> rows = curve.rows;
  std::stable_sort(
      rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
  std::vector<BenchmarkRow> best;
  for (const BenchmarkRow& row : rows) {
    if (best.empty() || row.error < best.back().error) best.push_back(row);
  }
  return best;
}

}  // namespace

bool run_contest(const std::vector<Contestant>& contestants,
                 const TimingOptions& timing,
                 const Progress& progress,
                 BenchmarkScene& scene) {
  constexpr double kTrial = 0.1;  // of the work
  TimedCalls timed;
  if (!try_all(contestants, part_of(progress, 0, kTrial), scene, timed)) return false;
  const std::vector<double> seconds =
      median_seconds(timed.calls, timing, part_of(progress, kTrial, 1 - kTrial));
  if (seconds.size() != timed.calls.size()) return false;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    scene.rows[i].seconds = seconds[i] / static_cast<double>(timed.trajectories[i]);
  }
  return true;
}

std::string BenchmarkCurve::title() const {
  if (mode == "batch") return method + ", batch";
  return automatic ? method : method + ", steps given";
}

std::vector<BenchmarkCurve> benchmark_curves(const std::vector<BenchmarkRow>& rows) {
  std::vector<BenchmarkCurve> curves;
  for (const BenchmarkRow& row : rows) {
    const auto same = [&row](const BenchmarkCurve& curve) {
      return curve.method == row.method && curve.mode == row.mode &&
             curve.automatic == row.automatic && curve.peer == row.peer;
    };
    auto curve = std::find_if(curves.begin(), curves.end(), same);
    if (curve == curves.end()) {
      curve = curves.insert(curves.end(), {row.method, row.mode, row.peer, row.automatic, {}});
    }
    curve->rows.push_back(row);
  }
  return curves;
}

std::optional<double> seconds_at(const BenchmarkCurve& curve, double error) {
  const std::vector<BenchmarkRow> best = best_rows(curve);
  for (std::size_t i = 0; i + 1 < best.size(); ++i) {
    const BenchmarkRow& coarse = best[i];
    const BenchmarkRow& fine = best[i + 1];
    if (!(coarse.error >= error && fine.error <= error) || !(fine.error > 0)) continue;
    const double along = std::log(coarse.error / error) / std::log(coarse.error / fine.error);
    return coarse.seconds * std::pow(fine.seconds / coarse.seconds, along);
  }
  return std::nullopt;
}

std::optional<double> speed_ratio(const std::vector<BenchmarkCurve>& curves,
                                  const BenchmarkCurve& curve,
                                  double error) {
  const auto contrast = std::find_if(
      curves.begin(), curves.end(), [](const auto& c) { return c.method == kContrast; });
  if (contrast == curves.end()) return std::nullopt;
  const auto theirs = seconds_at(*contrast, error);
  const auto ours = seconds_at(curve, error);
  if (!theirs || !ours) return std::nullopt;
  return *theirs / *ours;
}

}  // namespace carnot::apps
