#include "benchmark/benchmark_limits.h"

#include <algorithm>
#include <cmath>

#include "benchmark/benchmark_clock.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/search/starts.h"
#include "catalogue/scene_choice.h"
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

std::vector<double> nodes_of(const Trajectory& trajectory, int intervals) {
  const std::size_t every = (trajectory.q.size() - 1) / intervals;
  std::vector<double> q;
  for (std::size_t i = 0; i < trajectory.q.size(); i += every) {
    q.insert(q.end(), trajectory.q[i].begin(), trajectory.q[i].end());
  }
  return q;
}

LimitsAnswer answer_of(const GeodesicReport& report, double seconds) {
  LimitsAnswer answer;
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
                 const LimitsOptions& options,
                 const DirectSolver& solver,
                 double known,
                 DirectAnswer& answer) {
  answer.starts = options.quick ? 2 : 16;
  const double began = thread_seconds();
  for (int i = 0; i < answer.starts; ++i) {
    std::vector<double> q = internal::make_start(problem, options.seed, i, kBlindIntervals).path.q;
    const std::optional<double> action = solver.solve(problem, q);
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
    std::vector<double> q = nodes_of(trajectory, intervals);
    const double began = thread_seconds();
    const std::optional<double> action = solver.solve(problem, q);
    if (!action) return;
    actions.push_back(*action);
    answer.seconds = thread_seconds() - began;
    answer.violation = violation_of(problem, q);
  }
  const auto extrapolated = [&](std::size_t i) {
    return actions[i] + (actions[i] - actions[i - 1]) / 3;
  };
  const std::size_t last = actions.size() - 1;
  answer.action = extrapolated(last);
  answer.action_error = std::abs(extrapolated(last) - extrapolated(last - 1));
}

}  // namespace

const std::vector<LimitsProblem>& limits_problems() {
  static const std::vector<LimitsProblem> kProblems{
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

std::optional<std::vector<LimitsRow>> run_limits_benchmark(
    const LimitsOptions& options,
    const std::optional<DirectSolver>& direct,
    const Progress& progress) {
  const std::vector<int> grids =
      options.quick ? std::vector<int>{64, 128, 256} : std::vector<int>{1024, 2048, 4096};
  std::vector<LimitsRow> rows;
  for (const LimitsProblem& entry : limits_problems()) {
    const double done = static_cast<double>(rows.size());
    if (progress && !progress(done / static_cast<double>(limits_problems().size()))) {
      return std::nullopt;
    }
    const SceneEntry& scene = find_scene(entry.scene);
    const ParameterValues parameters = parse_parameters(scene, {});
    BoundaryValueProblem problem(dynamics_of_text(scene, parameters), entry.from, entry.to);
    problem.limits = choose_limits(scene, parameters, entry.asked);
    GeodesicOptions search;
    search.seed = options.seed;
    search.threads = 1;
    search.samples = grids.back() + 1;
    const double began = thread_seconds();
    const GeodesicReport report = find_geodesics(problem, search);
    LimitsRow row{entry, answer_of(report, thread_seconds() - began), {}};
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
