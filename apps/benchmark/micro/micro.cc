// carnot_micro: nanoseconds of the pieces that `carnot benchmark` measures as a whole.
//
// rate/...       the right-hand side by hand: latency, where each call waits for the one before, as
//                in an explicit method; throughput, where it does not, as over many trajectories
// scene/...      the same by the formulas of the scene
// pack/...       eight of them side by side, latency: by hand; by the scene with all that it
// offers;
//                with its frame, derivatives by the library; with M, G and V alone
// iteration/...  one fixed-point iteration on eight stages
// step/...       one step of a method
// peer/...       one accepted step of DOP853 with step control
// warm/...       geodesics from one nearby (warm_start_micro.h)
#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "benchmark/benchmark_dop853.h"
#include "benchmark/benchmark_rates.h"
#include "benchmark/benchmark_trajectory.h"
#include "benchmark/micro/warm_start_micro.h"
#include "carnot/scenes/heisenberg.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"
#include "carnot/step/gauss.h"
#include "carnot/step/packed_stages.h"
#include "carnot/system/packed_rate.h"
#include "carnot/system/phase_space.h"
#include "carnot/system/system_of.h"
#include "catalogue/scene_choice.h"

namespace carnot::apps {
namespace {

// Adding this much of the result changes nothing, but the compiler does not know.
constexpr double kNothing = 1e-300;

template <class Rate>
void rate_latency(benchmark::State& state, const BenchmarkTrajectory& trajectory) {
  std::vector<double> z = benchmark_start<double>(trajectory);
  std::array<double, Rate::kSize> f{};
  for (auto _ : state) {
    Rate{}(z.data(), f.data());
    for (std::size_t i = 0; i < f.size(); ++i) z[i] += kNothing * f[i];
  }
  benchmark::DoNotOptimize(z.data());
}

template <class Rate>
void rate_throughput(benchmark::State& state, const BenchmarkTrajectory& trajectory) {
  const std::vector<double> z = benchmark_start<double>(trajectory);
  std::array<double, Rate::kSize> f{};
  for (auto _ : state) {
    benchmark::DoNotOptimize(z.data());
    benchmark::ClobberMemory();
    Rate{}(z.data(), f.data());
    benchmark::DoNotOptimize(f.data());
  }
}

template <class Scene>
void scene_latency(benchmark::State& state, const BenchmarkTrajectory& trajectory) {
  constexpr int kSize = 2 * Scene::kDof;
  const auto system = make_system(Scene{});
  const std::vector<double> start = benchmark_start<double>(trajectory);
  Vector<double, kSize> z = Eigen::Map<const Vector<double, kSize>>(start.data());
  Vector<double, decltype(system)::kAlgebraic> y = decltype(y)::Zero();
  Vector<double, kSize> f;
  for (auto _ : state) {
    if (phase_rate(system, 0.0, z, y, f) != RateStatus::kOk) state.SkipWithError("no rate");
    z += kNothing * f;
  }
  benchmark::DoNotOptimize(z.data());
}

// The scene without what its author may write beside M, G and V.
template <class Scene>
struct Plain {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = Scene::kMultipliers;
  Scene scene;
  template <class T>
  [[nodiscard]] auto mass(const Vector<T, kDof>& q) const {
    return scene.mass(q);
  }
  template <class T>
  [[nodiscard]] auto constraints(const Vector<T, kDof>& q) const {
    return scene.constraints(q);
  }
  template <class T>
  requires HasPotential<Scene>
  [[nodiscard]] T potential(const Vector<T, kDof>& q) const { return scene.potential(q); }
};

// With the frame besides.
template <class Scene>
struct Framed : Plain<Scene> {
  template <class T>
  [[nodiscard]] auto frame(const Vector<T, Scene::kDof>& q) const {
    return this->scene.frame(q);
  }
};

// A row of eight for each component, all lanes alike.
template <int size>
struct Rows {
  static constexpr int kLanes = 8;
  explicit Rows(const BenchmarkTrajectory& trajectory) {
    const std::vector<double> start = benchmark_start<double>(trajectory);
    for (int i = 0; i < size * kLanes; ++i) z[i] = start[i / kLanes];
  }
  void disturb() {
    for (int i = 0; i < size; ++i) z[i * kLanes] += kNothing * f[i * kLanes];
  }
  alignas(64) std::array<double, size * kLanes> z;
  alignas(64) std::array<double, size * kLanes> f{};
};

template <class Rate>
[[gnu::flatten, gnu::noinline]] void hand_pack(const double* z, double* f) {
  using P = Pack<8>;
  std::array<P, Rate::kSize> at;
  std::array<P, Rate::kSize> rate;
  for (int i = 0; i < Rate::kSize; ++i) at[i] = P::load(z + 8 * i);
  Rate{}(at.data(), rate.data());
  for (int i = 0; i < Rate::kSize; ++i) rate[i].store(f + 8 * i);
}

template <class Rate>
void hand_pack_latency(benchmark::State& state, const BenchmarkTrajectory& trajectory) {
  Rows<Rate::kSize> rows(trajectory);
  for (auto _ : state) {
    hand_pack<Rate>(rows.z.data(), rows.f.data());
    rows.disturb();
  }
  benchmark::DoNotOptimize(rows.z.data());
}

// The stages of a step that has settled: each iteration finds again what it was given.
template <class Scene>
void iteration_latency(benchmark::State& state, const BenchmarkTrajectory& trajectory) {
  constexpr double kStep = 0.3;
  constexpr double kAnyChange = std::numeric_limits<double>::max();
  constexpr int kSize = 2 * Scene::kDof;
  const auto system = make_system(Scene{});
  using System = std::decay_t<decltype(system)>;
  const Tableau<double, 8> tableau = fixed_gauss_tableau<double, 8>();
  const std::vector<double> start = benchmark_start<double>(trajectory);
  const std::array<double, kSize> compensation{};
  Rows<kSize> rows(trajectory);  // increments in f
  alignas(64) std::array<double, 8> time{};
  alignas(64) std::array<double, 8> weights;
  alignas(64) std::array<double, System::kAlgebraic * 8> y;
  for (int i = 0; i < 8; ++i) weights[i] = kStep * tableau.omega[i];
  for (auto _ : state) {
    const StageReport sweep = packed_iteration<8>(system,
                                                  {time.data(),
                                                   tableau.mu.data(),
                                                   weights.data(),
                                                   start.data(),
                                                   compensation.data(),
                                                   rows.z.data(),
                                                   y.data(),
                                                   rows.f.data()},
                                                  {kAnyChange, 1, false});
    if (sweep.end == IterationEnd::kRateFailed) state.SkipWithError("no rate");
  }
  benchmark::DoNotOptimize(rows.f.data());
}

template <class Scene>
void pack_latency(benchmark::State& state, const BenchmarkTrajectory& trajectory) {
  constexpr int kSize = 2 * Scene::kDof;
  const auto system = make_system(Scene{});
  Rows<kSize> rows(trajectory);
  alignas(64) std::array<double, 8> t{};
  alignas(64) std::array<double, decltype(system)::kAlgebraic * 8> y;
  for (auto _ : state) {
    if (!packed_rate<8>(system, t.data(), rows.z.data(), y.data(), rows.f.data())) {
      state.SkipWithError("no rate");
    }
    rows.disturb();
  }
  benchmark::DoNotOptimize(rows.z.data());
}

void method_step(benchmark::State& state,
                 const BenchmarkTrajectory& trajectory,
                 const std::string& method) {
  constexpr double kStep = 0.1;
  const Dynamics dynamics = find_scene(trajectory.scene).make({}, method);
  const std::vector<double> start = benchmark_start<double>(trajectory);
  const StepPlan plan = StepPlan::of_length(0, trajectory.duration, kStep);
  std::vector<double> z;
  for (auto _ : state) {
    z = start;
    if (!dynamics.flow(plan, z).completed()) state.SkipWithError("a step failed");
  }
  const double steps = static_cast<double>(state.iterations()) * static_cast<double>(plan.count);
  state.counters["per_step"] =
      benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class Rate>
void dop853_step(benchmark::State& state, const BenchmarkTrajectory& trajectory) {
  constexpr double kTolerance = 1e-10;
  const std::vector<double> start = benchmark_start<double>(trajectory);
  std::vector<double> z;
  long steps = 0;
  for (auto _ : state) {
    z = start;
    steps += AdaptiveDop853<Rate>({}, kTolerance).run(trajectory.duration, z.data()).steps;
  }
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(steps), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class Scene, class Rate>
void add_scene(const BenchmarkTrajectory& trajectory) {
  const std::string scene(trajectory.scene);
  const auto add = [&](const std::string& name, auto run) {
    benchmark::RegisterBenchmark((name + "/" + scene).c_str(), run);
  };
  add("rate/latency", [=](auto& state) { rate_latency<Rate>(state, trajectory); });
  add("rate/throughput", [=](auto& state) { rate_throughput<Rate>(state, trajectory); });
  add("scene/latency", [=](auto& state) { scene_latency<Scene>(state, trajectory); });
  add("pack/hand", [=](auto& state) { hand_pack_latency<Rate>(state, trajectory); });
  add("pack/scene", [=](auto& state) { pack_latency<Scene>(state, trajectory); });
  add("pack/frame", [=](auto& state) { pack_latency<Framed<Scene>>(state, trajectory); });
  add("pack/plain", [=](auto& state) { pack_latency<Plain<Scene>>(state, trajectory); });
  add("iteration/gauss16", [=](auto& state) { iteration_latency<Scene>(state, trajectory); });
  for (const std::string method : {"midpoint", "gauss8", "gauss16", "dop853"}) {
    add("step/" + method, [=](auto& state) { method_step(state, trajectory, method); });
  }
  add("peer/dop853-adaptive", [=](auto& state) { dop853_step<Rate>(state, trajectory); });
}

}  // namespace
}  // namespace carnot::apps

int main(int argc, char** argv) {
  const auto& trajectories = carnot::apps::benchmark_trajectories();
  carnot::apps::add_scene<carnot::scenes::VehicleCosine, carnot::apps::VehicleCosineRate>(
      trajectories[0]);
  carnot::apps::add_scene<carnot::scenes::Vehicle, carnot::apps::VehicleRate>(trajectories[1]);
  carnot::apps::add_scene<carnot::scenes::Heisenberg, carnot::apps::HeisenbergRate>(
      trajectories[2]);
  carnot::apps::add_warm_starts();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
