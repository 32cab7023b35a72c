#include "front/front_request.h"

#include <utility>

#include "catalogue/holonomic_check.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"

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
  if (!dynamics.autonomous || !dynamics.has_transcription() || energy(dynamics, from, rest) != 0) {
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

}  // namespace

FrontRequest check(const FrontCall& options) {
  FrontRequest request;
  request.run = check(options.run);
  if (options.what.empty()) refuse_missing("--what", "cut");
  if (options.what != "cut") refuse("--what", options.what, "unknown", "cut");
  request.from = parse_start(options, request.run);
  check_scene(request.run, request.from);
  request.momentum = parse_momentum(options, request.run, request.from);
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
  return request;
}

}  // namespace carnot::apps
