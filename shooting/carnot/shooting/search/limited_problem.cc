#include "carnot/shooting/search/limited_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "carnot/numerics/scalar.h"
#include "carnot/shooting/path/path_lagrangian.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/shoot/knots.h"
#include "carnot/shooting/shoot/survey.h"

namespace carnot::internal {

LimitedProblem::LimitedProblem(const BoundaryValueProblem& limited,
                               const std::vector<Geodesic>& free)
    : problem(limited),
      unlimited(limited),
      ladder(limited),
      walls(limited.limits, limited.dynamics.dof) {
  unlimited.limits.clear();
  set_sizes(free);
}

// A wall is as large as its limit is wide. Where it is open on one side, it is as large as the
// straight line and the best path without limits are beyond it or, where they are not, away from
// it.
void LimitedProblem::set_sizes(const std::vector<Geodesic>& free) {
  constexpr int kSamples = 32;
  const int n = problem.dynamics.dof;
  std::vector<std::vector<double>> points;
  for (int i = 0; i <= kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples;
    points.emplace_back();
    for (int j = 0; j < n; ++j) {
      points.back().push_back((1 - s) * problem.from[j] + s * problem.to[j]);
    }
  }
  double action = 0;
  if (free.empty()) {
    const double distance = distance_between_ends(problem);
    action = 0.5 * distance * distance / problem.time;
  } else {
    action = free.front().action;
    const auto path = path_along(free.front(), kSamples);
    for (int i = 0; path && i <= kSamples; ++i) {
      points.emplace_back(path->configuration(i), path->configuration(i) + n);
    }
  }
  std::vector<double> s(walls.size());
  std::vector<double> beyond(walls.size(), 0.0);
  interior.sizes.assign(walls.size(), 0.0);
  for (const auto& q : points) {
    walls.evaluate(q.data(), s.data(), nullptr, nullptr);
    for (int w = 0; w < walls.size(); ++w) {
      beyond[w] = std::max(beyond[w], -s[w]);
      interior.sizes[w] = std::max(interior.sizes[w], std::abs(s[w]));
    }
  }
  for (int w = 0; w < walls.size(); ++w) {
    const Limit& limit = problem.limits[walls[w].limit];
    const double half = 0.5 * (limit.upper - limit.lower);
    double& size = interior.sizes[w];
    if (beyond[w] > 0) size = beyond[w];
    if (std::isfinite(half)) size = half;
    if (!(size > 0)) size = 1;
  }
  interior.rate = action > 0 ? action / problem.time : 1;
}

bool LimitedProblem::keeps_to_limits(const Geodesic& geodesic, double beyond) const {
  for (int w = 0; w < walls.size(); ++w) {
    const LimitReport& limit = geodesic.limits[walls[w].limit];
    if (!(limit.lowest_slack >= -beyond * interior.sizes[w])) return false;
  }
  return true;
}

std::optional<Geodesic> LimitedProblem::within(const Geodesic& geodesic) const {
  // Most are far beyond a limit, which few samples tell. Many take a tenth of a search.
  constexpr std::array kSamples{65, 2049};
  Geodesic judged = geodesic;
  if (geodesic.verification != Verification::kSingle) {
    report_limits(geodesic.trajectory.q, judged);
    return keeps_to_limits(judged) ? std::optional(std::move(judged)) : std::nullopt;
  }
  std::vector<double> z = geodesic.from;
  z.insert(z.end(), geodesic.p0.begin(), geodesic.p0.end());
  const Knots knots = knots_of(unlimited, start_unknowns(unlimited, z.data()), 1, 1);
  for (const int samples : kSamples) {
    report_limits(samples_of(unlimited, knots, geodesic.plan.count, samples).q, judged);
    if (!keeps_to_limits(judged)) return std::nullopt;
  }
  return judged;
}

std::optional<Path> LimitedProblem::path_along(const Geodesic& geodesic, int intervals) const {
  std::vector<double> z = geodesic.from;
  z.insert(z.end(), geodesic.p0.begin(), geodesic.p0.end());
  const long steps = std::max<long>(intervals, geodesic.plan.count);
  const Knots knots = knots_of(unlimited, start_unknowns(unlimited, z.data()), intervals, steps);
  const double unit = length_per_momentum(problem, geodesic.p0.data());
  constexpr double kNear = 1e-3;  // of the distance
  if (!(miss(problem, knots.at(intervals), unit) <= kNear * distance_between_ends(problem))) {
    return std::nullopt;
  }
  return path_through(knots);
}

Path LimitedProblem::path_through(const Knots& knots) const {
  const Dynamics& dynamics = problem.dynamics;
  const int n = dynamics.dof;
  const int k = PathLagrangian::multipliers(dynamics);
  const int intervals = knots.segments;
  Path path{intervals, n, {}, std::vector<double>(static_cast<std::size_t>(intervals) * k), {}};
  std::vector<double> middle(2 * n);
  for (int i = 0; i <= intervals; ++i) {
    path.q.insert(path.q.end(), knots.at(i), knots.at(i) + n);
    if (i == intervals) break;
    for (int j = 0; j < 2 * n; ++j) middle[j] = 0.5 * (knots.at(i)[j] + knots.at(i + 1)[j]);
    const std::span<const double> between(middle);
    const auto lambda = std::span(path.lambda).subspan(static_cast<std::size_t>(i) * k, k);
    if (dynamics.has_transcription()) {
      dynamics.midpoint_multipliers(between.first(n), between.subspan(n), lambda);
    } else {
      std::copy(between.begin() + n, between.end(), lambda.begin());
    }
  }
  for (int j = 0; j < n; ++j) {
    if (!problem.is_free_to(j)) path.configuration(intervals)[j] = problem.to[j];
  }
  return path;
}

void LimitedProblem::report_limits(const std::vector<std::vector<double>>& q,
                                   Geodesic& geodesic) const {
  geodesic.limits.clear();
  for (const Limit& limit : problem.limits) {
    LimitReport report;
    report.name = limit.name;
    // What was looked at nowhere keeps to nothing.
    report.lowest_slack = std::numeric_limits<double>::infinity() * (q.empty() ? -1 : 1);
    for (const auto& at : q) {
      const double slack = limit.slack(limit.value(at.data(), nullptr, nullptr));
      report.lowest_slack = minimum(report.lowest_slack, slack);
    }
    geodesic.limit_violation = maximum(geodesic.limit_violation, -report.lowest_slack);
    geodesic.limits.push_back(std::move(report));
  }
}

}  // namespace carnot::internal
