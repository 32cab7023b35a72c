#include "carnot/shooting/search/limited_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/extremal/ranking.h"
#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/path/interior_point.h"
#include "carnot/shooting/path/path_lagrangian.h"
#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/walls.h"
#include "carnot/shooting/search/deadline.h"
#include "carnot/shooting/search/drift_starts.h"
#include "carnot/shooting/search/starts.h"
#include "carnot/shooting/shoot/bound_arcs.h"
#include "carnot/shooting/shoot/survey.h"

namespace carnot::internal {
namespace {

constexpr double kBeyond = 1e-9;  // of the size of a wall, counts as beyond it
// mu on the first grid. A wall that is met at a point pins the path to a node where mu is small,
// and every node is a minimum of its own: with 1e-6 and 64 intervals a vehicle that passes a disc
// had 40 of them. With 1e-3 the wall acts on several nodes.
constexpr double kFirstGridMu = 1e-3;

BoundaryValueProblem without_limits(BoundaryValueProblem problem) {
  problem.limits.clear();
  return problem;
}

// A discrete extremal with limits.
struct Candidate {
  LimitedPath limited;
  double action = std::numeric_limits<double>::infinity();
  double mu = kFirstGridMu;
  int hits = 1;
  bool minimum = false;
  bool tried = false;  // to finish it
};

// Whether two geodesics begin with the same momentum, as far as either is known.
bool same_start(const Geodesic& a, const Geodesic& b) {
  constexpr double kSame = 1e-7;
  double apart = 0;
  double size = 0;
  for (std::size_t j = 0; j < a.p0.size(); ++j) {
    apart = std::max({apart, std::abs(a.p0[j] - b.p0[j]), std::abs(a.from[j] - b.from[j])});
    size = std::max(size, std::abs(a.p0[j]));
  }
  return apart <= kSame * size && std::abs(a.action - b.action) <= kSame * std::abs(a.action);
}

class LimitedSearch {
 public:
  LimitedSearch(const BoundaryValueProblem& problem,
                const GeodesicOptions& options,
                const std::vector<Geodesic>& free);

  LimitedAnswer run();
  // A geodesic without limits that keeps to them anyway, with what they say of it.
  [[nodiscard]] std::optional<Geodesic> within(const Geodesic& geodesic) const;

 private:
  [[nodiscard]] bool keeps_to_limits(const Geodesic& geodesic, double beyond = kBeyond) const;
  void set_sizes();
  [[nodiscard]] std::optional<Path> path_along(const Geodesic& geodesic, int intervals) const;
  void draw_in(Path& path) const;
  [[nodiscard]] std::optional<Path> start(int i) const;
  // Solves on the grid of the path.
  [[nodiscard]] std::optional<Candidate> solve(Path path) const;
  void note(std::optional<Candidate> candidate);
  [[nodiscard]] bool refine(Candidate& candidate, double last_mu) const;
  [[nodiscard]] static std::vector<std::vector<double>> points_along(const Path& path);
  [[nodiscard]] bool settle(Candidate& candidate) const;
  [[nodiscard]] std::optional<Geodesic> finish(Candidate candidate) const;
  [[nodiscard]] std::optional<Geodesic> joined(const Candidate& candidate) const;
  [[nodiscard]] std::optional<Geodesic> by_flow(const BoundExtremal& extremal) const;
  [[nodiscard]] std::optional<Geodesic> by_pieces(const BoundExtremal& extremal,
                                                  const Candidate& candidate) const;
  [[nodiscard]] Geodesic on_grid(const Candidate& candidate, double coarse_action) const;
  void add_extremes(const std::vector<std::vector<double>>& q, Geodesic& geodesic) const;
  // What the points of a path say of each limit.
  void report_limits(const std::vector<std::vector<double>>& q, Geodesic& geodesic) const;
  void finish_candidates(int threads, std::vector<Geodesic>& geodesics);
  [[nodiscard]] bool enough() const;
  [[nodiscard]] std::string infeasible() const;

  const BoundaryValueProblem& problem_;
  BoundaryValueProblem unlimited_;
  GeodesicOptions options_;
  const std::vector<Geodesic>& free_;
  Walls walls_;
  InteriorPointOptions interior_;
  std::optional<DriftStarts> drift_;
  int intervals_ = 64;
  std::vector<Candidate> candidates_;
};

LimitedSearch::LimitedSearch(const BoundaryValueProblem& problem,
                             const GeodesicOptions& options,
                             const std::vector<Geodesic>& free)
    : problem_(problem),
      unlimited_(without_limits(problem)),
      options_(options),
      free_(free),
      walls_(problem.limits, problem.dynamics.dof) {
  if (!problem.dynamics.has_transcription()) {
    drift_.emplace(unlimited_, options.seed);
    intervals_ = std::max(intervals_, drift_->intervals());
  }
  set_sizes();
}

// A wall is as large as its limit is wide. Where it is open on one side, it is as large as the
// straight line and the best path without limits are beyond it or, where they are not, away from
// it.
void LimitedSearch::set_sizes() {
  constexpr int kSamples = 32;
  const int n = problem_.dynamics.dof;
  std::vector<std::vector<double>> points;
  for (int i = 0; i <= kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples;
    points.emplace_back();
    for (int j = 0; j < n; ++j) {
      points.back().push_back((1 - s) * problem_.from[j] + s * problem_.to[j]);
    }
  }
  double action = 0;
  if (free_.empty()) {
    const double distance = distance_between_ends(problem_);
    action = 0.5 * distance * distance / problem_.time;
  } else {
    action = free_.front().action;
    const auto path = path_along(free_.front(), kSamples);
    for (int i = 0; path && i <= kSamples; ++i) {
      points.emplace_back(path->configuration(i), path->configuration(i) + n);
    }
  }
  std::vector<double> s(walls_.size());
  std::vector<double> beyond(walls_.size(), 0.0);
  interior_.sizes.assign(walls_.size(), 0.0);
  for (const auto& q : points) {
    walls_.evaluate(q.data(), s.data(), nullptr, nullptr);
    for (int w = 0; w < walls_.size(); ++w) {
      beyond[w] = std::max(beyond[w], -s[w]);
      interior_.sizes[w] = std::max(interior_.sizes[w], std::abs(s[w]));
    }
  }
  for (int w = 0; w < walls_.size(); ++w) {
    const Limit& limit = problem_.limits[walls_[w].limit];
    const double half = 0.5 * (limit.upper - limit.lower);
    double& size = interior_.sizes[w];
    if (beyond[w] > 0) size = beyond[w];
    if (std::isfinite(half)) size = half;
    if (!(size > 0)) size = 1;
  }
  interior_.rate = action > 0 ? action / problem_.time : 1;
}

bool LimitedSearch::keeps_to_limits(const Geodesic& geodesic, double beyond) const {
  for (const LimitReport& limit : geodesic.limits) {
    double size = std::numeric_limits<double>::infinity();
    for (int w = 0; w < walls_.size(); ++w) {
      if (problem_.limits[walls_[w].limit].name == limit.name) {
        size = std::min(size, interior_.sizes[w]);
      }
    }
    if (!(limit.lowest_slack >= -beyond * size)) return false;
  }
  return true;
}

std::optional<Geodesic> LimitedSearch::within(const Geodesic& geodesic) const {
  constexpr int kDense = 2048;
  Geodesic judged = geodesic;
  if (geodesic.verification == Verification::kSingle) {
    std::vector<double> z = geodesic.from;
    z.insert(z.end(), geodesic.p0.begin(), geodesic.p0.end());
    const Knots knots = knots_of(unlimited_, start_unknowns(unlimited_, z.data()), 1, 1);
    report_limits(survey(unlimited_, knots, geodesic.plan.count, kDense + 1).trajectory.q, judged);
  } else {
    report_limits(geodesic.trajectory.q, judged);
  }
  return keeps_to_limits(judged) ? std::optional(std::move(judged)) : std::nullopt;
}

std::optional<Path> LimitedSearch::path_along(const Geodesic& geodesic, int intervals) const {
  const Dynamics& dynamics = problem_.dynamics;
  const int n = dynamics.dof;
  const int k = PathLagrangian::multipliers(dynamics);
  std::vector<double> z = geodesic.from;
  z.insert(z.end(), geodesic.p0.begin(), geodesic.p0.end());
  const long steps = std::max<long>(intervals, geodesic.plan.count);
  const Knots knots = knots_of(unlimited_, start_unknowns(unlimited_, z.data()), intervals, steps);
  const double unit = length_per_momentum(problem_, geodesic.p0.data());
  constexpr double kNear = 1e-3;  // of the distance
  if (!(miss(problem_, knots.at(intervals), unit) <= kNear * distance_between_ends(problem_))) {
    return std::nullopt;
  }
  Path path{intervals, n, {}, std::vector<double>(static_cast<std::size_t>(intervals) * k), {}};
  std::vector<double> middle(2 * n);
  for (int i = 0; i <= intervals; ++i) {
    path.q.insert(path.q.end(), knots.at(i), knots.at(i) + n);
    if (i == intervals) break;
    for (int j = 0; j < 2 * n; ++j) middle[j] = 0.5 * (knots.at(i)[j] + knots.at(i + 1)[j]);
    const std::span<const double> at(middle);
    const auto lambda = std::span(path.lambda).subspan(static_cast<std::size_t>(i) * k, k);
    if (dynamics.has_transcription()) {
      dynamics.midpoint_multipliers(at.first(n), at.subspan(n), lambda);
    } else {
      std::copy(at.begin() + n, at.end(), lambda.begin());
    }
  }
  for (int j = 0; j < n; ++j) {
    if (!problem_.is_free_to(j)) path.configuration(intervals)[j] = problem_.to[j];
  }
  return path;
}

// Pulls a path towards the straight line while it is far beyond a limit that is wide enough for the
// line. Where coordinates end beyond the limit, as those of a bicycle do, paths that begin there
// stay there: 15 of 212 starts converged without this, for one target.
void LimitedSearch::draw_in(Path& path) const {
  constexpr double kFar = 1;  // of the size of the wall
  constexpr double kShare = 0.7;
  constexpr int kMost = 12;
  const auto far = [&](const double* q) {
    std::vector<double> s(walls_.size());
    walls_.evaluate(q, s.data(), nullptr, nullptr);
    for (int w = 0; w < walls_.size(); ++w) {
      const Limit& limit = problem_.limits[walls_[w].limit];
      const bool closed = std::isfinite(limit.upper - limit.lower);
      if (closed && s[w] < -kFar * interior_.sizes[w]) return true;
    }
    return false;
  };
  const int n = path.dof;
  const std::vector<double> first(path.configuration(0), path.configuration(1));
  const std::vector<double> last(path.q.end() - n, path.q.end());
  for (int round = 0; round < kMost; ++round) {
    bool any = false;
    for (int i = 1; i < path.intervals && !any; ++i) any = far(path.configuration(i));
    if (!any) return;
    for (int i = 1; i < path.intervals; ++i) {
      const double s = static_cast<double>(i) / path.intervals;
      for (int j = 0; j < n; ++j) {
        const double line = (1 - s) * first[j] + s * last[j];
        path.configuration(i)[j] = line + kShare * (path.configuration(i)[j] - line);
      }
    }
  }
}

std::optional<Path> LimitedSearch::start(int i) const {
  // What a path that is beyond a wall by its size costs, over the action of the best path without
  // limits. Measured on a vehicle whose steering angle ends at 0.3: 22 of 24 starts converge.
  constexpr double kWallRate = 100;
  if (drift_) {
    const RelaxedStart start = drift_->start(i, intervals_);
    return start.found ? std::optional(start.path) : std::nullopt;
  }
  Start start = make_start(unlimited_, options_.seed, i, intervals_);
  draw_in(start.path);
  start.relaxation.wall_rate = kWallRate * interior_.rate;
  start.relaxation.wall_sizes = interior_.sizes;
  (void)relax(problem_, start.relaxation, start.path);
  return std::move(start.path);
}

std::optional<Candidate> LimitedSearch::solve(Path path) const {
  InteriorPointOptions options = interior_;
  options.last_mu = kFirstGridMu;
  Candidate candidate;
  candidate.limited.path = std::move(path);
  if (!interior_point(problem_, walls_, options, candidate.limited).converged) return std::nullopt;
  candidate.action = discrete_action(
      problem_.dynamics, problem_.time / candidate.limited.path.intervals, candidate.limited.path);
  return candidate;
}

// Equal ones are counted. Of those that a wall pins to different nodes the least one is kept.
void LimitedSearch::note(std::optional<Candidate> candidate) {
  constexpr double kSame = 2e-2;        // of the extent of the path
  constexpr double kSameOnGrid = 2e-2;  // of the action
  if (!candidate || !std::isfinite(candidate->action)) return;
  const Path& path = candidate->limited.path;
  for (Candidate& known : candidates_) {
    double apart = 0;
    double extent = 0;
    for (std::size_t j = 0; j < path.q.size(); ++j) {
      apart = std::max(apart, std::abs(path.q[j] - known.limited.path.q[j]));
      extent = std::max(extent, std::abs(path.q[j] - path.q[j % path.dof]));
    }
    if (known.tried || apart > kSame * extent) continue;
    if (std::abs(known.action - candidate->action) > kSameOnGrid * known.action) continue;
    candidate->hits += known.hits;
    if (known.action < candidate->action) std::swap(known.limited, candidate->limited);
    candidate->action = std::min(known.action, candidate->action);
    known = std::move(*candidate);
    return;
  }
  candidates_.push_back(std::move(*candidate));
}

// On the grid of half the step.
bool LimitedSearch::refine(Candidate& candidate, double last_mu) const {
  const LimitedPath& coarse = candidate.limited;
  const int m = walls_.size();
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
  InteriorPointOptions options = interior_;
  options.first_mu = candidate.mu;
  options.last_mu = last_mu;
  const InteriorPoint solved = interior_point(problem_, walls_, options, fine);
  if (!solved.converged) return false;
  candidate.limited = std::move(fine);
  candidate.minimum = solved.minimum;
  candidate.mu = last_mu;
  candidate.action = discrete_action(
      problem_.dynamics, problem_.time / candidate.limited.path.intervals, candidate.limited.path);
  return true;
}

void LimitedSearch::report_limits(const std::vector<std::vector<double>>& q,
                                  Geodesic& geodesic) const {
  geodesic.limits.clear();
  for (const Limit& limit : problem_.limits) {
    LimitReport report;
    report.name = limit.name;
    report.lowest_slack = std::numeric_limits<double>::infinity();
    for (const auto& at : q) {
      const double slack = limit.slack(limit.value(at.data(), nullptr, nullptr));
      report.lowest_slack = slack >= report.lowest_slack ? report.lowest_slack : slack;
    }
    geodesic.limit_violation = std::max(geodesic.limit_violation, -report.lowest_slack);
    geodesic.limits.push_back(std::move(report));
  }
}

void LimitedSearch::add_extremes(const std::vector<std::vector<double>>& q,
                                 Geodesic& geodesic) const {
  for (const Extreme& extreme : problem_.dynamics.info.extremes) {
    double largest = 0;
    for (const auto& at : q) largest = std::max(largest, std::abs(extreme.value(at.data())));
    geodesic.extremes.emplace_back(extreme.name, largest);
  }
}

// Without any contact: an extremal of the problem without limits.
std::optional<Geodesic> LimitedSearch::by_flow(const BoundExtremal& extremal) const {
  constexpr long kSteps = 32;
  constexpr int kDense = 2048;
  const Piece& piece = extremal.pieces.front();
  Knots knots{piece.segments, problem_.dynamics.dof, piece.z};
  knots.z.resize(knots.z.size() + 2 * knots.dof);
  Outcome verified = verify(unlimited_, std::move(knots), kSteps, options_.tolerance);
  if (!verified.extremal) return std::nullopt;
  complete(unlimited_, options_.samples, *verified.extremal);
  Geodesic geodesic = std::move(verified.extremal->geodesic);
  const Knots& found = verified.extremal->knots;
  report_limits(survey(unlimited_, found, geodesic.plan.count, kDense + 1).trajectory.q, geodesic);
  return keeps_to_limits(geodesic) ? std::optional(std::move(geodesic)) : std::nullopt;
}

std::optional<Geodesic> LimitedSearch::by_pieces(const BoundExtremal& extremal,
                                                 const Candidate& candidate) const {
  constexpr int kDense = 2048;
  constexpr long kMostSteps = 4096;
  constexpr double kPull = -1e-6;  // of the multiplier's unit: the wall pulls
  const int n = problem_.dynamics.dof;
  BoundExtremal solved = extremal;
  std::vector<double> dense;
  for (int i = 0; i <= kDense; ++i) dense.push_back(problem_.time * i / kDense);
  BoundSurvey measured;
  long steps = 64;
  bool settled = false;
  for (; steps <= kMostSteps && !settled; steps *= 2) {
    if (!join_pieces(problem_, walls_, steps, solved)) return std::nullopt;
    measured = survey_pieces(problem_, walls_, solved, 2 * steps, dense);
    settled = measured.completed && measured.defect <= 0.1 * options_.tolerance;
  }
  if (!measured.completed || !(measured.defect <= options_.tolerance)) return std::nullopt;
  Geodesic geodesic;
  std::vector<std::vector<double>> points = measured.summary.trajectory.q;
  for (const Piece& piece : solved.pieces)
    points.emplace_back(piece.z.begin(), piece.z.begin() + n);
  report_limits(points, geodesic);
  if (!keeps_to_limits(geodesic)) return std::nullopt;
  double start = 0;
  for (std::size_t k = 0; k < solved.pieces.size(); ++k) {
    const Piece& piece = solved.pieces[k];
    const int wall = piece.leaves();
    if (wall >= 0) {
      const double unit = interior_.rate / interior_.sizes[wall];
      if (measured.least_multiplier < kPull * unit || piece.release < kPull * unit) {
        return std::nullopt;
      }
      LimitReport& limit = geodesic.limits[walls_[wall].limit];
      limit.active.emplace_back(piece.wall >= 0 ? start : piece.end, piece.end);
      limit.largest_multiplier = std::max(limit.largest_multiplier, measured.largest_multiplier[k]);
    }
    start = piece.end;
  }
  const std::vector<double>& z = solved.pieces.front().z;
  geodesic.from.assign(z.begin(), z.begin() + n);
  geodesic.p0.assign(z.begin() + n, z.begin() + 2 * n);
  geodesic.to = problem_.to;
  for (int j = 0; j < n; ++j) {
    if (problem_.is_free_to(j)) geodesic.to[j] = measured.end[j];
  }
  geodesic.transversality_error = transversality_error(problem_, measured.end.data());
  geodesic.lambda0.assign(problem_.dynamics.multipliers, 0.0);
  std::vector<double> velocity(n);
  problem_.dynamics.evaluate(0, geodesic.from, geodesic.p0, velocity, geodesic.lambda0);
  geodesic.verification = Verification::kKnots;
  geodesic.knot_defect = measured.defect;
  geodesic.action = measured.summary.action;
  if (std::isfinite(measured.summary.length)) geodesic.length = measured.summary.length;
  geodesic.constraint_error = measured.summary.constraint_error;
  geodesic.energy_drift = measured.summary.energy_drift;
  geodesic.plan = StepPlan::equal(0, problem_.time, steps);
  if (candidate.minimum) geodesic.label = Label::kLocallyMinimal;
  add_extremes(measured.summary.trajectory.q, geodesic);
  if (options_.samples > 0) {
    geodesic.trajectory =
        survey_pieces(
            problem_, walls_, solved, steps, sample_times(geodesic.plan, options_.samples))
            .summary.trajectory;
  }
  return geodesic;
}

std::optional<Geodesic> LimitedSearch::joined(const Candidate& candidate) const {
  for (const Contacts as :
       {Contacts::kByOrder, Contacts::kArcs, Contacts::kTouches, Contacts::kPairs}) {
    const auto pieces = pieces_of(problem_, walls_, interior_, candidate.limited, as);
    if (!pieces) continue;
    if (pieces->pieces.size() == 1) return by_flow(*pieces);
    if (auto geodesic = by_pieces(*pieces, candidate)) return geodesic;
  }
  return std::nullopt;
}

// The nodes as they are; samples between them by straight lines.
Geodesic LimitedSearch::on_grid(const Candidate& candidate, double coarse_action) const {
  const Path& path = candidate.limited.path;
  const Dynamics& dynamics = problem_.dynamics;
  const int n = path.dof;
  const int m = walls_.size();
  const double h = problem_.time / path.intervals;
  Geodesic geodesic;
  geodesic.verification = Verification::kGrid;
  geodesic.from.assign(path.configuration(0), path.configuration(1));
  geodesic.to.assign(path.configuration(path.intervals), path.configuration(path.intervals) + n);
  geodesic.p0.assign(path.momentum(0), path.momentum(0) + n);
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
  report_limits(points_along(path), geodesic);
  for (int w = 0; w < m; ++w) {
    LimitReport& limit = geodesic.limits[walls_[w].limit];
    for (int i = 0; i <= path.intervals; ++i) {
      const std::size_t at = static_cast<std::size_t>(i) * m + w;
      const double nu = candidate.limited.nu[at];
      const double size = interior_.sizes[w];
      limit.largest_multiplier = std::max(limit.largest_multiplier, nu);
      if (!(nu * size / interior_.rate > candidate.limited.sigma[at] / size)) continue;
      if (!limit.active.empty() && limit.active.back().second >= (i - 1.5) * h) {
        limit.active.back().second = i * h;
      } else {
        limit.active.emplace_back(i * h, i * h);
      }
    }
  }
  const StepPlan plan = StepPlan::equal(0, problem_.time, path.intervals);
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

std::optional<Geodesic> LimitedSearch::finish(Candidate candidate) const {
  // mu on grids of 2, 4, ... times the first one. Contacts are told from the second of them in
  // nearly all cases.
  constexpr std::array kMu{3e-4, 1e-4, 1e-5, 1e-7};
  constexpr double kBeyondOnGrid = 1e-4;  // between two nodes
  Candidate coarse;
  for (std::size_t level = 0; level < kMu.size(); ++level) {
    coarse = candidate;
    if (!refine(candidate, kMu[level])) return std::nullopt;
    if (level == 0) continue;
    if (auto geodesic = joined(candidate)) return geodesic;
  }
  if (!settle(coarse) || !settle(candidate)) return std::nullopt;
  Geodesic geodesic = on_grid(candidate, coarse.action);
  if (!keeps_to_limits(geodesic, kBeyondOnGrid)) return std::nullopt;
  return geodesic;
}

// With the least mu, on the same grid. Between nodes the straight line may be beyond a wall by the
// square of an interval; then the walls are moved by that much.
bool LimitedSearch::settle(Candidate& candidate) const {
  constexpr double kLeastMu = 1e-9;
  constexpr double kMargin = 1.5;
  constexpr int kRounds = 3;
  InteriorPointOptions options = interior_;
  options.last_mu = kLeastMu;
  std::vector<Limit> limits = problem_.limits;
  for (int round = 0; round < kRounds; ++round) {
    options.first_mu = std::max(candidate.mu, kLeastMu);
    const Walls walls(limits, problem_.dynamics.dof);
    if (!interior_point(problem_, walls, options, candidate.limited).converged) return false;
    candidate.mu = kLeastMu;
    Geodesic judged;
    report_limits(points_along(candidate.limited.path), judged);
    if (!(judged.limit_violation > 0)) break;
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const double beyond = std::max(0.0, -judged.limits[i].lowest_slack);
      limits[i].lower += kMargin * beyond;
      limits[i].upper -= kMargin * beyond;
    }
  }
  candidate.action = discrete_action(
      problem_.dynamics, problem_.time / candidate.limited.path.intervals, candidate.limited.path);
  return true;
}

// The nodes of a path, and points of the straight lines between them: a path could step over a
// wall.
std::vector<std::vector<double>> LimitedSearch::points_along(const Path& path) {
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

bool LimitedSearch::enough() const {
  constexpr int kOften = 3;
  if (candidates_.empty() || options_.all || options_.count > 1) return false;
  const auto least = std::min_element(
      candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
        return a.action < b.action;
      });
  return least->hits >= kOften;
}

std::string LimitedSearch::infeasible() const {
  // The limit that is violated most by the best path without limits.
  std::string name = problem_.limits.front().name;
  double worst = 0;
  if (!free_.empty()) {
    if (const auto path = path_along(free_.front(), intervals_)) {
      for (const Limit& limit : problem_.limits) {
        for (int i = 0; i <= intervals_; ++i) {
          const double slack = limit.slack(limit.value(path->configuration(i), nullptr, nullptr));
          if (slack < worst) {
            worst = slack;
            name = limit.name;
          }
        }
      }
    }
  }
  return "no path was found that keeps to the limits; without them the best one is beyond '" +
         name + "': there may be none, or try more --starts or another --seed";
}

// From the least on, until as many as are wanted are finished and some more, since the grid may
// have them in another order.
void LimitedSearch::finish_candidates(int threads, std::vector<Geodesic>& geodesics) {
  constexpr std::size_t kMore = 2;
  constexpr std::size_t kMostTried = 24;
  std::stable_sort(candidates_.begin(), candidates_.end(), [](const auto& a, const auto& b) {
    return a.action < b.action;
  });
  const auto count = static_cast<std::size_t>(options_.count);
  const std::size_t wanted = options_.all ? candidates_.size() : count + kMore;
  std::vector<Candidate*> open;
  for (Candidate& candidate : candidates_) {
    if (!candidate.tried) open.push_back(&candidate);
  }
  if (!options_.all && open.size() > wanted + kMostTried) open.resize(wanted + kMostTried);
  std::size_t next = 0;
  while (next < open.size() && (next < wanted || geodesics.size() < count)) {
    const std::size_t round = std::min(wanted, open.size() - next);
    std::vector<std::optional<Geodesic>> finished(round);
    parallel_for(static_cast<int>(round), threads, [&](int i) {
      finished[i] = finish(*open[next + i]);
      if (finished[i]) finished[i]->hits = open[next + i]->hits;
    });
    for (std::size_t i = next; i < next + round; ++i) open[i]->tried = true;
    next += round;
    for (auto& geodesic : finished) {
      const bool fits = geodesic && geodesic->length.value_or(0) <= options_.max_length;
      const bool known =
          fits && std::any_of(geodesics.begin(), geodesics.end(), [&](const Geodesic& other) {
            return same_start(other, *geodesic);
          });
      if (fits && !known) geodesics.push_back(std::move(*geodesic));
    }
  }
}

LimitedAnswer LimitedSearch::run() {
  constexpr int kRound = 12;
  constexpr int kMostStarts = 96;
  LimitedAnswer answer;
  const int threads = thread_count(options_.threads);
  for (const Geodesic& geodesic : free_) {
    if (auto judged = within(geodesic)) answer.geodesics.push_back(std::move(*judged));
    const bool best = &geodesic == &free_.front();
    if (best && !answer.geodesics.empty() && options_.count == 1 && !options_.all) return answer;
  }
  for (const Geodesic& geodesic : free_) {
    if (auto path = path_along(geodesic, intervals_)) note(solve(std::move(*path)));
  }
  const int most = options_.starts > 0 ? options_.starts : kMostStarts;
  const auto lacks = [&] {
    return answer.geodesics.size() < static_cast<std::size_t>(options_.count);
  };
  const Deadline deadline(options_.time_limit);
  while (answer.starts < most && (!enough() || lacks())) {
    answer.timed_out = deadline.passed();
    if (answer.timed_out) break;
    if (options_.progress && !options_.progress(static_cast<double>(answer.starts) / most)) {
      answer.finished = false;
      break;
    }
    const int count = std::min(kRound, most - answer.starts);
    std::vector<std::optional<Candidate>> found(count);
    parallel_for(count, threads, [&](int i) {
      if (auto path = start(answer.starts + i)) found[i] = solve(std::move(*path));
    });
    answer.starts += count;
    for (auto& candidate : found) {
      answer.converged += candidate ? 1 : 0;
      note(std::move(candidate));
    }
    if (enough()) finish_candidates(threads, answer.geodesics);
  }
  finish_candidates(threads, answer.geodesics);
  rank(answer.geodesics);
  if (!options_.all && answer.geodesics.size() > static_cast<std::size_t>(options_.count)) {
    answer.geodesics.resize(options_.count);
  }
  if (answer.geodesics.empty()) {
    answer.reason = Reason::kLimitsInfeasible;
    answer.message = infeasible();
  }
  return answer;
}

}  // namespace

std::string beyond_limit_at_end(const BoundaryValueProblem& problem) {
  const int n = problem.dynamics.dof;
  std::vector<double> gradient(n);
  for (const bool start : {true, false}) {
    const std::vector<double>& q = start ? problem.from : problem.to;
    for (const Limit& limit : problem.limits) {
      const double value = limit.value(q.data(), gradient.data(), nullptr);
      bool moves = false;  // a free coordinate may mend it
      for (int j = 0; j < n; ++j) {
        const bool free = start ? problem.is_free_from(j) : problem.is_free_to(j);
        moves = moves || (free && gradient[j] != 0);
      }
      if (moves || limit.slack(value) >= 0) continue;
      std::ostringstream text;
      text << "the " << (start ? "start" : "target") << " is beyond the limit '" << limit.name
           << "' by " << -limit.slack(value) << ": move it, or widen the limit";
      return text.str();
    }
  }
  return "";
}

bool is_within_limits(const BoundaryValueProblem& problem, const Geodesic& geodesic) {
  const std::vector<Geodesic> free{geodesic};
  return LimitedSearch(problem, {}, free).within(geodesic).has_value();
}

LimitedAnswer search_with_limits(const BoundaryValueProblem& problem,
                                 const GeodesicOptions& options,
                                 const std::vector<Geodesic>& free) {
  return LimitedSearch(problem, options, free).run();
}

}  // namespace carnot::internal
