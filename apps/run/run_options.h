// Options that every run of a scene takes: scene, parameters, method, where the result goes.
//
// CLI11 fills RunOptions with texts; check() turns them into a Run or refuses them, before any
// work.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "carnot/plots/figure.h"
#include "catalogue/method_table.h"
#include "catalogue/scene_entry.h"
#include "text/json_text.h"

namespace carnot::apps {

// Where the result goes.
struct Destination {
  bool json = false;
  bool quiet = false;
  std::string output;  // .json or .csv; empty: none
  std::string plot;    // empty: none
  std::string figure_name = "automatic";
  plots::Figure figure = plots::Figure::kAutomatic;  // set by check()
};

struct RunOptions {
  std::string scene;
  std::vector<std::string> set;
  std::string method;     // empty: the default of the scene
  bool searches = false;  // the scene is searched, not only followed
  std::string samples = "201";
  std::string seed = "0";
  std::string threads;  // empty: all cores
  bool no_trajectory = false;
  Destination destination;
};

struct Run {
  const SceneEntry* entry = nullptr;
  Method method;
  ParameterValues parameters;
  Dynamics dynamics;
  std::function<Dynamics(const ParameterValues&)> make;  // the same with other parameters
  long samples = 0;
  std::uint64_t seed = 0;
  int threads = 0;  // 0: all cores
  bool no_trajectory = false;
  Destination destination;
};

// The names of a subcommand's own options come first in its help, then these.
void add_run_options(CLI::App& app, RunOptions& options);

// Parts of these: SCENE, --set, --method; --seed, --threads; --plot, --output, --json, --quiet.
void add_model_options(CLI::App& app, RunOptions& options);
void add_effort_options(CLI::App& app, RunOptions& options);
void add_result_options(CLI::App& app, Destination& destination);

// For tables: --json, --output (.json only), --quiet.
void add_table_options(CLI::App& app, Destination& destination);
void check_table_output(const Destination& destination);

// The value of --threads; 0, all cores, where it is not given. Throws std::invalid_argument.
int parse_threads(const std::string& text);

// Throws std::invalid_argument.
Run check(const RunOptions& options);
// The same of a scene that is known, whatever `options.scene` says. It must outlive the run.
Run check(const RunOptions& options, const SceneEntry& entry);

// Sets samples, seed and threads of a run. Throws std::invalid_argument.
void set_effort(const RunOptions& options, Run& run);

// {"version", "arguments"}: how every JSON result begins.
Json result_head(const std::vector<std::string>& arguments);

// "parameters" of the run, in the scene's own order.
Json parameters_json(const Run& run);

}  // namespace carnot::apps
