#include "run/run_options.h"

#include <map>
#include <stdexcept>

#include "carnot/plots/plot_file.h"
#include "catalogue/scene_choice.h"
#include "catalogue/text_entry.h"
#include "text/numbers.h"
#include "text/output_file.h"
#include "text/version.h"

namespace carnot::apps {
namespace {

constexpr long kMostSamples = 1000000;

plots::Figure find_figure(const std::string& name) {
  const std::map<std::string, plots::Figure> figures{{"automatic", plots::Figure::kAutomatic},
                                                     {"path", plots::Figure::kPath},
                                                     {"time", plots::Figure::kTime},
                                                     {"energy", plots::Figure::kEnergy},
                                                     {"overview", plots::Figure::kOverview}};
  const auto found = figures.find(name);
  if (found == figures.end()) {
    refuse("--figure", name, "unknown figure", "automatic, path, time, energy or overview");
  }
  return found->second;
}

void check_destination(const Destination& destination, bool no_trajectory) {
  const std::string& output = destination.output;
  if (!output.empty()) check_output_file("--output", output, {".json", ".csv"});
  if (no_trajectory && has_ending(output, ".csv")) {
    refuse("--output", output, "--no-trajectory leaves nothing for it", "a name ending in .json");
  }
  if (destination.plot.empty()) return;
  try {
    plots::validate_plot_file(destination.plot);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("--plot: ") + error.what());
  }
}

}  // namespace

void add_model_options(CLI::App& app, RunOptions& options) {
  app.add_option("SCENE", options.scene, "a name from `carnot scenes`")->type_name("");
  app.add_option("--set", options.set, "set a parameter of the scene (repeatable)")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  app.add_option("--method",
                 options.method,
                 "a name from `carnot methods` (gauss16; rattle where h(q) = 0 needs it)")
      ->type_name("NAME");
}

void add_effort_options(CLI::App& app, RunOptions& options) {
  app.add_option("--seed", options.seed, "fixes all randomness (0)")->type_name("N");
  app.add_option("--threads", options.threads, "threads; the answer does not depend on it (all)")
      ->type_name("N");
}

void add_result_options(CLI::App& app, Destination& destination) {
  app.add_option("--plot", destination.plot, "draw a .png, .svg, .pdf or .gif")->type_name("FILE");
  app.add_option("--output", destination.output, "write the result as .json or .csv")
      ->type_name("FILE");
  app.add_flag("--json", destination.json, "print one JSON object");
  app.add_flag("--quiet", destination.quiet, "no progress bar");
}

void add_run_options(CLI::App& app, RunOptions& options) {
  add_model_options(app, options);
  app.add_option("--samples", options.samples, "times in a trajectory, both ends included (201)")
      ->type_name("N");
  app.add_flag("--no-trajectory", options.no_trajectory, "leave trajectories out of the JSON");
  add_effort_options(app, options);
  app.add_option(
         "--figure", options.destination.figure_name, "automatic, path, time, energy, overview")
      ->type_name("NAME");
  add_result_options(app, options.destination);
}

void add_table_options(CLI::App& app, Destination& destination) {
  app.add_option("--output", destination.output, "write the JSON to a .json file")
      ->type_name("FILE");
  app.add_flag("--json", destination.json, "print one JSON object");
  app.add_flag("--quiet", destination.quiet, "no progress bar");
}

void check_table_output(const Destination& destination) {
  if (!destination.output.empty()) check_output_file("--output", destination.output, {".json"});
}

int parse_threads(const std::string& text) {
  constexpr long kMostThreads = 1024;
  return text.empty() ? 0 : static_cast<int>(parse_integer("--threads", text, 1, kMostThreads));
}

Run check(const RunOptions& options) { return check(options, find_scene(options.scene)); }

Run check(const RunOptions& options, const SceneEntry& entry) {
  Run run;
  run.entry = &entry;
  run.parameters = parse_parameters(*run.entry, options.set);
  const bool as_text = options.searches && is_searched_as_text(*run.entry, options.method);
  run.method = as_text ? *find_method("gauss16") : choose_method(options.method, *run.entry);
  set_effort(options, run);
  run.no_trajectory = options.no_trajectory;
  run.destination = options.destination;
  run.destination.figure = find_figure(options.destination.figure_name);
  check_destination(run.destination, run.no_trajectory);
  run.make = [entry = run.entry, method = run.method.name, as_text](const ParameterValues& values) {
    return as_text ? dynamics_of_text(*entry, values) : entry->make(values, method);
  };
  run.dynamics = run.make(run.parameters);
  const bool drawable = run.dynamics.info.drawing.view != Drawing::View::kTimeOnly;
  const plots::Figure figure = run.destination.figure;
  if (!drawable && (figure == plots::Figure::kPath || figure == plots::Figure::kOverview)) {
    refuse(
        "--figure", options.destination.figure_name, "this scene has no drawing", "time or energy");
  }
  return run;
}

void set_effort(const RunOptions& options, Run& run) {
  run.samples = parse_integer("--samples", options.samples, 2, kMostSamples);
  run.seed = parse_seed("--seed", options.seed);
  run.threads = parse_threads(options.threads);
}

Json result_head(const std::vector<std::string>& arguments) {
  return {{"version", kVersion}, {"arguments", arguments}};
}

Json parameters_json(const Run& run) {
  Json values = Json::object();
  for (const ParameterInfo& parameter : run.entry->parameters) {
    values[parameter.name] = run.parameters.at(parameter.name);
  }
  return values;
}

}  // namespace carnot::apps
