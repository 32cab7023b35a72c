#include "benchmark/micro/warm_start_micro.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/warm_start.h"
#include "catalogue/scene_choice.h"

namespace carnot::apps {
namespace {

constexpr double kTolerance = 1e-10;

// A geodesic from the origin, and what flows along it need.
struct Known {
  BoundaryValueProblem problem;
  std::vector<double> z;  // (q, p) at the start
  StepPlan plan;
  std::unique_ptr<WarmStart> warm;
};

std::shared_ptr<Known> solve(const std::string& scene, const std::vector<double>& to) {
  const std::vector<double> from(to.size(), 0.0);
  Known known{{find_scene(scene).make({}, "gauss16"), from, to}, from, {}, nullptr};
  GeodesicOptions options;
  options.samples = 0;
  const std::vector<double> p0 = find_geodesics(known.problem, options).geodesics.at(0).p0;
  known.z.insert(known.z.end(), p0.begin(), p0.end());
  std::vector<double> z = known.z;
  known.plan = known.problem.dynamics.automatic_flow(0, known.problem.time, kTolerance, z).plan;
  known.warm = std::make_unique<WarmStart>(known.problem, p0, kTolerance);
  return std::make_shared<Known>(std::move(known));
}

void flow(benchmark::State& state, const Known& known, bool with_tangent) {
  std::vector<double> m(known.z.size() * known.z.size());
  std::vector<double> z;
  for (auto _ : state) {
    z = known.z;
    const Dynamics& dynamics = known.problem.dynamics;
    const FlowReport report =
        with_tangent ? dynamics.tangent_flow(known.plan, z, m) : dynamics.flow(known.plan, z);
    if (!report.completed()) state.SkipWithError("a step failed");
  }
}

void warm_start(benchmark::State& state, const Known& known, double away) {
  constexpr int kTargets = 100;
  std::mt19937_64 random(0);
  std::uniform_real_distribution<double> aside(-away, away);
  std::vector<std::vector<double>> targets(kTargets, known.problem.to);
  for (std::vector<double>& to : targets) {
    for (double& x : to) x += aside(random);
  }
  std::vector<double> p0(known.problem.to.size());
  double flows = 0;
  double failed = 0;
  int i = 0;
  for (auto _ : state) {
    const WarmStartReport report = known.warm->solve(targets[i++ % kTargets].data(), p0.data());
    flows += report.flows;
    failed += report.converged ? 0 : 1;
  }
  state.counters["flows"] = benchmark::Counter(flows, benchmark::Counter::kAvgIterations);
  state.counters["failed"] = benchmark::Counter(failed, benchmark::Counter::kAvgIterations);
}

void add(const std::string& scene, const std::string& what, const std::vector<double>& to) {
  const std::shared_ptr<Known> known = solve(scene, to);
  const auto name = [&](const std::string& kind) {
    return fmt::format("warm/{}/{}-{}", kind, scene, what);
  };
  benchmark::RegisterBenchmark(name("flow").c_str(),
                               [=](auto& state) { flow(state, *known, false); });
  benchmark::RegisterBenchmark(name("tangent").c_str(),
                               [=](auto& state) { flow(state, *known, true); });
  for (const double away : {1e-3, 1e-2}) {
    benchmark::RegisterBenchmark(name(fmt::format("solve-{:g}", away)).c_str(),
                                 [=](auto& state) { warm_start(state, *known, away); });
  }
}

}  // namespace

void add_warm_starts() {
  add("vehicle", "ahead", {2, 1, 0.5, 0.5});
  add("vehicle", "sideways", {0, 1, 0, 0});
  add("unicycle", "ahead", {1, 1, 1});
  add("unicycle", "sideways", {0, 1, 0});
}

}  // namespace carnot::apps
