#include "benchmark/benchmark_direct.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "benchmark/benchmark_clock.h"
#include "carnot/load_scene.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/search/starts.h"
#include "carnot/system/system_functions.h"
#include "catalogue/scene_choice.h"
#include "catalogue/scene_texts.h"
#include "catalogue/text_entry.h"
#include "run/geodesic_text.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr int kBlindIntervals = 64;
constexpr double kSameOnGrid = 0.01;  // what the error of that grid may explain

// How far the points of a path are beyond a limit, at nodes and between them.
double violation_of(const BoundaryValueProblem& problem, const std::vector<double>& q) {
  constexpr int kBetween = 4;
  const int n = problem.dynamics.dof;
  const int intervals = static_cast<int>(q.size()) / n - 1;
  double violation = 0;
  std::vector<double> at(n);
  for (int i = 0; i <= intervals * kBetween; ++i) {
    const int node = std::min(i / kBetween, intervals - 1);
    const double share = static_cast<double>(i - node * kBetween) / kBetween;
    for (int j = 0; j < n; ++j) {
      at[j] = (1 - share) * q[node * n + j] + share * q[(node + 1) * n + j];
    }
    for (const Limit& limit : problem.limits) {
      violation = std::max(violation, -limit.slack(limit.value(at.data(), nullptr, nullptr)));
    }
  }
  return violation;
}

int controls_of(const Dynamics& dynamics) {
  return dynamics.has_transcription() ? 0 : dynamics.functions->algebraic;
}

// What a trajectory has at the nodes of a grid, with the controls at the beginning of each
// interval.
GridPath path_of(const Dynamics& dynamics, const Trajectory& trajectory, int intervals) {
  const std::size_t every = (trajectory.q.size() - 1) / intervals;
  GridPath path;
  std::vector<double> y(static_cast<std::size_t>(controls_of(dynamics)), 0.0);
  std::vector<double> rate(static_cast<std::size_t>(2 * dynamics.dof));
  for (std::size_t i = 0; i < trajectory.q.size(); i += every) {
    path.q.insert(path.q.end(), trajectory.q[i].begin(), trajectory.q[i].end());
    if (y.empty() || i + every >= trajectory.q.size()) continue;
    std::vector<double> z = trajectory.q[i];
    z.insert(z.end(), trajectory.p[i].begin(), trajectory.p[i].end());
    (void)dynamics.functions->rate(
        dynamics.system.get(), trajectory.t[i], z.data(), y.data(), rate.data());
    path.u.insert(path.u.end(), y.begin(), y.end());
  }
  return path;
}

// Start number i on the coarse grid. With drift: at rest between the ends on a straight line, from
// the second one on with waves of the length of the way.
GridPath blind_path(const BoundaryValueProblem& problem, std::uint64_t seed, int i) {
  const int n = problem.dynamics.dof;
  const int m = controls_of(problem.dynamics);
  if (m == 0) return {internal::make_start(problem, seed, i, kBlindIntervals).path.q, {}};
  std::seed_seq sequence{seed, static_cast<std::uint64_t>(i)};
  std::mt19937_64 generator(sequence);
  std::normal_distribution<double> normal;
  double way = 0;
  for (int j = 0; j < n; ++j) way += std::pow(problem.to[j] - problem.from[j], 2);
  const double size = i == 0 ? 0 : std::sqrt(way);
  GridPath path;
  path.u.assign(std::size_t{kBlindIntervals} * m, 0.0);
  path.q.resize((std::size_t{kBlindIntervals} + 1) * n);
  for (int j = 0; j < n; ++j) {
    const double first = size * normal(generator);
    const double second = size * normal(generator);
    for (int node = 0; node <= kBlindIntervals; ++node) {
      const double s = static_cast<double>(node) / kBlindIntervals;
      path.q[node * n + j] = (1 - s) * problem.from[j] + s * problem.to[j] +
                             first * std::sin(std::numbers::pi * s) +
                             second * std::sin(2 * std::numbers::pi * s);
    }
  }
  return path;
}

OwnAnswer answer_of(const GeodesicReport& report, double seconds) {
  OwnAnswer answer;
  answer.seconds = seconds;
  answer.solved = !report.geodesics.empty();
  if (!answer.solved) return answer;
  const Geodesic& best = report.geodesics.front();
  answer.action = best.action;
  answer.violation = best.limit_violation;
  answer.verification = name_of(best.verification);
  answer.label = name_of(best.label);
  for (const LimitReport& limit : best.limits) {
    answer.contacts += static_cast<int>(limit.active.size());
  }
  return answer;
}

// Blind starts, the straight line first.
void try_blindly(const BoundaryValueProblem& problem,
                 const DirectOptions& options,
                 const DirectSolver& solver,
                 double known,
                 DirectAnswer& answer) {
  answer.starts = options.quick ? 2 : 16;
  const double began = thread_seconds();
  for (int i = 0; i < answer.starts; ++i) {
    GridPath path = blind_path(problem, options.seed, i);
    const std::optional<double> action = solver.solve(problem, path);
    if (!action) continue;
    ++answer.solved;
    if (*action <= known * (1 + kSameOnGrid)) ++answer.least_found;
  }
  answer.seconds_per_start = (thread_seconds() - began) / answer.starts;
}

// The limit of the actions on grids of which each halves the interval of the one before.
void refine(const BoundaryValueProblem& problem,
            const Trajectory& trajectory,
            const std::vector<int>& grids,
            const DirectSolver& solver,
            DirectAnswer& answer) {
  std::vector<double> actions;
  for (const int intervals : grids) {
    GridPath path = path_of(problem.dynamics, trajectory, intervals);
    const double began = thread_seconds();
    const std::optional<double> action = solver.solve(problem, path);
    if (!action) return;
    actions.push_back(*action);
    answer.seconds = thread_seconds() - began;
    answer.violation = violation_of(problem, path.q);
  }
  const auto extrapolated = [&](std::size_t i) {
    return actions[i] + (actions[i] - actions[i - 1]) / 3;
  };
  const std::size_t last = actions.size() - 1;
  answer.action = extrapolated(last);
  answer.action_error = std::abs(extrapolated(last) - extrapolated(last - 1));
}

BoundaryValueProblem problem_of(const DirectProblem& entry) {
  if (entry.drift) {
    const auto& texts = drift_texts();
    const auto found = std::find_if(
        texts.begin(), texts.end(), [&](const SceneText& t) { return t.name == entry.scene; });
    return {
        make_dynamics(scene_from_text(std::string(found->text))), entry.from, entry.to, entry.time};
  }
  const SceneEntry& scene = find_scene(entry.scene);
  const ParameterValues parameters = parse_parameters(scene, {});
  BoundaryValueProblem problem(
      dynamics_of_text(scene, parameters), entry.from, entry.to, entry.time);
  problem.limits = choose_limits(scene, parameters, entry.asked);
  return problem;
}

}  // namespace

const std::vector<DirectProblem>& limits_problems() {
  static const std::vector<DirectProblem> kProblems{
      {"a wheel that turns by 0.3",
       "vehicle",
       {0, 0, 0, 0},
       {0, 1, 0, 0},
       {{"phi-theta in -0.3:0.3"}, {}}},
      {"a hinge that turns by 0.5",
       "trailer1",
       {0, 0, 0, 0},
       {0, 1, 0, 0},
       {{"t0-t1 in -0.5:0.5"}, {}}},
      {"a heading that turns by 0.5",
       "unicycle",
       {0, 0, 0},
       {0, 1, 0},
       {{"theta in -0.5:0.5"}, {}}},
      {"a disc across the way", "unicycle", {0, 0, 0}, {2, 0, 0.3}, {{}, {"1,0.1,0.3"}}},
      {"a slot between two discs",
       "vehicle",
       {2.5, 0, 0, 0},
       {0, 1.3, 0, 0},
       {{"phi-theta in -0.6:0.6"}, {"1,1.3,0.7", "-2,1.3,0.7"}}}};
  return kProblems;
}

const std::vector<DirectProblem>& drift_problems() {
  constexpr double kPi = std::numbers::pi;
  static const double kSlow = std::sqrt(1 / 1.5);  // on the circle of radius 1.5
  static const std::vector<DirectProblem> kProblems{
      {"to a larger circle", "kepler-transfer", {1, 0, 0, 1}, {-1.5, 0, 0, -kSlow}, {}, 20, true},
      {"an oscillator to rest", "van-der-pol", {1, 0}, {0, 0}, {}, 30, true},
      {"a pendulum swings up", "pendulum-swing-up", {0, 0}, {kPi, 0}, {}, 8, true},
      {"a cart swings its pole up", "cart-pole", {0, 0, 0, 0}, {0, kPi, 0, 0}, {}, 2, true},
      {"a quadrotor turns over",
       "planar-quadrotor",
       {0, 0, 0, 0, 0, 0},
       {0, 0, 2 * kPi, 0, 0, 0},
       {},
       5,
       true},
      {"a ship across a vortex", "vortex", {2, 0}, {-2, 0}, {}, 6, true},
      {"linear and quadratic", "regulator", {1, 0}, {0, 0}, {}, 10, true}};
  return kProblems;
}

std::optional<std::vector<DirectRow>> run_direct_benchmark(
    const std::vector<DirectProblem>& problems,
    const DirectOptions& options,
    const std::optional<DirectSolver>& direct,
    const Progress& progress) {
  const bool drift = !problems.empty() && problems.front().drift;
  const int coarsest = options.quick ? 64 : drift ? 512 : 1024;
  const std::vector<int> grids{coarsest, 2 * coarsest, 4 * coarsest};
  std::vector<DirectRow> rows;
  for (const DirectProblem& entry : problems) {
    const auto done = static_cast<double>(rows.size());
    if (progress && !progress(done / static_cast<double>(problems.size()))) return std::nullopt;
    const BoundaryValueProblem problem = problem_of(entry);
    GeodesicOptions search;
    search.seed = options.seed;
    search.threads = 1;
    search.samples = grids.back() + 1;
    const double began = thread_seconds();
    const GeodesicReport report = find_geodesics(problem, search);
    DirectRow row{entry, answer_of(report, thread_seconds() - began), {}};
    if (direct && row.own.solved) {
      DirectAnswer answer;
      answer.solver = direct->name;
      try_blindly(problem, options, *direct, row.own.action, answer);
      refine(problem, report.geodesics.front().trajectory, grids, *direct, answer);
      row.direct = std::move(answer);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace carnot::apps
