// carnot benchmark: speed against error on three trajectories whose ends are known to many digits;
// with --boundary-value, solvers of boundary-value problems from blind starts.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "benchmark_boundary_report.h"
#include "benchmark_cache.h"
#include "benchmark_report.h"
#include "benchmark_rows.h"
#include "carnot/plots/plot_file.h"
#include "delivery.h"
#include "nearest.h"
#include "numbers.h"
#include "output_file.h"
#include "progress_bar.h"
#include "subcommands.h"
#ifdef CARNOT_PEERS
#include "peers/boundary_peers.h"
#include "peers/peers.h"
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
before newton, ceres or nlopt:NAME shoot, and random momenta. What counts is verified by an
independent integration. With --peers also ipopt on the direct midpoint transcription, 50 intervals,
and gsl-hybridsj on single shooting. Then, over 1, 2, 4, ... 64 starts, the share of --targets random
targets that are at the least action: --plot draws that. Takes some minutes.

Times are the median CPU time of one trajectory over blocks, in rounds through all the rows of a
scene, so that times within one run compare.

Examples
  carnot benchmark
  carnot benchmark vehicle --json
  carnot benchmark --plot speed.png --output speed.md
  carnot benchmark --boundary-value --starts 32 --output solvers.md

Exit status: 0 success, 1 a file or reference did not come about, 2 bad input, 130 interrupted.)";

struct Options {
  std::vector<std::string> scenes;
  bool peers = false;
  bool quick = false;
  bool boundary_value = false;
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
             "no trajectory to benchmark" + suggestion(name, known),
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
    const auto part = [&](double begin, double share) -> Progress {
      const auto first = static_cast<double>(scenes.size());
      const auto all = static_cast<double>(trajectories.size());
      return [=, &progress](double done) { return progress((first + begin + share * done) / all); };
    };
    BenchmarkScene scene;
    scene.problem = benchmark_problem(trajectory);
    scene.reference = cached_reference(trajectory, part(0, kReference));
    const auto contestants = contestants_of(scene.problem, options);
    if (!run_contest(contestants, timing, part(kReference, 1 - kReference), scene)) {
      throw std::runtime_error("stopped");
    }
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

BoundaryOptions check_boundary(const Options& options) {
  constexpr long kMost = 100000;
  constexpr long kMostThreads = 1024;
  if (!options.scenes.empty()) {
    refuse("SCENE", options.scenes[0], "given besides --boundary-value", "no SCENE");
  }
  BoundaryOptions checked;
  if (options.quick) checked.starts = checked.targets = 2;
  const auto set = [](const char* name, const std::string& text, long most, int& value) {
    if (!text.empty()) value = static_cast<int>(parse_integer(name, text, 1, most));
  };
  set("--starts", options.starts, kMost, checked.starts);
  set("--targets", options.targets, kMost, checked.targets);
  set("--threads", options.threads, kMostThreads, checked.threads);
  if (!options.seed.empty()) checked.seed = parse_seed("--seed", options.seed);
  return checked;
}

// Options that only --boundary-value knows.
void check_no_boundary(const Options& options) {
  for (const auto& [name, text] : {std::pair{"--starts", options.starts},
                                   {"--targets", options.targets},
                                   {"--seed", options.seed},
                                   {"--threads", options.threads}}) {
    if (!text.empty()) refuse(name, text, "without --boundary-value", "only with it");
  }
}

int run_boundary(const Options& options, const std::vector<std::string>& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  check_peers(options.peers);
  check_destination(options.destination);
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
  Result result;
  result.delivered = found.has_value();
  if (!found) result.message = "stopped";
  const BoundaryResult measured = found.value_or(BoundaryResult{});
  result.json = result_head(arguments);
  result.json["status"] = result.delivered ? "completed" : "failed";
  result.json["message"] = result.message;
  result.json["processor"] = processor_name();
  result.json["compiler"] = __VERSION__;
  result.json["seed"] = checked.seed;
  add_boundary_json(measured, result.json);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  result.json["elapsed_seconds"] = elapsed.count();
  result.text = [&] { return boundary_text(measured); };
  result.draw = [&](const std::string& file) { return draw_boundary(file, measured); };
  result.csv = [&] { return boundary_markdown(measured, arguments); };
  return deliver(result, options.destination);
}

int run_benchmark(const Options& options, const std::vector<std::string>& arguments) {
  if (options.boundary_value) return run_boundary(options, arguments);
  check_no_boundary(options);
  const auto clock = [] { return std::chrono::steady_clock::now(); };
  const auto begin = clock();
  check_peers(options.peers);
  check_destination(options.destination);
  const auto trajectories = check_scenes(options.scenes);
  std::vector<BenchmarkScene> scenes;
  Result result;
  try {
    ProgressBar bar("scenes", static_cast<double>(trajectories.size()), options.destination.quiet);
    scenes = run_scenes(trajectories, options, bar.callback());
  } catch (const std::runtime_error& error) {
    result.delivered = false;
    result.message = error.what();
  }
  result.json = result_head(arguments);
  result.json["status"] = result.delivered ? "completed" : "failed";
  result.json["message"] = result.message;
  result.json["processor"] = processor_name();
  result.json["compiler"] = __VERSION__;
  add_benchmark_json(scenes, result.json);
  result.json["elapsed_seconds"] = std::chrono::duration<double>(clock() - begin).count();
  result.text = [&] { return benchmark_text(scenes); };
  result.draw = [&](const std::string& file) { return draw_benchmark(file, scenes); };
  result.csv = [&] { return benchmark_markdown(scenes, arguments); };
  return deliver(result, options.destination);
}

}  // namespace

void add_benchmark(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<Options>();
  CLI::App& benchmark = *app.add_subcommand("benchmark", "Measure speed against error.");
  benchmark
      .add_option("SCENE", options->scenes, "vehicle-cosine, vehicle, heisenberg (all of them)")
      ->type_name("");
  benchmark.add_flag("--peers", options->peers, "add other libraries, where built with them");
  benchmark.add_flag("--quick", options->quick, "few rows and short blocks: rough times");
  benchmark.add_flag("--boundary-value",
                     options->boundary_value,
                     "compare solvers of boundary-value problems instead");
  const auto add = [&](const char* name, std::string& value, const char* help) {
    benchmark.add_option(name, value, help)->type_name("N");
  };
  add("--starts", options->starts, "blind starts of each solver (64)");
  add("--targets", options->targets, "random targets of the curve over starts (20)");
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
