#include "flow/flow_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "catalogue/holonomic_check.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr long kMostSteps = 1000000000000;
constexpr double kVelocityTolerance = 1e-9;

// p of a velocity that satisfies the constraints at (t, q).
std::vector<double> momentum_of(const Dynamics& dynamics,
                                double t,
                                const std::vector<double>& q,
                                std::vector<double> velocity,
                                const std::vector<double>& lambda,
                                const std::string& text) {
  const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const double size = std::abs(*std::max_element(velocity.begin(), velocity.end(), larger));
  std::vector<double> trial = velocity;
  // Where constraints are linear in q', squares of a unit vector neither overflow nor vanish.
  if (dynamics.has_transcription() && size > 0) {
    for (double& v : trial) v /= size;
  }
  std::vector<double> p(q.size());
  const double residual = dynamics.momentum(t, q, trial, lambda, p);
  if (!(residual <= kVelocityTolerance)) {
    refuse(
        "--velocity",
        text,
        fmt::format("it violates the constraints at --from, relative residual = {:.3g}", residual),
        fmt::format("a velocity with residual <= {:g}", kVelocityTolerance));
  }
  dynamics.momentum(t, q, velocity, lambda, p);
  if (!std::all_of(p.begin(), p.end(), [](double x) { return std::isfinite(x); })) {
    refuse("--velocity",
           text,
           "its momentum is not finite",
           "a velocity where the constraints are independent");
  }
  return p;
}

std::vector<double> parse_lambda(const FlowOptions& options, const Dynamics& dynamics) {
  std::vector<double> lambda(dynamics.multipliers);
  if (options.lambda.empty()) return lambda;
  if (dynamics.multipliers == 0) {
    refuse("--lambda", options.lambda, "the scene has no multipliers", "no --lambda");
  }
  return parse_vector("--lambda", options.lambda, numbered_names("lambda_", dynamics.multipliers));
}

std::vector<double> parse_momentum(const FlowOptions& options, const FlowRequest& request) {
  const Dynamics& dynamics = request.run.dynamics;
  const auto names = coordinate_names(*request.run.entry);
  if (!options.momentum.empty() && !options.velocity.empty()) {
    refuse("--velocity", options.velocity, "given besides --momentum", "one of the two");
  }
  if (!options.lambda.empty() && options.velocity.empty() && !dynamics.has_branches()) {
    refuse("--lambda",
           options.lambda,
           "given without --velocity, and every p has one lambda in this scene",
           "--lambda with --velocity only");
  }
  if (!options.momentum.empty()) return parse_vector("--momentum", options.momentum, names);
  if (options.velocity.empty()) {
    refuse_missing("--momentum", "--momentum P0 or --velocity V0, " + vector_accepted(names));
  }
  const auto lambda = parse_lambda(options, dynamics);
  const auto velocity = parse_vector("--velocity", options.velocity, names);
  return momentum_of(dynamics, request.start_time, request.z, velocity, lambda, options.velocity);
}

// The branch of H_y = 0 through the multipliers given.
void choose_branch(const FlowOptions& options, FlowRequest& request) {
  Dynamics& dynamics = request.run.dynamics;
  if (!dynamics.has_branches()) return;
  if (options.lambda.empty() && options.velocity.empty()) return;
  const auto lambda = parse_lambda(options, dynamics);
  const std::span<const double> z(request.z);
  auto chosen = dynamics.on_branch(
      request.start_time, z.first(dynamics.dof), z.subspan(dynamics.dof), lambda);
  if (!chosen) {
    refuse("--lambda", options.lambda, "no solution of H_y = 0 is near it", "another --lambda");
  }
  dynamics = std::move(*chosen);
}

// Holonomic constraints: z is on their manifold but for round-off, and then exactly.
void check_manifold(const FlowOptions& options, FlowRequest& request) {
  const Dynamics& dynamics = request.run.dynamics;
  if (dynamics.holonomic == 0) return;
  const auto residuals = dynamics.holonomic_residuals(request.start_time, request.z);
  check_holonomic("--from", options.from, residuals);
  const bool by_momentum = !options.momentum.empty();
  if (!(residuals.relative_velocity <= kVelocityTolerance)) {
    refuse(by_momentum ? "--momentum" : "--velocity",
           by_momentum ? options.momentum : options.velocity,
           fmt::format("q' leaves the holonomic constraints, relative residual of Dh q' = {:.3g}",
                       residuals.relative_velocity),
           fmt::format("a residual <= {:g}", kVelocityTolerance));
  }
  if (!dynamics.project_on_manifold(request.start_time, request.z)) {
    refuse("--from", options.from, "the holonomic constraints are dependent", "another --from");
  }
}

void parse_steps(const FlowOptions& options, FlowRequest& request) {
  constexpr const char* kAccepted = "exactly one of --step H, --steps N and --tolerance TOL";
  std::vector<std::pair<const char*, std::string>> given;
  if (!options.step.empty()) given.emplace_back("--step", options.step);
  if (!options.steps.empty()) given.emplace_back("--steps", options.steps);
  if (!options.tolerance.empty()) given.emplace_back("--tolerance", options.tolerance);
  if (given.empty()) refuse_missing("--steps", kAccepted);
  if (given.size() > 1) {
    refuse(
        given[1].first, given[1].second, std::string("given besides ") + given[0].first, kAccepted);
  }
  if (!options.step.empty()) {
    const double step = parse_positive("--step", options.step);
    if (!(request.time / step <= static_cast<double>(kMostSteps))) {
      refuse(
          "--step", options.step, "too short", fmt::format("--time / {}", kMostSteps) + " or more");
    }
    request.plan = StepPlan::of_length(request.start_time, request.time, step);
  } else if (!options.steps.empty()) {
    const long count = parse_integer("--steps", options.steps, 1, kMostSteps);
    request.plan = StepPlan::equal(request.start_time, request.time, count);
  } else {
    request.tolerance = parse_tolerance("--tolerance", options.tolerance);
  }
  if (options.stage_tolerance.empty()) return;
  const double stop = parse_tolerance("--stage-tolerance", options.stage_tolerance);
  if (!request.plan) {
    refuse("--stage-tolerance",
           options.stage_tolerance,
           "given besides --tolerance, which chooses it",
           "--stage-tolerance with --step or --steps only");
  }
  request.plan->stop = stop;
}

}  // namespace

FlowRequest check(const FlowOptions& options) { return check(options, check(options.run)); }

FlowRequest check(const FlowOptions& options, Run run) {
  FlowRequest request;
  request.run = std::move(run);
  const SceneEntry& entry = *request.run.entry;
  const auto names = coordinate_names(entry);
  if (options.from.empty()) refuse_missing("--from", vector_accepted(names));
  request.z = parse_vector("--from", options.from, names);
  request.start_time = parse_real("--start-time", options.start_time);
  const auto p = parse_momentum(options, request);
  request.z.insert(request.z.end(), p.begin(), p.end());
  check_manifold(options, request);
  choose_branch(options, request);
  if (options.time.empty()) refuse_missing("--time", "a finite number > 0");
  request.time = parse_positive("--time", options.time);
  if (!std::isfinite(request.start_time + request.time)) {
    refuse("--time", options.time, "it ends at infinity", "--start-time + --time finite");
  }
  parse_steps(options, request);
  const double least = request.plan ? request.plan->step : request.time;
  if (request.start_time + least == request.start_time) {
    refuse("--start-time",
           options.start_time,
           "no time passes: a step is less than its round-off",
           "a start time nearer to zero, or larger steps");
  }
  request.tangent = options.tangent;
  return request;
}

}  // namespace carnot::apps
