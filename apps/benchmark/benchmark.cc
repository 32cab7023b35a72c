// carnot benchmark: speed against error on three trajectories whose ends are known to many digits;
// with --boundary-value, solvers of boundary-value problems from blind starts; with --limits,
// geodesics that keep to limits; with --drift, those of scenes with drift; with --energy, H in long
// runs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "benchmark/benchmark_boundary_report.h"
#include "benchmark/benchmark_cache.h"
#include "benchmark/benchmark_direct_report.h"
#include "benchmark/benchmark_energy_report.h"
#include "benchmark/benchmark_report.h"
#include "benchmark/benchmark_rows.h"
#include "carnot/language/nearest.h"
#include "carnot/plots/plot_file.h"
#include "run/deferred.h"
#include "run/delivery.h"
#include "run/subcommands.h"
#include "text/numbers.h"
#include "text/output_file.h"
#include "text/progress_bar.h"
#ifdef CARNOT_PEERS
#include "benchmark/peers/boundary_peers.h"
#include "benchmark/peers/peers.h"
#endif

namespace carnot::apps {
namespace {

#ifdef CARNOT_PEERS
constexpr bool kWithPeers = true;
#else
constexpr bool kWithPeers = false;
std::vector<Contestant> peer_contestants(const BenchmarkProblem&, const BenchmarkLadder&) {
  return {};
}
std::vector<BoundarySolver> boundary_peers() { return {}; }
DirectSolver direct_peer() { return {}; }
#endif

constexpr const char* kFooter = R"(
The trajectories are vehicle-cosine and vehicle from q = (1, 0.5, 0.3, 0.8) with front wheel speed
1, phi' = 0.2 and lambda = 0 to T = 10, and heisenberg from q = 0, p = (0.1, 0.3, 1) to T = 100.
Their ends are computed in quadruple precision, twice, and kept in $XDG_CACHE_HOME/carnot.

  step         a ladder of given steps
  tolerance    "automatic": only a tolerance was given; the choice of the step is in the time
  batch        many trajectories at once; times are those of one
  dop853-adaptive  the explicit method of order 8 with step control, right-hand side written by
               hand and inlined: what the ratios are told against
  --peers      with the same right-hand side: gsl-rk8pd, gsl-rkf45, gsl-msadams, odeint-rkf78,
               odeint-dopri5, odeint-bulirsch-stoer, cvode-adams, cvode-bdf; and ida on the
               differential-algebraic equations in (q, p, v, lambda)

With --boundary-value: sideways parking of the vehicle and of the unicycle by 1, and
heisenberg-group to (1, 0, 1), from --starts blind starts of every solver: random paths, relaxed
before ceres, newton or nlopt:NAME shoot, and random momenta. What counts is verified by an
independent integration. With --peers also ipopt on the direct midpoint transcription, 50 intervals,
and gsl-hybridsj on single shooting. Then, over 1, 2, 4, ... 64 starts, the share of --targets random
targets that are at the least action: --plot draws that. Takes some minutes.

With --limits: a wheel, a hinge and a heading that turn so far and no further, and discs in the way.
With --peers ipopt keeps to the same limits on the direct midpoint transcription: from carnot's path
on 1024, 2048 and 4096 intervals, whose actions are extrapolated, and from 16 blind starts on 64.

With --drift: a transfer between circles, an oscillator, a pendulum, a cart-pole, a quadrotor, a ship
in a vortex and a linear-quadratic problem, whose texts are in docs/examples/scenes. With --peers
ipopt solves for paths and controls on 512, 1024 and 2048 intervals, and from 16 blind starts on 64.

With --energy: the largest |H - H0| on the vehicle over T = 1000 against the CPU time of the run, by
Gauss methods with steps around 0.2, whose stages are iterated to round-off or to changes of 1e-13,
by dop853-adaptive and, with --peers, by gsl-rk8pd and odeint-rkf78; and how the round-off in H
grows over --steps steps of gauss16, with compensated summation and without.

Times are the median CPU time of one trajectory over blocks, in rounds through all the rows of a
scene, so that times within one run compare.

Examples
  carnot benchmark
  carnot benchmark vehicle --json
  carnot benchmark --plot speed.png --output speed.md
  carnot benchmark --boundary-value --starts 32 --output solvers.md
  carnot benchmark --limits
  carnot benchmark --drift
  carnot benchmark --energy --steps 10000000 --plot energy.png

Exit status: 0 success, 1 a file or reference did not come about, 2 bad input, 130 interrupted.)";

constexpr long kFewSteps = 1000;
constexpr long kMostSteps = 1000000000;

struct Options {
  std::vector<std::string> scenes;
  bool peers = false;
  bool quick = false;
  bool boundary_value = false;
  bool limits = false;
  bool drift = false;
  bool energy = false;
  std::string steps;
  std::string starts;
  std::string targets;
  std::string seed;
  std::string threads;
  Destination destination;
};

std::vector<BenchmarkTrajectory> check_scenes(const std::vector<std::string>& names) {
  if (names.empty()) return benchmark_trajectories();
  std::vector<std::string> known;
  for (const auto& trajectory : benchmark_trajectories()) known.emplace_back(trajectory.scene);
  std::vector<BenchmarkTrajectory> chosen;
  std::set<std::string> seen;
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      refuse("SCENE",
             name,
             "no trajectory to benchmark" + language::suggestion(name, known),
             fmt::format("{}", fmt::join(known, ", ")));
    }
    if (!seen.insert(name).second) refuse("SCENE", name, "given twice", "each scene once");
    chosen.push_back(benchmark_trajectories()[found - known.begin()]);
  }
  return chosen;
}

void check_destination(const Destination& destination) {
  if (!destination.output.empty()) {
    check_output_file("--output", destination.output, {".json", ".md"});
  }
  if (destination.plot.empty()) return;
  try {
    plots::validate_plot_file(destination.plot);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("--plot: ") + error.what());
  }
}

void check_peers(bool wanted) {
  if (!wanted || kWithPeers) return;
  throw std::invalid_argument(
      "--peers: this program was built without them; accepted: a build configured with "
      "-D CARNOT_PEERS=ON (packages: scripts/packages-peers.txt)");
}

std::vector<Contestant> contestants_of(const BenchmarkProblem& problem, const Options& options) {
  const BenchmarkLadder ladder{options.quick};
  std::vector<Contestant> all = own_contestants(problem, ladder);
  const auto add = [&all](std::vector<Contestant> more) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
  };
  add(contrast_contestants(problem, ladder));
  if (options.peers) add(peer_contestants(problem, ladder));
  return all;
}

// Throws std::runtime_error where a reference fails or the work was stopped.
std::vector<BenchmarkScene> run_scenes(const std::vector<BenchmarkTrajectory>& trajectories,
                                       const Options& options,
                                       const Progress& progress) {
  constexpr double kReference = 0.1;  // of the work
  const TimingOptions timing = options.quick ? TimingOptions{2e-4, 3} : TimingOptions{};
  std::vector<BenchmarkScene> scenes;
  for (const BenchmarkTrajectory& trajectory : trajectories) {
    const auto all = static_cast<double>(trajectories.size());
    const Progress one = part_of(progress, static_cast<double>(scenes.size()) / all, 1 / all);
    BenchmarkScene scene;
    scene.problem = benchmark_problem(trajectory);
    scene.reference = cached_reference(trajectory, part_of(one, 0, kReference));
    const auto contestants = contestants_of(scene.problem, options);
    if (!run_contest(contestants, timing, part_of(one, kReference, 1 - kReference), scene)) {
      throw std::runtime_error("stopped");
    }
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

BoundaryOptions check_boundary(const Options& options) {
  constexpr long kMost = 100000;
  BoundaryOptions checked;
  if (options.quick) checked.starts = checked.targets = 2;
  const auto set = [](const char* name, const std::string& text, int& value) {
    if (!text.empty()) value = static_cast<int>(parse_integer(name, text, 1, kMost));
  };
  set("--starts", options.starts, checked.starts);
  set("--targets", options.targets, checked.targets);
  checked.threads = parse_threads(options.threads);
  if (!options.seed.empty()) checked.seed = parse_seed("--seed", options.seed);
  return checked;
}

// Options that only the other benchmarks know: those of `flag`, where it was not given.
void check_absent(const char* flag,
                  std::initializer_list<std::pair<const char*, std::string>> options) {
  for (const auto& [name, text] : options) {
    if (!text.empty()) refuse(name, text, std::string("without ") + flag, "only with it");
  }
}

void check_options(const Options& options) {
  std::vector<std::string> kinds;
  if (options.boundary_value) kinds.emplace_back("--boundary-value");
  if (options.limits) kinds.emplace_back("--limits");
  if (options.drift) kinds.emplace_back("--drift");
  if (options.energy) kinds.emplace_back("--energy");
  if (kinds.size() > 1) refuse(kinds[1], "", "given besides " + kinds[0], "one of the two");
  if (!kinds.empty() && !options.scenes.empty()) {
    refuse("SCENE", options.scenes[0], "given besides " + kinds[0], "no SCENE");
  }
  if (!options.energy) check_absent("--energy", {{"--steps", options.steps}});
  if (!options.boundary_value) {
    check_absent("--boundary-value",
                 {{"--starts", options.starts}, {"--targets", options.targets}});
  }
  const bool direct = options.limits || options.drift;
  if (!options.boundary_value && !direct) {
    check_absent("--boundary-value, --limits or --drift", {{"--seed", options.seed}});
  }
  if (direct && !options.destination.plot.empty()) {
    refuse("--plot", options.destination.plot, "given besides " + kinds[0], "--output");
  }
  if (!options.boundary_value && !options.energy) {
    check_absent("--boundary-value or --energy", {{"--threads", options.threads}});
  }
  check_peers(options.peers);
  check_destination(options.destination);
}

// What all of them tell. `failure`: why nothing was measured, else empty.
Result result_of(const std::vector<std::string>& arguments, const std::string& failure) {
  Result result;
  result.delivered = failure.empty();
  result.message = failure;
  result.json = result_head(arguments);
  result.json["status"] = result.delivered ? "completed" : "failed";
  result.json["message"] = failure;
  result.json["processor"] = processor_name();
  result.json["compiler"] = __VERSION__;
  return result;
}

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

int run_boundary(const Options& options, const std::vector<std::string>& arguments) {
  const Stopwatch watch;
  const BoundaryOptions checked = check_boundary(options);
  std::vector<BoundarySolver> solvers = own_boundary_solvers();
  if (options.peers) {
    for (BoundarySolver& peer : boundary_peers()) solvers.push_back(std::move(peer));
  }
  std::optional<BoundaryResult> found;
  {
    ProgressBar bar("%", 100, options.destination.quiet);
    found = run_boundary_benchmark(checked, solvers, bar.callback());
  }
  Result result = result_of(arguments, found ? "" : "stopped");
  const BoundaryResult measured = found.value_or(BoundaryResult{});
  result.json["seed"] = checked.seed;
  add_boundary_json(measured, result.json);
  result.json["elapsed_seconds"] = watch.seconds();
  result.text = [&] { return boundary_text(measured); };
  result.draw = [&](const std::string& file) { return draw_boundary(file, measured); };
  result.csv = [&] { return boundary_markdown(measured, arguments); };
  return deliver(result, options.destination);
}

int run_direct(const Options& options, const std::vector<std::string>& arguments) {
  const Stopwatch watch;
  DirectOptions checked;
  checked.quick = options.quick;
  if (!options.seed.empty()) checked.seed = parse_seed("--seed", options.seed);
  std::optional<std::vector<DirectRow>> found;
  {
    ProgressBar bar("%", 100, options.destination.quiet);
    const auto peer = options.peers ? std::optional(direct_peer()) : std::nullopt;
    const auto& problems = options.drift ? drift_problems() : limits_problems();
    found = run_direct_benchmark(problems, checked, peer, bar.callback());
  }
  Result result = result_of(arguments, found ? "" : "stopped");
  const std::vector<DirectRow> measured = found.value_or(std::vector<DirectRow>{});
  add_direct_json(measured, result.json);
  result.json["elapsed_seconds"] = watch.seconds();
  result.text = [&] { return direct_text(measured); };
  result.csv = [&] { return direct_markdown(measured, arguments); };
  return deliver(result, options.destination);
}

EnergyOptions check_energy(const Options& options) {
  EnergyOptions checked;
  checked.quick = options.quick;
  if (options.quick) checked.steps = kFewSteps;
  if (!options.steps.empty()) {
    checked.steps = parse_integer("--steps", options.steps, kFewSteps, kMostSteps);
  }
  checked.threads = parse_threads(options.threads);
  return checked;
}

// Those of other libraries that reach drifts worth comparing.
std::vector<Contestant> energy_peers(const EnergyOptions& options) {
  std::vector<Contestant> all = peer_contestants(energy_problem(), {options.quick});
  std::erase_if(all, [](const Contestant& peer) {
    return peer.method != "gsl-rk8pd" && peer.method != "odeint-rkf78";
  });
  return all;
}

int run_energy(const Options& options, const std::vector<std::string>& arguments) {
  const Stopwatch watch;
  const EnergyOptions checked = check_energy(options);
  std::optional<EnergyResult> found;
  {
    ProgressBar bar("%", 100, options.destination.quiet);
    const auto peers = options.peers ? energy_peers(checked) : std::vector<Contestant>{};
    found = run_energy(checked, peers, bar.callback());
  }
  Result result = result_of(arguments, found ? "" : "stopped");
  const EnergyResult measured = found.value_or(EnergyResult{});
  add_energy_json(measured, result.json);
  result.json["elapsed_seconds"] = watch.seconds();
  result.text = [&] { return energy_text(measured); };
  result.draw = [&](const std::string& file) { return draw_energy(file, measured); };
  result.csv = [&] { return energy_markdown(measured, arguments); };
  return deliver(result, options.destination);
}

int run_trajectories(const Options& options, const std::vector<std::string>& arguments) {
  const Stopwatch watch;
  const auto trajectories = check_scenes(options.scenes);
  std::vector<BenchmarkScene> scenes;
  std::string failure;
  try {
    ProgressBar bar("scenes", static_cast<double>(trajectories.size()), options.destination.quiet);
    scenes = run_scenes(trajectories, options, bar.callback());
  } catch (const std::runtime_error& error) {
    failure = error.what();
  }
  Result result = result_of(arguments, failure);
  add_benchmark_json(scenes, result.json);
  result.json["elapsed_seconds"] = watch.seconds();
  result.text = [&] { return benchmark_text(scenes); };
  result.draw = [&](const std::string& file) { return draw_benchmark(file, scenes); };
  result.csv = [&] { return benchmark_markdown(scenes, arguments); };
  return deliver(result, options.destination);
}

int run_benchmark(const Options& options, const std::vector<std::string>& arguments) {
  check_options(options);
  if (options.boundary_value) return run_boundary(options, arguments);
  if (options.limits || options.drift) return run_direct(options, arguments);
  if (options.energy) return run_energy(options, arguments);
  return run_trajectories(options, arguments);
}

}  // namespace

void add_benchmark(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<Options>();
  CLI::App& benchmark = add_deferred_command(app, "benchmark");
  benchmark
      .add_option("SCENE", options->scenes, "vehicle-cosine, vehicle, heisenberg (all of them)")
      ->type_name("");
  benchmark.add_flag("--peers", options->peers, "add other libraries, where built with them");
  benchmark.add_flag("--quick", options->quick, "few rows and short blocks: rough times");
  benchmark.add_flag("--boundary-value",
                     options->boundary_value,
                     "compare solvers of boundary-value problems instead");
  benchmark.add_flag("--limits", options->limits, "geodesics that keep to limits instead");
  benchmark.add_flag("--drift", options->drift, "geodesics of scenes with drift instead");
  benchmark.add_flag("--energy", options->energy, "measure H in long runs instead");
  const auto add = [&](const char* name, std::string& value, const char* help) {
    benchmark.add_option(name, value, help)->type_name("N");
  };
  add("--starts", options->starts, "blind starts of each solver (64)");
  add("--targets", options->targets, "random targets of the curve over starts (20)");
  add("--steps", options->steps, "longest run of --energy (1000000)");
  add("--seed", options->seed, "fixes starts and targets (0)");
  add("--threads", options->threads, "threads; the answer does not depend on it (all)");
  Destination& destination = options->destination;
  benchmark.add_option("--plot", destination.plot, "draw a .png, .svg or .pdf")->type_name("FILE");
  benchmark.add_option("--output", destination.output, "write a .json, or a report as .md")
      ->type_name("FILE");
  benchmark.add_flag("--json", destination.json, "print one JSON object");
  benchmark.add_flag("--quiet", destination.quiet, "no progress bar");
  benchmark.footer(kFooter);
  benchmark.callback([options, &invocation] {
    invocation.exit_status = run_benchmark(*options, invocation.arguments);
  });
}

}  // namespace carnot::apps
