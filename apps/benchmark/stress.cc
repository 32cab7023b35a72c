// carnot stress: default searches for the geodesics to many random targets; or the hard cases.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <memory>

#include "benchmark/benchmark_clock.h"
#include "benchmark/stress_suite.h"
#include "carnot/numerics/parallel.h"
#include "carnot/shooting/find_geodesics.h"
#include "catalogue/method_table.h"
#include "catalogue/scene_choice.h"
#include "catalogue/text_entry.h"
#include "run/deferred.h"
#include "run/delivery.h"
#include "run/geodesic_text.h"
#include "run/random_target.h"
#include "run/search_options.h"
#include "run/subcommands.h"
#include "text/numbers.h"
#include "text/progress_bar.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kStressFooter = R"(
From the origin to targets drawn uniformly, positions within 3, angles within pi, on the cover and
on the near side of singular coordinates, or from one random point of a manifold to another; where
a drift or a force decides what can be reached, to the end of a motion with random momenta; each
the default search for one geodesic on one thread, many at a time. "solved" has been verified by an
independent integration, at knots where the end point is too sensitive. Those that are not are
counted by reason: the codes of `carnot geodesic`, and irregular-end where the constraints are
dependent at the target; --json has them one by one, with messages. Times are CPU times.
With limits, targets are drawn until one keeps to them.

--suite, without a scene, runs hard cases instead: unstable motions, long runs, stiffness, near loss
of index 1, boundary values at the ends of scales. Each has a law; printed are how far from it carnot
is, how far is allowed, and how far a naive method is. A star marks a law that is broken. --short
leaves out what takes minutes, 10^7 steps and quadruple precision.

Examples
  carnot stress vehicle
  carnot stress trailer1 --targets 1000 --seed 7 --json
  carnot stress vehicle --targets 100 --limit 'phi-theta in -0.3:0.3'
  carnot stress --suite --short

Exit status: 0 success, also where targets are left unsolved; 1 a law of the suite is broken, 2 bad
input, 130 interrupted.)";

struct StressOptions {
  bool suite = false;
  bool brief = false;
  std::string scene;
  std::vector<std::string> set;
  std::string method;
  std::string targets = "1000";
  std::string seed = "0";
  std::string threads;
  Destination destination;
  std::string time_limit;
  AskedLimits asked;
};

struct Trial {
  std::vector<double> from;
  std::vector<double> to;
  double seconds = 0;
  bool solved = false;
  bool at_knots = false;
  Label label = Label::kUnknown;
  std::string reason;  // a code
  std::string message;
};

// What all targets share.
struct Course {
  Dynamics dynamics;
  std::vector<Limit> limits;
  double time_limit = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 0;
};

Trial try_target(const Course& course, int i) {
  const Dynamics& dynamics = course.dynamics;
  const double began = thread_seconds();
  Trial trial;
  trial.from.assign(dynamics.dof, 0.0);
  if (dynamics.holonomic > 0) trial.from = random_target(dynamics, ~course.seed, i);
  trial.to = trial_target(dynamics, course.limits, course.seed, i);
  GeodesicOptions options;
  options.seed = course.seed;
  options.time_limit = course.time_limit;
  options.threads = 1;
  options.samples = 0;
  try {
    BoundaryValueProblem problem(dynamics, trial.from, trial.to);
    problem.limits = course.limits;
    const GeodesicReport report = find_geodesics(problem, options);
    trial.reason = name_of(report.reason);
    trial.message = report.message;
    trial.solved = !report.geodesics.empty();
    if (trial.solved) {
      trial.at_knots = report.geodesics[0].verification == Verification::kKnots;
      trial.label = report.geodesics[0].label;
    }
  } catch (const std::invalid_argument& error) {  // e.g. constraints that are dependent there
    trial.reason = name_of(Reason::kIrregularEnd);
    trial.message = error.what();
  }
  trial.seconds = thread_seconds() - began;
  return trial;
}

// Empty when stopped.
std::vector<Trial> try_all(const Course& course, int targets, int threads, const Progress& go_on) {
  constexpr int kBatch = 16;  // between two looks at the progress
  std::vector<Trial> trials(targets);
  for (int first = 0; first < targets; first += kBatch * threads) {
    if (!go_on(static_cast<double>(first) / targets)) return {};
    const int count = std::min(kBatch * threads, targets - first);
    parallel_for(count, threads, [&](int i) { trials[first + i] = try_target(course, first + i); });
  }
  return trials;
}

double quantile(const std::vector<Trial>& trials, double share) {
  std::vector<double> seconds;
  seconds.reserve(trials.size());
  for (const Trial& trial : trials) seconds.push_back(trial.seconds);
  const auto at = seconds.begin() +
                  static_cast<std::ptrdiff_t>(share * static_cast<double>(seconds.size() - 1));
  std::nth_element(seconds.begin(), at, seconds.end());
  return *at;
}

Json summary_of(const std::vector<Trial>& trials) {
  int solved = 0;
  int at_knots = 0;
  std::map<std::string, int> labels;
  std::map<std::string, int> reasons;
  Json failures = Json::array();
  for (const Trial& trial : trials) {
    solved += trial.solved ? 1 : 0;
    at_knots += trial.at_knots ? 1 : 0;
    if (trial.solved) {
      ++labels[name_of(trial.label)];
    } else {
      ++reasons[trial.reason];
      failures.push_back({{"from", trial.from},
                          {"to", trial.to},
                          {"reason", trial.reason},
                          {"message", trial.message}});
    }
  }
  const auto count = static_cast<double>(trials.size());
  return {{"targets", trials.size()},
          {"solved", solved},
          {"solved_share", solved / count},
          {"verified_at_knots", at_knots},
          {"labels", labels},
          {"reasons", reasons},
          {"median_seconds", quantile(trials, 0.5)},
          {"p90_seconds", quantile(trials, 0.9)},
          {"failures", failures}};
}

std::string stress_text(const Json& json) {
  const auto count = [&json](const char* key) { return json[key].get<long>(); };
  const auto milliseconds = [&json](const char* key) {
    return fmt::format("{:.3g} ms", 1e3 * json[key].get<double>());
  };
  std::vector<std::vector<std::string>> rows{
      {"scene", json["scene"].get<std::string>()},
      {"targets", std::to_string(count("targets"))},
      {"solved and verified",
       fmt::format("{} ({:.2f} %)", count("solved"), 1e2 * json["solved_share"].get<double>())},
      {"verified at knots", std::to_string(count("verified_at_knots"))},
      {"median CPU time", milliseconds("median_seconds")},
      {"90 % within", milliseconds("p90_seconds")},
      {"wall time", fmt::format("{:.3g} s", json["elapsed_seconds"].get<double>())}};
  for (const auto& [label, times] : json["labels"].items()) {
    rows.push_back({label, std::to_string(times.get<long>())});
  }
  for (const auto& [reason, times] : json["reasons"].items()) {
    rows.push_back({"unsolved", fmt::format("{}: {}", times.get<long>(), reason)});
  }
  return text_table(rows);
}

int run_suite_command(const StressOptions& options, const std::vector<std::string>& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  if (!options.scene.empty()) {
    refuse("SCENE", options.scene, "the suite has scenes of its own", "--suite without a scene");
  }
  const SuiteOptions suite{options.brief, parse_threads(options.threads)};
  check_table_output(options.destination);
  ProgressBar bar("%", 100, options.destination.quiet);
  const auto cases = run_suite(suite, bar.callback());
  if (!cases) return kInterrupted;
  Result result;
  result.json = result_head(arguments);
  result.json.update(suite_json(*cases));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  result.json["elapsed_seconds"] = elapsed.count();
  result.text = [&] { return suite_text(*cases); };
  const int status = deliver(result, options.destination);
  const bool held =
      std::all_of(cases->begin(), cases->end(), [](const StressCase& one) { return one.holds(); });
  return status == kSuccess && !held ? kNotDelivered : status;
}

int run_stress(const StressOptions& options, const std::vector<std::string>& arguments) {
  if (options.suite) return run_suite_command(options, arguments);
  if (options.brief) refuse("--short", "", "it belongs to the suite", "--suite --short");
  constexpr long kMostTargets = 10000000;
  const auto begin = std::chrono::steady_clock::now();
  const SceneEntry& entry = find_scene(options.scene);
  const ParameterValues parameters = parse_parameters(entry, options.set);
  const bool as_text = is_searched_as_text(entry, options.method);
  const Method& method = as_text ? *find_method("gauss16") : choose_method(options.method, entry);
  const auto targets =
      static_cast<int>(parse_integer("--targets", options.targets, 1, kMostTargets));
  Course course;
  course.seed = parse_seed("--seed", options.seed);
  if (!options.time_limit.empty()) {
    course.time_limit = parse_positive("--time-limit", options.time_limit);
  }
  const int threads = parse_threads(options.threads);
  check_table_output(options.destination);
  course.dynamics =
      as_text ? dynamics_of_text(entry, parameters) : entry.make(parameters, method.name);
  const Dynamics& dynamics = course.dynamics;
  course.limits =
      options.asked.any() ? choose_limits(entry, parameters, options.asked) : dynamics.info.limits;
  if (dynamics.forced > 0 && !dynamics.on_leaves) {
    refuse("--method", options.method, "searches by RATTLE take too long", "none, for gauss16");
  }
  ProgressBar bar("targets", targets, options.destination.quiet);
  const std::vector<Trial> trials = try_all(course, targets, thread_count(threads), bar.callback());
  if (trials.empty()) return kInterrupted;
  Result result;
  result.json = result_head(arguments);
  result.json["scene"] = entry.info.name;
  result.json["parameters"] = parameters;
  result.json["method"] = method.name;
  result.json["seed"] = course.seed;
  result.json.update(summary_of(trials));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  result.json["elapsed_seconds"] = elapsed.count();
  result.text = [&] { return stress_text(result.json); };
  return deliver(result, options.destination);
}

}  // namespace

void add_stress(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<StressOptions>();
  CLI::App& stress = add_deferred_command(app, "stress");
  stress.add_option("SCENE", options->scene, "a name from `carnot scenes`")->type_name("");
  stress.add_flag("--suite", options->suite, "hard cases and their laws, without a scene");
  stress.add_flag("--short", options->brief, "of the suite what takes seconds");
  stress.add_option("--set", options->set, "set a parameter of the scene (repeatable)")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    stress.add_option(name, value, help)->type_name(type);
  };
  add("--method", options->method, "NAME", "a name from `carnot methods` (gauss16)");
  add("--targets", options->targets, "N", "how many (1000)");
  add("--seed", options->seed, "N", "fixes all randomness (0)");
  add("--threads", options->threads, "N", "threads; the answer does not depend on it (all)");
  add("--time-limit", options->time_limit, "SECONDS", "of each target (none)");
  add_limit_options(stress, options->asked);
  add_table_options(stress, options->destination);
  stress.footer(kStressFooter);
  stress.callback([options, &invocation] {
    invocation.exit_status = run_stress(*options, invocation.arguments);
  });
}

}  // namespace carnot::apps
