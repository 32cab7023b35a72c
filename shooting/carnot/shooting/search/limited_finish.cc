#include "carnot/shooting/search/limited_finish.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/shoot/bound_survey.h"
#include "carnot/shooting/shoot/contacts.h"
#include "carnot/shooting/shoot/multiple_shooting.h"
#include "carnot/shooting/shoot/survey.h"

namespace carnot::internal {
namespace {

constexpr long kFreeSteps = 32;  // of a flow without contact

// Of the flows along a piece, at least. Flows along a light steering axle magnify, so that they
// have to be short. A car (wheelbase 2.7, angle of the steering at most 0.6) to 16 random targets:
// where the steering has an inertia of 0.001, 4 answers are joined with 8 segments and all with 32;
// where it has 0.0001, 1 with 8, 2 with 32, and 14 with 96 or 128.
//
// But where a grid is too coarse to tell the contacts, no number joins the pieces, and to find that
// out with 96 takes half a second. So each grid tries one number more than the one before. If all
// are tried on each, 48 searches for a vehicle whose steering has an inertia of 0.01 take 1.3 times
// as long, and 220 for vehicle, trailer1 and unicycle with ordinary masses, too, with the same
// answers.
constexpr std::array kSegmentCounts{8, 32, 96};

// mu on grids of 2, 4, ... times the first one. Contacts are told from the second of them in nearly
// all cases.
constexpr std::array kBarriers{3e-4, 1e-4, 1e-5, 1e-7};
static_assert(kBarriers.size() == kSegmentCounts.size() + 1);

}  // namespace

bool LimitedFinish::sharpen(Candidate& candidate, double last_mu) const {
  return solve(candidate.limited, last_mu, candidate);
}

bool LimitedFinish::refine(Candidate& candidate, double last_mu) const {
  const LimitedPath& coarse = candidate.limited;
  const int m = shared_.walls.size();
  LimitedPath fine;
  fine.path = halved(coarse.path);
  for (int node = 0; node <= fine.path.intervals; ++node) {
    for (int w = 0; w < m; ++w) {
      const std::size_t a = static_cast<std::size_t>(node / 2) * m + w;
      const std::size_t b = static_cast<std::size_t>((node + 1) / 2) * m + w;
      fine.sigma.push_back(0.5 * (coarse.sigma[a] + coarse.sigma[b]));
      fine.nu.push_back(0.5 * (coarse.nu[a] + coarse.nu[b]));
    }
  }
  if (!solve(std::move(fine), last_mu, candidate)) return false;
  ++candidate.halvings;
  return true;
}

bool LimitedFinish::solve(LimitedPath near, double last_mu, Candidate& candidate) const {
  const BoundaryValueProblem& problem = shared_.ladder.on(near.path.rung);
  InteriorPointOptions options = shared_.interior;
  options.first_mu = candidate.mu;
  options.last_mu = last_mu;
  const InteriorPoint solved = interior_point(problem, shared_.walls, options, near);
  if (!solved.converged) return false;
  candidate.limited = std::move(near);
  candidate.minimum = solved.minimum;
  candidate.mu = last_mu;
  const double h = problem.time / candidate.limited.path.intervals;
  candidate.action = discrete_action(problem.dynamics, h, candidate.limited.path);
  return true;
}

void LimitedFinish::add_extremes(const std::vector<std::vector<double>>& q,
                                 Geodesic& geodesic) const {
  for (const Extreme& extreme : shared_.problem.dynamics.info.extremes) {
    double largest = 0;
    for (const auto& at : q) largest = std::max(largest, std::abs(extreme.value(at.data())));
    geodesic.extremes.emplace_back(extreme.name, largest);
  }
}

std::optional<LimitedExtremal> LimitedFinish::without_contact(Knots knots) const {
  ShootingOptions shooting;
  shooting.steps = kFreeSteps;
  if (!shoot(shared_.unlimited, shooting, knots).converged) return std::nullopt;
  return by_flow(std::move(knots));
}

// Without any contact: an extremal of the problem without limits.
std::optional<LimitedExtremal> LimitedFinish::by_flow(Knots knots) const {
  constexpr int kDense = 2048;
  Outcome verified = verify(shared_.unlimited, std::move(knots), kFreeSteps, options_.tolerance);
  if (!verified.extremal) return std::nullopt;
  complete(shared_.unlimited, options_.samples, *verified.extremal);
  Geodesic geodesic = std::move(verified.extremal->geodesic);
  const Knots& found = verified.extremal->knots;
  shared_.report_limits(samples_of(shared_.unlimited, found, geodesic.plan.count, kDense + 1).q,
                        geodesic);
  if (!shared_.keeps_to_limits(geodesic)) return std::nullopt;
  return LimitedExtremal{std::move(geodesic), std::nullopt};
}

std::optional<LimitedExtremal> LimitedFinish::with_contacts_of(const BoundExtremal& near) const {
  constexpr int kDense = 2048;
  constexpr long kMostSteps = 4096;
  constexpr double kPull = -1e-6;  // of the multiplier's unit: the wall pulls
  const int n = shared_.problem.dynamics.dof;
  BoundExtremal solved = near;
  std::vector<double> dense;
  for (int i = 0; i <= kDense; ++i) dense.push_back(shared_.problem.time * i / kDense);
  BoundSurvey measured;
  long steps = 64;
  bool settled = false;
  for (; steps <= kMostSteps && !settled; steps *= 2) {
    if (!join_pieces(shared_.problem, shared_.walls, steps, solved)) return std::nullopt;
    measured = survey_pieces(shared_.problem, shared_.walls, solved, 2 * steps, dense);
    settled = measured.completed && measured.defect <= 0.1 * options_.tolerance;
  }
  if (!measured.completed || !(measured.defect <= options_.tolerance)) return std::nullopt;
  Geodesic geodesic;
  std::vector<std::vector<double>> points = measured.summary.trajectory.q;
  for (const Piece& piece : solved.pieces)
    points.emplace_back(piece.z.begin(), piece.z.begin() + n);
  shared_.report_limits(points, geodesic);
  if (!shared_.keeps_to_limits(geodesic)) return std::nullopt;
  double start = 0;
  for (std::size_t k = 0; k < solved.pieces.size(); ++k) {
    const Piece& piece = solved.pieces[k];
    const int wall = piece.leaves();
    if (wall >= 0) {
      const double unit = shared_.interior.rate / shared_.interior.sizes[wall];
      const double impulse = kPull * unit * shared_.problem.time;
      if (!(measured.least_multiplier[k] >= kPull * unit) || piece.release < impulse ||
          !(measured.stop >= impulse)) {
        return std::nullopt;
      }
      LimitReport& limit = geodesic.limits[shared_.walls[wall].limit];
      limit.active.emplace_back(piece.wall >= 0 ? start : piece.end, piece.end);
      limit.largest_multiplier = std::max(limit.largest_multiplier, measured.largest_multiplier[k]);
    }
    start = piece.end;
  }
  const std::vector<double>& z = solved.pieces.front().z;
  geodesic.from.assign(z.begin(), z.begin() + n);
  geodesic.p0.assign(z.begin() + n, z.begin() + 2 * n);
  geodesic.to = shared_.problem.to;
  for (int j = 0; j < n; ++j) {
    if (shared_.problem.is_free_to(j)) geodesic.to[j] = measured.end[j];
  }
  geodesic.transversality_error = transversality_error(shared_.problem, measured.end.data());
  geodesic.lambda0.assign(shared_.problem.dynamics.multipliers, 0.0);
  std::vector<double> velocity(n);
  shared_.problem.dynamics.evaluate(0, geodesic.from, geodesic.p0, velocity, geodesic.lambda0);
  geodesic.verification = Verification::kKnots;
  geodesic.knot_defect = measured.defect;
  geodesic.action = measured.summary.action;
  if (std::isfinite(measured.summary.length)) geodesic.length = measured.summary.length;
  geodesic.constraint_error = measured.summary.constraint_error;
  geodesic.energy_drift = measured.summary.energy_drift;
  geodesic.plan = StepPlan::equal(0, shared_.problem.time, steps);
  add_extremes(measured.summary.trajectory.q, geodesic);
  if (options_.samples > 0) {
    geodesic.trajectory = survey_pieces(shared_.problem,
                                        shared_.walls,
                                        solved,
                                        steps,
                                        sample_times(geodesic.plan, options_.samples))
                              .summary.trajectory;
  }
  return LimitedExtremal{std::move(geodesic), std::move(solved)};
}

std::optional<LimitedExtremal> LimitedFinish::joined(const Candidate& candidate, int level) const {
  constexpr std::array kKinds{
      Contacts::kByOrder, Contacts::kArcs, Contacts::kTouches, Contacts::kPairs};
  for (const int segments : std::span(kSegmentCounts).first(level)) {
    for (const Contacts as : kKinds) {
      const auto pieces = pieces_of(
          shared_.problem, shared_.walls, shared_.interior, candidate.limited, as, segments);
      if (!pieces) continue;
      if (pieces->pieces.size() == 1) {
        const Piece& piece = pieces->pieces.front();
        Knots knots{piece.segments, shared_.problem.dynamics.dof, piece.z};
        knots.z.resize(knots.z.size() + 2 * knots.dof);
        return by_flow(std::move(knots));
      }
      if (auto found = with_contacts_of(*pieces)) {
        if (candidate.minimum) found->geodesic.label = Label::kLocallyMinimal;
        return found;
      }
    }
  }
  return std::nullopt;
}

// The nodes as they are; samples between them by straight lines.
Geodesic LimitedFinish::on_grid(const Candidate& candidate, double coarse_action) const {
  const Path& path = candidate.limited.path;
  const Dynamics& dynamics = shared_.problem.dynamics;
  const int n = path.dof;
  const int m = shared_.walls.size();
  const double h = shared_.problem.time / path.intervals;
  Geodesic geodesic;
  geodesic.verification = Verification::kGrid;
  geodesic.from.assign(path.configuration(0), path.configuration(1));
  geodesic.to.assign(path.configuration(path.intervals), path.configuration(path.intervals) + n);
  geodesic.p0.assign(path.momentum(0), path.momentum(0) + n);
  std::vector<double> end = geodesic.to;
  end.insert(end.end(), path.momentum(path.intervals), path.momentum(path.intervals) + n);
  // A free end that is stopped by a wall has the momentum of its multiplier.
  std::vector<double> s(m);
  std::vector<double> gradients(static_cast<std::size_t>(m) * n);
  shared_.walls.evaluate(end.data(), s.data(), gradients.data(), nullptr);
  for (int w = 0; w < m; ++w) {
    const std::size_t last = static_cast<std::size_t>(path.intervals) * m + w;
    for (int j = 0; j < n; ++j) end[n + j] -= h * candidate.limited.nu[last] * gradients[w * n + j];
  }
  geodesic.transversality_error = transversality_error(shared_.problem, end.data());
  // The error of the midpoint rule is a quarter of that on the grid before.
  geodesic.action = candidate.action + (candidate.action - coarse_action) / 3;
  geodesic.grid_error = std::abs(candidate.action - coarse_action) / 3;
  std::vector<double> velocity(n), lambda(dynamics.multipliers);
  dynamics.evaluate(0, geodesic.from, geodesic.p0, velocity, lambda);
  geodesic.lambda0 = lambda;
  std::vector<std::vector<double>> nodes;
  for (int i = 0; i <= path.intervals; ++i) {
    nodes.emplace_back(path.configuration(i), path.configuration(i) + n);
  }
  shared_.report_limits(points_along(path), geodesic);
  for (int w = 0; w < m; ++w) {
    LimitReport& limit = geodesic.limits[shared_.walls[w].limit];
    int last = -2;  // the last node where the path was on this wall
    for (int i = 0; i <= path.intervals; ++i) {
      const std::size_t at = static_cast<std::size_t>(i) * m + w;
      const double nu = candidate.limited.nu[at];
      const double size = shared_.interior.sizes[w];
      limit.largest_multiplier = std::max(limit.largest_multiplier, nu);
      if (!(nu * size / shared_.interior.rate > candidate.limited.sigma[at] / size)) continue;
      if (last == i - 1) {
        limit.active.back().second = i * h;
      } else {
        limit.active.emplace_back(i * h, i * h);
      }
      last = i;
    }
  }
  for (LimitReport& limit : geodesic.limits) std::sort(limit.active.begin(), limit.active.end());
  const StepPlan plan = StepPlan::equal(0, shared_.problem.time, path.intervals);
  geodesic.plan = plan;
  double length = 0;
  for (const double t : sample_times(plan, options_.samples)) {
    const double place = std::min(t / h, static_cast<double>(path.intervals) - 1e-9);
    const int i = static_cast<int>(place);
    const double share = place - i;
    std::vector<double> q(n), p(n);
    for (int j = 0; j < n; ++j) {
      q[j] = (1 - share) * path.configuration(i)[j] + share * path.configuration(i + 1)[j];
      p[j] = (1 - share) * path.momentum(i)[j] + share * path.momentum(i + 1)[j];
    }
    geodesic.trajectory.t.push_back(t);
    geodesic.trajectory.hamiltonian.push_back(
        dynamics.evaluate(t, q, p, velocity, lambda).hamiltonian);
    geodesic.trajectory.q.push_back(std::move(q));
    geodesic.trajectory.p.push_back(std::move(p));
    geodesic.trajectory.lambda.push_back(lambda);
  }
  if (dynamics.has_transcription()) {
    std::vector<double> terms(n + dynamics.transcribed + 1), middle(n);
    bool potential = false;
    for (int i = 0; i < path.intervals; ++i) {
      double square = 0;
      for (int j = 0; j < n; ++j) {
        middle[j] = 0.5 * (nodes[i][j] + nodes[i + 1][j]);
        velocity[j] = (nodes[i + 1][j] - nodes[i][j]) / h;
      }
      if (!dynamics.midpoint(middle, velocity, terms)) continue;
      potential = potential || terms.back() != 0;
      for (int j = 0; j < n; ++j) square += terms[j] * terms[j];
      length += h * std::sqrt(square);
    }
    if (!potential) geodesic.length = length;
  }
  if (candidate.minimum) geodesic.label = Label::kLocallyMinimal;
  add_extremes(nodes, geodesic);
  return geodesic;
}

std::optional<LimitedExtremal> LimitedFinish::finish(Candidate candidate, const Stop& stop) const {
  constexpr double kBeyondOnGrid = 1e-4;  // between two nodes
  // What came down the ladder of masses is on a finer grid already, and is refined for the error of
  // the last one only. If it is refined for each mu, searches with light steering take 1.1 times as
  // long.
  const std::size_t fine =
      std::min(static_cast<std::size_t>(candidate.halvings), kBarriers.size() - 1);
  Candidate coarse;
  for (std::size_t level = 0; level < kBarriers.size(); ++level) {
    coarse = candidate;
    if (stop.reached() && stop.asked()) return std::nullopt;
    const bool solved =
        level < fine ? sharpen(candidate, kBarriers[level]) : refine(candidate, kBarriers[level]);
    if (!solved) return std::nullopt;
    if (level == 0) continue;
    if (auto found = joined(candidate, static_cast<int>(level))) return found;
  }
  if (!settle(coarse) || !settle(candidate)) return std::nullopt;
  Geodesic geodesic = on_grid(candidate, coarse.action);
  if (!shared_.keeps_to_limits(geodesic, kBeyondOnGrid)) return std::nullopt;
  return LimitedExtremal{std::move(geodesic), std::nullopt};
}

// With the least mu, on the same grid. Between nodes the straight line may be beyond a wall by the
// square of an interval; then the walls are moved by that much.
bool LimitedFinish::settle(Candidate& candidate) const {
  constexpr double kLeastMu = 1e-9;
  constexpr double kMargin = 1.5;
  constexpr int kRounds = 3;
  InteriorPointOptions options = shared_.interior;
  options.last_mu = kLeastMu;
  std::vector<Limit> limits = shared_.problem.limits;
  for (int round = 0; round < kRounds; ++round) {
    options.first_mu = std::max(candidate.mu, kLeastMu);
    const Walls walls(limits, shared_.problem.dynamics.dof);
    const InteriorPoint solved = interior_point(shared_.problem, walls, options, candidate.limited);
    if (!solved.converged) return false;
    candidate.minimum = solved.minimum;
    candidate.mu = kLeastMu;
    Geodesic judged;
    shared_.report_limits(points_along(candidate.limited.path), judged);
    if (!(judged.limit_violation > 0)) break;
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const double beyond = std::max(0.0, -judged.limits[i].lowest_slack);
      limits[i].lower += kMargin * beyond;
      limits[i].upper -= kMargin * beyond;
    }
  }
  candidate.action = discrete_action(shared_.problem.dynamics,
                                     shared_.problem.time / candidate.limited.path.intervals,
                                     candidate.limited.path);
  return true;
}

// The nodes of a path, and points of the straight lines between them: a path could step over a
// wall.
std::vector<std::vector<double>> LimitedFinish::points_along(const Path& path) {
  constexpr int kBetween = 4;
  std::vector<std::vector<double>> points;
  for (int i = 0; i < path.intervals; ++i) {
    for (int part = 0; part < kBetween; ++part) {
      const double share = static_cast<double>(part) / kBetween;
      points.emplace_back(path.configuration(i), path.configuration(i + 1));
      for (int j = 0; j < path.dof; ++j) {
        points.back()[j] += share * (path.configuration(i + 1)[j] - path.configuration(i)[j]);
      }
    }
  }
  points.emplace_back(path.configuration(path.intervals),
                      path.configuration(path.intervals) + path.dof);
  return points;
}

}  // namespace carnot::internal
