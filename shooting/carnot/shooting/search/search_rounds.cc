// The rounds of a search: starts, and what leads from what is known to more.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/shooting/extremal/ranking.h"
#include "carnot/shooting/path/descent.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/problem/units.h"
#include "carnot/shooting/search/momentum_starts.h"
#include "carnot/shooting/search/polish.h"
#include "carnot/shooting/search/search.h"
#include "carnot/shooting/search/starts.h"
#include "carnot/shooting/search/sweep.h"
#include "carnot/shooting/shoot/multiple_shooting.h"

namespace carnot::internal {
namespace {

constexpr int kMaxIntervals = 128;  // of the grids that paths are relaxed on
constexpr int kArtefacts = 3;  // of a round, that are more than the rest: the grid is too coarse
constexpr int kMaxStiffness = 2;

double largest_momentum(const Path& path) {
  double largest = std::numeric_limits<double>::min();
  for (const double p : path.p) largest = std::max(largest, std::abs(p));
  return largest;
}

}  // namespace

void Search::relax_round(int count) {
  std::vector<Candidate> candidates(count);
  parallel_for(count, threads_, [&](int i) { candidates[i] = relax_start(drawn_ + i); });
  drawn_ += count;
  const Polished polished = absorb(candidates);
  shoot_along_relaxed(candidates);
  const bool artefacts = polished.failed >= kArtefacts && polished.failed > polished.good;
  int stiffer = 0;
  int found = 0;
  for (const Candidate& candidate : candidates) {
    found += candidate.found ? 1 : 0;
    stiffer += candidate.found && candidate.stiffness > 0 ? 1 : 0;
  }
  if (2 * stiffer > found && stiffness_ < kMaxStiffness) ++stiffness_;
  if (artefacts) intervals_ = std::min(2 * intervals_, kMaxIntervals);
}

void Search::shoot_straight() {
  Path line{1, problem_.dynamics.dof, problem_.from, {}, {}};
  line.q.insert(line.q.end(), problem_.to.begin(), problem_.to.end());
  count_hit(add(shoot_along(problem_, options_, line)));
}

void Search::shoot_along_relaxed(const std::vector<Candidate>& candidates) {
  const Path* least = nullptr;
  double least_action = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : candidates) {
    if (candidate.found || !candidate.relaxed) continue;
    const double h = problem_.time / candidate.path.intervals;
    const double action = discrete_action(problem_.dynamics, h, candidate.path);
    if (!(action < least_action)) continue;
    least = &candidate.path;
    least_action = action;
  }
  if (least != nullptr) count_hit(add(shoot_along(problem_, options_, *least)));
}

bool Search::descend_round() {
  constexpr int kGrids = 3;
  const auto saddle = std::find_if(discrete_.begin(), discrete_.end(), [&](const Discrete& known) {
    return known.extremal == static_cast<int>(best()) && known.descents < kGrids;
  });
  if (saddle == discrete_.end()) return false;
  Path path = saddle->path;
  for (int i = 0; i < saddle->descents; ++i) {
    path = halved(path);
    if (!tighten(problem_, {}, path).converged) return false;
  }
  ++saddle->descents;
  std::vector<Candidate> candidates;
  for (Path& way : ways_down(problem_, path)) {
    candidates.emplace_back();
    candidates.back().found = true;
    candidates.back().path = std::move(way);
  }
  const double before = extremals_[best()].geodesic.action;
  absorb(candidates);
  return extremals_[best()].geodesic.action < before - kSameAction * std::abs(before);
}

void Search::momentum_round(int count) {
  std::vector<Outcome> polished(count);
  parallel_for(count, threads_, [&](int i) {
    const std::vector<double> p0 = momentum_start(problem_, options_.seed, drawn_ + i);
    if (p0.empty()) return;
    const int segments = i % 2 == 0 ? kSegments : 1;
    const Knots knots = knots_of(problem_, p0, segments, kFirstSteps);
    polished[i].extremal = polish(problem_, options_, knots, &polished[i].reason);
  });
  starts_ += count;
  drawn_ += count;
  for (const Outcome& outcome : polished) count_hit(add(outcome));
}

void Search::sweep_round(int round) {
  SweepOptions sweep;
  sweep.seed = options_.seed;
  sweep.round = round;
  sweep.intervals = round % 2 == 0 ? 64 : 160;  // the longest wind more often than a grid sees
  sweep.momentum_scale.assign(problem_.dynamics.dof, 0.0);
  // Row j: the momentum of coordinate j in the units of the shortest extremal.
  const Eigen::MatrixXd natural =
      Units(problem_, extremals_[best()].geodesic.p0.data())
          .momenta(Eigen::MatrixXd::Identity(problem_.dynamics.dof, problem_.dynamics.dof));
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0;
  double largest = 0;
  for (const Extremal& extremal : extremals_) {
    const Geodesic& geodesic = extremal.geodesic;
    shortest = std::min(shortest, geodesic.length.value_or(0));
    longest = std::max(longest, geodesic.length.value_or(0));
    for (std::size_t j = 0; j < geodesic.p0.size(); ++j) {
      const double size = std::abs(geodesic.p0[j]);
      sweep.momentum_scale[j] = std::max(sweep.momentum_scale[j], size);
      largest = std::max(largest, size / natural.row(j).norm());
    }
  }
  for (int j = 0; j < problem_.dynamics.dof; ++j) {
    double& scale = sweep.momentum_scale[j];
    scale = std::max(scale, 0.3 * largest * natural.row(j).norm());
  }
  longest = std::max(longest, std::sqrt(2.0) * shortest);
  const bool farthest = round % 2 == 1 && std::isfinite(options_.max_length);
  longest = farthest ? options_.max_length : std::min(longest, options_.max_length);
  const auto energy = [&](double length) {
    const double speed = length / problem_.time;
    return 0.5 * speed * speed;
  };
  sweep.lowest = energy(0.8 * shortest);
  sweep.highest = energy(longest);
  std::vector<Path> paths = near_hits(problem_, sweep, threads_);
  std::vector<Candidate> candidates(paths.size());
  parallel_for(static_cast<int>(paths.size()), threads_, [&](int i) {
    candidates[i].path = paths[i];
    candidates[i].found = tighten(problem_, {}, candidates[i].path).converged;
  });
  absorb(candidates);
  shoot_near_hits(paths, candidates);
}

void Search::shoot_near_hits(const std::vector<Path>& paths,
                             const std::vector<Candidate>& candidates) {
  std::vector<Outcome> outcomes(paths.size());
  parallel_for(static_cast<int>(paths.size()), threads_, [&](int i) {
    if (candidates[i].found) return;
    ShootingOptions shooting;
    shooting.steps = paths[i].intervals / 2;
    Knots knots = knots_of(paths[i], kSegments);
    if (!shoot(problem_, shooting, knots).converged) return;
    outcomes[i].extremal =
        verify(problem_, std::move(knots), 2 * shooting.steps, options_.tolerance);
  });
  for (const Outcome& outcome : outcomes) count_hit(add(outcome));
}

Search::Candidate Search::relax_start(int i) const {
  // Collapsed to the straight line, which violates the constraints, or on the way there: a stiffer
  // penalty holds the path.
  constexpr double kCollapsed = 0.5;
  constexpr double kHeld = 0.02;
  constexpr int kAttempts = 3;
  constexpr double kStiffer = 8;
  const NearTarget::Way way = near_ ? near_->way(i) : NearTarget::Way{};
  const BoundaryValueProblem easy = near_ ? near_->easy(way) : problem_;
  const Start start = make_start(easy, options_.seed, i, intervals_);
  RelaxationOptions relaxation = start.relaxation;
  Candidate candidate;
  relaxation.penalty *= std::pow(kStiffer, stiffness_);
  for (; candidate.stiffness < kAttempts; ++candidate.stiffness, relaxation.penalty *= kStiffer) {
    candidate.path = start.path;
    const double violation = relax(easy, relaxation, candidate.path).violation;
    if (!(violation < kCollapsed)) continue;
    Path path = candidate.path;
    const DiscreteNewton tightened = tighten(easy, {}, path);
    candidate.blocked = tightened.left_chart || skims_chart_end(easy.dynamics, path);
    candidate.found = tightened.converged && !candidate.blocked;
    candidate.relaxed = !candidate.blocked && !near_;
    candidate.residual = tightened.residual / largest_momentum(path);
    if (candidate.found) candidate.path = std::move(path);
    if (candidate.found || violation < kHeld || candidate.stiffness > 0) break;
  }
  if (candidate.found && near_) candidate.found = near_->shrink(way, candidate.path);
  return candidate;
}

}  // namespace carnot::internal
