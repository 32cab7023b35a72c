// carnot benchmark: speed against error on three trajectories whose ends are known to many digits.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <set>
#include <stdexcept>

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

Times are the median CPU time of one trajectory over blocks, in rounds through all the rows of a
scene, so that times within one run compare.

Examples
  carnot benchmark
  carnot benchmark vehicle --json
  carnot benchmark --plot speed.png --output speed.md

Exit status: 0 success, 1 a file or reference did not come about, 2 bad input, 130 interrupted.)";

struct Options {
  std::vector<std::string> scenes;
  bool peers = false;
  bool quick = false;
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

int run_benchmark(const Options& options, const std::vector<std::string>& arguments) {
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
