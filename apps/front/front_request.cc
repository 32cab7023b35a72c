#include "front/front_request.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "carnot/shooting/cut_time.h"
#include "catalogue/holonomic_check.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"
#include "text/output_file.h"

namespace carnot::apps {
namespace {

// The start, which lies on the manifold of the scene.
std::vector<double> parse_start(const FrontCall& options, const Run& run) {
  const auto names = coordinate_names(*run.entry);
  if (options.from.empty()) refuse_missing("--from", vector_accepted(names));
  std::vector<double> from = parse_vector("--from", options.from, names);
  check_end("--from", options.from, run.dynamics, from);
  return from;
}

// H at the start with this momentum.
double energy(const Dynamics& dynamics,
              const std::vector<double>& q,
              const std::vector<double>& p) {
  std::vector<double> velocity(q.size()), lambda(dynamics.multipliers);
  return dynamics.evaluate(0, q, p, velocity, lambda).hamiltonian;
}

// Fronts are of scenes where all extremals from a point run at any speed through the same curves.
void check_scene(const Run& run, const std::vector<double>& from) {
  const Dynamics& dynamics = run.dynamics;
  const std::vector<double> rest(from.size(), 0.0);
  const bool knows_velocities = dynamics.has_transcription() || dynamics.on_leaves;
  if (!dynamics.autonomous || !knows_velocities || energy(dynamics, from, rest) != 0) {
    refuse("SCENE",
           run.entry->info.name,
           "its extremals depend on their speed",
           "a scene with velocity constraints or driftless controls, without a potential");
  }
}

std::vector<double> parse_momentum(const FrontCall& options,
                                   const Run& run,
                                   const std::vector<double>& from) {
  const auto names = coordinate_names(*run.entry);
  if (options.momentum.empty()) refuse_missing("--momentum", vector_accepted(names));
  std::vector<double> p = parse_vector("--momentum", options.momentum, names);
  if (!(energy(run.dynamics, from, p) > 0)) {
    refuse("--momentum", options.momentum, "its velocity is zero", "one that moves");
  }
  return p;
}

FrontKind parse_kind(const std::string& what) {
  constexpr const char* kAccepted = "front, sphere, caustic or cut";
  if (what.empty()) refuse_missing("--what", kAccepted);
  if (what == "front") return FrontKind::kFront;
  if (what == "sphere") return FrontKind::kSphere;
  if (what == "caustic") return FrontKind::kCaustic;
  if (what != "cut") refuse("--what", what, "unknown", kAccepted);
  return FrontKind::kCut;
}

// The number of a coordinate, which may have a prefix such as p_.
int coordinate_of(const char* option,
                  const std::string& text,
                  const std::string& name,
                  const std::string& prefix,
                  const std::vector<std::string>& names) {
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (prefix + names[j] == name) return static_cast<int>(j);
  }
  refuse(option, text, "there is no " + name, fmt::format("{}", fmt::join(names, ", ")));
}

// --fix p_NAME=VALUE of a momentum; NAME=VALUE or NAME=NAME of the ends.
void parse_fixed(const std::string& text,
                 const std::vector<std::string>& names,
                 FrontOptions& front) {
  const auto at = text.find('=');
  if (at == std::string::npos) {
    refuse("--fix", text, "there is no =", "p_NAME=VALUE, NAME=VALUE or NAME=NAME");
  }
  const std::string left = text.substr(0, at);
  const std::string right = text.substr(at + 1);
  const auto is_name = [&](const std::string& word) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  if (!is_name(left)) {
    const int j = coordinate_of("--fix", text, left, "p_", names);
    front.fixed.emplace_back(j, parse_real("--fix", right));
    return;
  }
  if (front.section) {
    refuse("--fix", text, "there is a condition on the ends already", "one such condition");
  }
  EndCondition& end = front.section.emplace();
  end.coordinate = coordinate_of("--fix", text, left, "", names);
  if (is_name(right)) {
    end.equal = coordinate_of("--fix", text, right, "", names);
  } else {
    end.value = parse_real("--fix", right);
  }
}

// --mod-sign NAME,NAME...: -1 for these coordinates.
std::vector<double> parse_signs(const FrontCall& options,
                                const Run& run,
                                const std::vector<double>& from) {
  if (options.mod_sign.empty()) return {};
  const auto names = coordinate_names(*run.entry);
  std::vector<double> signs(names.size(), 1.0);
  for (const std::string& name : split(options.mod_sign, ',')) {
    signs[coordinate_of("--mod-sign", options.mod_sign, name, "", names)] = -1;
  }
  try {
    check_signs(run.dynamics, from, signs);
  } catch (const std::invalid_argument& error) {
    refuse("--mod-sign",
           options.mod_sign,
           error.what(),
           "coordinates such as w,x,y,z of a quaternion");
  }
  return signs;
}

void parse_surface(const FrontCall& options, const Run& run, FrontRequest& request) {
  constexpr long kFewest = 1584;  // of the largest first mesh
  constexpr long kMost = 5000000;
  const auto names = coordinate_names(*run.entry);
  if (options.length.empty()) refuse_missing("--length", "lengths > 0, as in 1 or 0.5,1,1.5");
  for (const std::string& part : split(options.length, ',')) {
    request.lengths.push_back(parse_positive("--length", part));
  }
  for (const std::string& text : options.fix) {
    parse_fixed(text, names, request.front);
  }
  if (!options.project.empty()) {
    for (const std::string& name : split(options.project, ',')) {
      request.front.project.push_back(coordinate_of("--project", options.project, name, "", names));
    }
    if (request.front.project.size() != 3 || names.size() < 3) {
      refuse("--project", options.project, "these are not three", "three coordinates");
    }
  }
  if (!options.order.empty()) {
    request.front.order = static_cast<int>(parse_integer("--order", options.order, 1, 1000));
    if (request.front.what != FrontKind::kCaustic) {
      refuse("--order", options.order, "only caustics have one", "--order with --what caustic");
    }
  }
  if (!options.edge.empty()) request.front.edge = parse_between("--edge", options.edge, 1e-3, 1);
  if (!options.bound.empty()) request.front.bound = parse_positive("--bound", options.bound);
  if (!options.vertices.empty()) {
    request.front.most =
        static_cast<int>(parse_integer("--vertices", options.vertices, kFewest, kMost));
  }
  if (!options.output.empty()) {
    check_output_file("--output", options.output, {".vtp", ".ply", ".csv"});
  }
  request.output = options.output;
  request.front.times = options.times;
  request.front.cusps = options.cusps;
  if (options.cusps && (request.front.what != FrontKind::kCaustic || names.size() < 3)) {
    refuse("--cusps", "", "only caustics in space have such lines", "--cusps with --what caustic");
  }
  request.check = options.check;
  if (options.check && request.front.what != FrontKind::kSphere) {
    refuse("--check", "", "only spheres are closed", "--check with --what sphere");
  }
}

// What the library would refuse: scenes whose momenta of unit speed are no surface.
void check_surface(const FrontRequest& request, const Run& run) {
  try {
    check_wavefront(run.dynamics, request.from, request.front);
  } catch (const std::invalid_argument& error) {
    refuse(
        request.front.fixed.empty() && !request.front.section ? "SCENE" : "--fix",
        run.entry->info.name,
        error.what(),
        "a scene with two or three admissible directions, and --fix where it has more than three "
        "coordinates");
  }
}

}  // namespace

FrontRequest check(const FrontCall& options) {
  FrontRequest request;
  request.run = check(options.run);
  request.front.what = parse_kind(options.what);
  request.from = parse_start(options, request.run);
  check_scene(request.run, request.from);
  if (options.momentum.empty()) {
    parse_surface(options, request.run, request);
    check_surface(request, request.run);
  } else {
    if (request.front.what != FrontKind::kCut) {
      refuse("--momentum", options.momentum, "one extremal has a cut time only", "--what cut");
    }
    request.momentum = parse_momentum(options, request.run, request.from);
    if (!request.run.destination.plot.empty()) {
      refuse("--plot", request.run.destination.plot, "a cut time is no picture", "--length R");
    }
    if (!options.output.empty()) check_output_file("--output", options.output, {".json"});
  }
  request.run.destination.output = options.momentum.empty() ? "" : options.output;
  if (!options.max_time.empty()) {
    request.max_time = parse_positive("--max-time", options.max_time);
  }
  if (!options.time_limit.empty()) {
    request.time_limit = parse_positive("--time-limit", options.time_limit);
  }
  if (options.cover && options.mod_angles) {
    refuse("--mod-angles", "", "given besides --cover", "one of the two");
  }
  request.mod_angles = !options.cover;
  request.front.mod_angles = request.mod_angles;
  request.front.signs = parse_signs(options, request.run, request.from);
  request.front.seed = request.run.seed;
  request.front.threads = request.run.threads;
  return request;
}

}  // namespace carnot::apps
