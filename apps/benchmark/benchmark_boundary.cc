#include "benchmark/benchmark_boundary.h"

#include <algorithm>
#include <cmath>

#include "benchmark/benchmark_clock.h"
#include "carnot/numerics/parallel.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/search/momentum_starts.h"
#include "carnot/shooting/search/polish.h"
#include "carnot/shooting/search/starts.h"
#include "carnot/shooting/shoot/multiple_shooting.h"
#include "catalogue/scene_choice.h"
#include "run/random_target.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

using internal::Extremal;
using internal::Knots;
using internal::knots_of;
using internal::make_start;
using internal::momentum_start;
using internal::polish;
using internal::relax;
using internal::shoot;
using internal::ShootingOptions;
using internal::Start;
using internal::tighten;
using internal::verify;

constexpr double kSameAction = 1e-9;          // relative
constexpr double kSameDiscreteAction = 1e-6;  // of solvers that stay on their grid
constexpr double kNearLeast = 0.02;           // what the error of a grid may explain

// Sideways parking, the unicycle's, and a target with other extremals near by.
const std::vector<BoundaryProblemEntry>& problems() {
  static const std::vector<BoundaryProblemEntry> kProblems{
      {"vehicle", {0, 1, 0, 0}, 22.707881803770334},
      {"unicycle", {0, 1, 0}, 5.5790793575820281},
      {"heisenberg-group", {1, 0, 1}, 3.5995927024191192}};
  return kProblems;
}

Dynamics make(const std::string& scene) { return find_scene(scene).make({}, "gauss16"); }

BoundaryValueProblem from_origin(const Dynamics& dynamics, const std::vector<double>& to) {
  return {dynamics, std::vector<double>(to.size(), 0.0), to};
}

BoundaryTrial trial_of(const std::optional<Extremal>& extremal, double began) {
  BoundaryTrial trial;
  trial.solved = extremal.has_value();
  if (trial.solved) trial.action = extremal->geodesic.action;
  trial.seconds = thread_seconds() - began;
  return trial;
}

BoundarySolver from_paths(const std::string& minimiser) {
  const auto run = [minimiser](const BoundaryValueProblem& problem, std::uint64_t seed, int i) {
    const double began = thread_seconds();
    GeodesicOptions options;
    options.minimiser = minimiser;
    Start start = make_start(problem, seed, i + 1);  // 0 is the straight line, for any seed
    std::optional<Extremal> extremal;
    (void)relax(problem, start.relaxation, start.path);
    if (tighten(problem, {}, start.path).converged) {
      extremal = polish(internal::MassLadder(problem), options, start.path).extremal;
    }
    return trial_of(extremal, began);
  };
  return {minimiser, BoundaryStart::kPath, false, true, true, run};
}

BoundarySolver from_momenta(const std::string& minimiser) {
  const auto run = [minimiser](const BoundaryValueProblem& problem, std::uint64_t seed, int i) {
    constexpr int kSegments = 8;
    constexpr long kSteps = 32;
    const double began = thread_seconds();
    ShootingOptions shooting;
    shooting.minimiser = minimiser;
    shooting.near = minimiser != "ceres";
    shooting.steps = kSteps;
    const std::vector<double> p0 = momentum_start(problem, seed, i + 1);
    Knots knots = knots_of(problem, p0, kSegments, kSteps);
    std::optional<Extremal> extremal;
    if (shoot(problem, shooting, knots).converged) {
      extremal = verify(problem, std::move(knots), kSteps, GeodesicOptions{}.tolerance).extremal;
    }
    return trial_of(extremal, began);
  };
  return {minimiser, BoundaryStart::kMomentum, false, true, true, run};
}

std::vector<BoundaryTrial> try_starts(const BoundarySolver& solver,
                                      const BoundaryValueProblem& problem,
                                      const BoundaryOptions& options,
                                      int starts) {
  std::vector<BoundaryTrial> trials(starts);
  const int threads = solver.in_parallel ? thread_count(options.threads) : 1;
  parallel_for(starts, threads, [&](int i) { trials[i] = solver.run(problem, options.seed, i); });
  return trials;
}

double least_of(const std::vector<BoundaryTrial>& trials) {
  double least = std::numeric_limits<double>::infinity();
  for (const BoundaryTrial& trial : trials) {
    if (trial.solved) least = std::min(least, trial.action);
  }
  return least;
}

BoundaryRow row_of(const BoundarySolver& solver,
                   const BoundaryProblemEntry& problem,
                   const std::vector<BoundaryTrial>& trials) {
  BoundaryRow row;
  row.scene = problem.scene;
  row.solver = solver.name;
  row.start = solver.start;
  row.peer = solver.peer;
  row.verified = solver.verified;
  row.starts = static_cast<int>(trials.size());
  const double best = least_of(trials);
  const double error = std::abs(best - problem.least_action) / problem.least_action;
  if (std::isfinite(best)) row.best_action_error = error;
  const bool near = solver.verified || error < kNearLeast;
  const double aim = solver.verified ? problem.least_action : best;
  const double same = solver.verified ? kSameAction : kSameDiscreteAction;
  for (const BoundaryTrial& trial : trials) {
    row.cpu_seconds += trial.seconds;
    if (!trial.solved) continue;
    ++row.solved;
    if (near && trial.action - aim <= same * aim) ++row.least_found;
  }
  return row;
}

void add_to_curve(const std::vector<BoundaryTrial>& trials, std::vector<BoundaryPoint>& points) {
  const double least = least_of(trials);
  double seconds = 0;
  for (const BoundaryTrial& trial : trials) seconds += trial.seconds / kCurveStarts;
  for (BoundaryPoint& point : points) {
    const double best = least_of({trials.begin(), trials.begin() + point.starts});
    ++point.targets;
    point.solved += std::isfinite(best) ? 1 : 0;
    point.least += best <= least * (1 + kSameAction) && std::isfinite(best) ? 1 : 0;
    point.cpu_seconds += (seconds - point.cpu_seconds) / point.targets;
  }
}

// False when stopped.
bool run_curve(const BoundaryOptions& options, const Progress& progress, BoundaryResult& result) {
  const BoundarySolver solver = from_paths(GeodesicOptions{}.minimiser);
  const double all = static_cast<double>(problems().size()) * options.targets;
  double done = 0;
  for (const BoundaryProblemEntry& problem : problems()) {
    const Dynamics dynamics = make(problem.scene);
    std::vector<BoundaryPoint> points;
    for (int starts = 1; starts <= kCurveStarts; starts *= 2) {
      points.push_back({problem.scene, starts, 0, 0, 0, 0});
    }
    for (int i = 0; i < options.targets; ++i) {
      if (progress && !progress(done++ / all)) return false;
      const auto target = from_origin(dynamics, random_target(dynamics, options.seed, i));
      add_to_curve(try_starts(solver, target, options, kCurveStarts), points);
    }
    result.curve.insert(result.curve.end(), points.begin(), points.end());
  }
  return true;
}

}  // namespace

std::vector<BoundarySolver> own_boundary_solvers() {
  std::vector<BoundarySolver> solvers;
  for (const std::string& name : minimisers()) {
    if (name != "nlopt") solvers.push_back(from_paths(name));  // that is nlopt:slsqp
  }
  for (const std::string& name : minimisers()) {
    if (name != "nlopt") solvers.push_back(from_momenta(name));
  }
  return solvers;
}

std::optional<BoundaryResult> run_boundary_benchmark(const BoundaryOptions& options,
                                                     const std::vector<BoundarySolver>& solvers,
                                                     const Progress& progress) {
  constexpr double kTable = 0.5;  // of the work
  const Progress table = part_of(progress, 0, kTable);
  BoundaryResult result;
  const auto all = static_cast<double>(problems().size() * solvers.size());
  double done = 0;
  for (BoundaryProblemEntry problem : problems()) {
    const BoundaryValueProblem joined = from_origin(make(problem.scene), problem.to);
    std::vector<std::vector<BoundaryTrial>> trials;
    for (const BoundarySolver& solver : solvers) {
      if (table && !table(done++ / all)) return std::nullopt;
      trials.push_back(try_starts(solver, joined, options, options.starts));
      if (solver.verified) {
        problem.least_action = std::min(problem.least_action, least_of(trials.back()));
      }
    }
    for (std::size_t i = 0; i < solvers.size(); ++i) {
      result.rows.push_back(row_of(solvers[i], problem, trials[i]));
    }
    result.problems.push_back(problem);
  }
  if (!run_curve(options, part_of(progress, kTable, 1 - kTable), result)) return std::nullopt;
  return result;
}

}  // namespace carnot::apps
