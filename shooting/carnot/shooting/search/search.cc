#include "carnot/shooting/search/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/extremal/ranking.h"
#include "carnot/shooting/search/polish.h"

namespace carnot::internal {
namespace {

constexpr int kRound = 8;  // starts between two looks at the list
constexpr int kMinStarts = 16;
constexpr int kMinNear = 24;     // by the ways to a near target
constexpr int kMinEasy = 12;     // where most of them agree
constexpr int kMaxStarts = 96;   // when the best extremal keeps changing
constexpr int kMaxDescents = 4;  // sweeps below an extremal that is no minimum
constexpr int kMaxStartsAll = 240;
constexpr int kMaxBlocked = 2;           // times the limit, starts that do not count
constexpr int kSweeps = 24;              // rounds of near hits, where more than the best is wanted
constexpr int kEnoughHits = 3;           // of the least action, before a search for it ends
constexpr double kRival = 0.02;          // extremals this close to the least action, relative,
constexpr int kConvergedPerRival = 8;    // make the search longer: there may be another
constexpr double kMostConverged = 0.75;  // share of the starts of an easy problem, that converge
constexpr double kMostHits = 0.6;        // and that hit the least action
constexpr double kClearly = 0.2;         // above the least action, relative; grids err by less
constexpr double kSameDiscreteAction = 1e-6;

}  // namespace

bool Search::run() {
  int limit = options_.all ? kMaxStartsAll : kMaxStarts;
  if (options_.starts > 0) limit = options_.starts;
  const bool by_paths = problem_.dynamics.has_transcription();
  const int sweeps = by_paths && wants_more() && options_.starts == 0 ? kSweeps : 0;
  const auto goes_on = [&](double share) { return !options_.progress || options_.progress(share); };
  // Starts that ran into the end of the chart do not count, or not before there are many.
  const auto left = [&] {
    const int in_vain = options_.starts > 0 ? 0 : std::min(blocked_, kMaxBlocked * limit);
    return limit + in_vain - drawn_;
  };
  if (near_) shoot_straight();
  int descents = 0;
  while (left() > 0 && !settled()) {
    const double share = static_cast<double>(drawn_) / (drawn_ + left());
    if (!goes_on(sweeps > 0 ? 0.5 * share : share)) return false;
    // In halves from where the search may end.
    const bool may_end = !wants_more() && 0 < starts_ && starts_ < kMinStarts;
    const int count = std::min(may_end ? kRound / 2 : kRound, left());
    if (by_paths && descends_ && descents < kMaxDescents) {
      if (!descend_round()) sweep_round(descents++);
    } else {
      by_paths ? relax_round(count) : momentum_round(count);
    }
  }
  for (int round = 0; round < sweeps && lacks() && !extremals_.empty(); ++round) {
    if (!goes_on(0.5 + 0.5 * round / sweeps)) return false;
    sweep_round(round);
  }
  return true;
}

void Search::polish_guess() {
  starts_ = 1;
  for (const int segments : {kSegments, 1}) {
    Outcome outcome;
    const Knots knots = knots_of(problem_, options_.guess, segments, kFirstSteps);
    outcome.extremal = polish(problem_, options_, knots, &outcome.reason);
    add(outcome);
    if (!extremals_.empty()) break;
  }
  converged_ = extremals_.empty() ? 0 : 1;
}

std::vector<Extremal> Search::extremals(bool longer) const {
  std::vector<Extremal> list;
  for (std::size_t i = 0; i < extremals_.size(); ++i) {
    if (!longer && extremals_[i].geodesic.length.value_or(0) > options_.max_length) continue;
    list.push_back(extremals_[i]);
    list.back().geodesic.hits = hits_[root(static_cast<int>(i))];
  }
  return list;
}

std::vector<int> Search::hits() const {
  std::vector<int> hits;
  for (std::size_t i = 0; i < hits_.size(); ++i) {
    if (hits_[i] > 0) hits.push_back(hits_[i]);
  }
  for (const Discrete& known : discrete_) {
    if (known.extremal == kTooLong) hits.push_back(known.pending_hits);
  }
  return hits;
}

bool Search::lacks() const {
  return options_.all || static_cast<int>(extremals_.size()) < options_.count;
}

const Path* Search::nearest_discrete() const {
  const auto least = std::min_element(
      discrete_.begin(), discrete_.end(), [](const Discrete& a, const Discrete& b) {
        return a.action < b.action;
      });
  return least == discrete_.end() ? nullptr : &least->path;
}

std::size_t Search::best() const {
  const auto least = std::min_element(
      extremals_.begin(), extremals_.end(), [](const Extremal& a, const Extremal& b) {
        return a.geodesic.action < b.geodesic.action;
      });
  return static_cast<std::size_t>(least - extremals_.begin());
}

bool Search::settled() {
  if (options_.starts > 0 || extremals_.empty() || starts_ < kMinEasy) return false;
  if (near_ && starts_ < kMinNear) return false;
  const bool early = starts_ < kMinStarts;
  if (early && (wants_more() || converged_ < kMostConverged * starts_)) return false;
  const ConjugateTimes& conjugate = conjugate_times_of(problem_, extremals_[best()]);
  descends_ = conjugate.known && conjugate.times.size() > std::size_t(conjugate.at_end);
  if (wants_more() || descends_) return false;
  const double least = extremals_[best()].geodesic.action;
  int hits = 0;
  int rivals = 0;
  for (std::size_t i = 0; i < extremals_.size(); ++i) {
    const double above = extremals_[i].geodesic.action - least;
    // Mirror partners have the same action and count together.
    if (above <= kSameAction * std::abs(least)) hits += hits_[i];
    if (above <= kRival * std::abs(least)) ++rivals;
  }
  if (early && (rivals > 1 || hits < kMostHits * starts_)) return false;
  return hits >= kEnoughHits && converged_ >= kConvergedPerRival * rivals;
}

std::vector<std::size_t> Search::next_to_polish(std::vector<std::size_t>& fresh) {
  if (wants_more() || std::isfinite(options_.max_length)) return std::exchange(fresh, {});
  bool verified = false;
  double least = std::numeric_limits<double>::infinity();
  for (const Discrete& known : discrete_) {
    verified = verified || known.extremal >= 0;
    if (known.extremal >= 0) least = std::min(least, known.action);
  }
  for (const std::size_t i : fresh) {
    if (!verified) least = std::min(least, discrete_[i].action);
  }
  std::vector<std::size_t> next;
  std::vector<std::size_t> rest;
  for (const std::size_t i : fresh) {
    const bool clearly_more = discrete_[i].action - least > kClearly * std::abs(least);
    (clearly_more ? rest : next).push_back(i);
  }
  fresh = rest;
  if (!next.empty()) return next;
  for (const std::size_t i : std::exchange(fresh, {})) {
    discrete_[i].extremal = kTooLong;
    converged_ += discrete_[i].pending_hits;
  }
  return next;
}

Search::Polished Search::absorb(const std::vector<Candidate>& candidates) {
  starts_ += static_cast<int>(candidates.size());
  // In the order of the starts, so that the list does not depend on the threads.
  std::vector<std::size_t> fresh;
  for (const Candidate& candidate : candidates) {
    if (candidate.residual < least_residual_) least_residual_ = candidate.residual;
    blocked_ += candidate.blocked ? 1 : 0;
    if (!candidate.found) continue;
    const std::size_t known = find_discrete(candidate.path);
    if (known < discrete_.size()) {
      const int extremal = discrete_[known].extremal;
      if (extremal >= 0) ++hits_[root(extremal)];
      if (extremal >= 0 || extremal == kTooLong) ++converged_;
      if (extremal == kPending || extremal == kTooLong) ++discrete_[known].pending_hits;
      continue;
    }
    const double h = problem_.time / candidate.path.intervals;
    discrete_.push_back({candidate.path, discrete_action(problem_.dynamics, h, candidate.path)});
    fresh.push_back(known);
  }
  Polished tally;
  for (auto next = next_to_polish(fresh); !next.empty(); next = next_to_polish(fresh)) {
    std::vector<Outcome> polished(next.size());
    parallel_for(static_cast<int>(next.size()), threads_, [&](int i) {
      Outcome& outcome = polished[i];
      outcome.extremal = polish(problem_, options_, discrete_[next[i]].path, &outcome.reason);
    });
    for (std::size_t i = 0; i < next.size(); ++i) {
      Discrete& discrete = discrete_[next[i]];
      discrete.extremal = add(polished[i]);
      ++(discrete.extremal < 0 ? tally.failed : tally.good);
      if (discrete.extremal < 0) continue;
      hits_[root(discrete.extremal)] += discrete.pending_hits;
      converged_ += discrete.pending_hits;
    }
  }
  return tally;
}

void Search::count_hit(int index) {
  if (index < 0) return;
  ++hits_[root(index)];
  ++converged_;
}

int Search::add(const Outcome& outcome) {
  furthest_ = std::max(furthest_, outcome.reason);
  return add(outcome.extremal);
}

int Search::add(const std::optional<Extremal>& extremal, int partner_of) {
  if (!extremal) return kNone;
  for (std::size_t i = 0; i < extremals_.size(); ++i) {
    if (same(extremals_[i], *extremal) || same_family(extremals_[i], *extremal)) {
      // The same path by momenta that need no knots.
      const bool simpler = extremals_[i].geodesic.verification == Verification::kKnots &&
                           extremal->geodesic.verification == Verification::kSingle;
      if (simpler) extremals_[i] = *extremal;
      return static_cast<int>(i);
    }
  }
  const int index = static_cast<int>(extremals_.size());
  extremals_.push_back(*extremal);
  hits_.push_back(0);
  partner_of_.push_back(partner_of);
  for (const ProblemSymmetry& symmetry : symmetries_) {
    if (!wants_more()) break;
    const Knots image = partner(problem_.dynamics.info, symmetry, extremal->knots);
    add(verify(problem_, image, kFirstSteps, options_.tolerance), index);
  }
  return index;
}

std::size_t Search::find_discrete(const Path& path) const {
  std::vector<Path> images{path};
  for (const ProblemSymmetry& symmetry : symmetries_) {
    images.push_back(partner(problem_.dynamics.info, symmetry, path));
  }
  const double action = discrete_action(problem_.dynamics, problem_.time / path.intervals, path);
  for (std::size_t i = 0; i < discrete_.size(); ++i) {
    if (discrete_[i].path.intervals != path.intervals) continue;
    const double above = std::abs(action - discrete_[i].action);
    if (above > kSameDiscreteAction * std::abs(action)) continue;
    // Members of one family are as good as each other.
    const int extremal = discrete_[i].extremal;
    if (extremal >= 0 && extremals_[extremal].singular) return i;
    for (const Path& image : images) {
      if (same_nodes(discrete_[i].path, image)) return i;
    }
  }
  return discrete_.size();
}

bool Search::same_nodes(const Path& a, const Path& b) {
  constexpr double kSame = 1e-6;
  if (a.q.size() != b.q.size()) return false;
  double apart = 0;
  double extent = 0;
  for (std::size_t j = 0; j < a.q.size(); ++j) {
    apart = std::max(apart, std::abs(a.q[j] - b.q[j]));
    extent = std::max(extent, std::abs(a.q[j] - a.q[j % a.dof]));
  }
  return apart <= kSame * extent;
}

}  // namespace carnot::internal
