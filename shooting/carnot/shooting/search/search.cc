#include "carnot/shooting/search/search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/extremal/abnormal_curve.h"
#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/extremal/ranking.h"
#include "carnot/shooting/problem/scales.h"
#include "carnot/shooting/search/polish.h"

namespace carnot::internal {
ExtremalList::Partners Search::partners_for(const BoundaryValueProblem& problem,
                                            const GeodesicOptions& options,
                                            const StoppingPolicy& policy) {
  if (!policy.wants_more()) return {};
  return [&problem, &options, symmetries = symmetries_of(problem)](const Extremal& extremal) {
    std::vector<Extremal> partners;
    for (const ProblemSymmetry& symmetry : symmetries) {
      const Knots image = partner(problem.dynamics.info, symmetry, extremal.knots);
      auto verified = verify(problem, image, kFirstSteps, options.tolerance).extremal;
      if (verified) partners.push_back(std::move(*verified));
    }
    return partners;
  };
}

Search::Search(const BoundaryValueProblem& problem, const GeodesicOptions& options)
    : problem_(problem),
      options_(options),
      stop_(options.time_limit, [this] { return !options_.progress || options_.progress(shown_); }),
      threads_(thread_count(options.threads)),
      near_(NearTarget::of(problem)),
      policy_(
          options, problem.dynamics.forced == 0 || problem.dynamics.on_leaves, near_.has_value()),
      extremals_(partners_for(problem, options, policy_)),
      ladder_(problem),
      discrete_(ladder_),
      seeks_abnormal_(may_have_abnormal_curves(problem)) {
  if (problem.dynamics.has_transcription()) {
    policy_.plan_for_paths(problem.dynamics.dof, has_only_angles(problem.dynamics));
    return;
  }
  if (problem.dynamics.forced > 0 && !problem.dynamics.on_leaves) return;
  drift_.emplace(problem, options.seed);
  intervals_ = drift_->intervals();
  policy_.plan_for(drift_->scaled(), drift_->actuated());
}

bool Search::turn_of_momenta() const {
  constexpr int kTurn = 16;  // starts
  return extremals_.empty() && tally_.drawn / kTurn % 2 == 1;
}

bool Search::run() {
  constexpr int kMaxDescents = 4;  // sweeps below an extremal that is no minimum
  const bool by_paths = problem_.dynamics.has_transcription();
  const int sweeps = policy_.sweeps();
  const auto goes_on = [&](double share) {
    shown_ = std::max(shown_, share);
    return !stop_.reached();
  };
  if (near_) shoot_straight();
  int descents = 0;
  while (policy_.left(tally_) > 0) {
    if (may_end()) {
      descends_ = best_is_passed();
      const bool found_lower = shoots_below() && shoot_below();
      if (!found_lower && !descends_ && settled()) break;
    }
    if (extremals_.empty() && policy_.are_in_vain(tally_)) break;
    if (!goes_on(policy_.share(tally_))) break;
    if (by_paths && descends_ && descents < kMaxDescents) {
      if (!descend_round()) sweep_round(descents++);
    } else if (by_paths) {
      const bool crossed = policy_.turn_of_crossings(tally_) && cross_round(policy_.round(tally_));
      if (!crossed) relax_round(policy_.round(tally_));
    } else if (drift_ && !turn_of_momenta()) {
      drift_round(policy_.round(tally_));
    } else {
      momentum_round(policy_.round(tally_));
    }
  }
  for (int round = 0; round < sweeps; ++round) {
    if (extremals_.empty() || !policy_.lacks(extremals_.size())) break;
    if (!goes_on(0.5 + 0.5 * round / sweeps)) break;
    sweep_round(round);
  }
  stop_.rethrow();
  return !stop_.asked();
}

void Search::polish_guess() {
  tally_.starts = 1;
  for (const int segments : {kSegments, 1}) {
    const Knots knots = knots_of(problem_, options_.guess, segments, kFirstSteps);
    const Outcome outcome = polish(problem_, options_, knots, stop_);
    furthest_ = std::max(furthest_, outcome.reason);
    if (outcome.extremal) extremals_.add(*outcome.extremal);
    if (!extremals_.empty()) break;
  }
  tally_.converged = extremals_.empty() ? 0 : 1;
  stop_.rethrow();
}

std::vector<int> Search::hits() const {
  std::vector<int> hits;
  for (const Hits& of_one : extremals_.hits()) hits.push_back(of_one.starts);
  for (const Hits& of_one : discrete_.hits_given_up()) hits.push_back(of_one.starts);
  return hits;
}

bool Search::counts() const {
  constexpr int kOften = 5;
  if (problem_.dynamics.has_transcription()) return true;
  const std::vector<int> counted = hits();
  return !extremals_.empty() && extremals_.competition().hits.starts >= kOften &&
         std::count(counted.begin(), counted.end(), 1) == 0;
}

bool Search::may_end() const { return !extremals_.empty() && policy_.may_end(tally_); }

bool Search::best_is_passed() {
  const ConjugateTimes& conjugate = conjugate_times_of(problem_, extremals_[extremals_.best()]);
  return conjugate.known && conjugate.times.size() > std::size_t(conjugate.at_end);
}

bool Search::settled() const {
  if (policy_.wants_more()) return false;
  Competition competition = extremals_.competition();
  competition.missed = missed_estimate(hits());
  return policy_.ends(tally_, competition);
}

void Search::note(const Path& path, const Hits& found, std::vector<std::size_t>& fresh) {
  const std::size_t index = discrete_.find(path, extremals_);
  if (index == discrete_.size()) {
    fresh.push_back(discrete_.add(path, found));
    return;
  }
  hit(discrete_[index], found);
}

void Search::hit(DiscreteExtremal& known, const Hits& hits) {
  if (known.fate == Fate::kExtremal) extremals_.hit(known.extremal, hits);
  if (known.fate == Fate::kExtremal || known.fate == Fate::kGivenUp) {
    tally_.converged += hits.all();
  }
  if (known.fate == Fate::kPending || known.fate == Fate::kGivenUp) known.hits += hits;
  if (known.fate == Fate::kTooRough) tally_.rough += hits.all();
}

Search::Polished Search::absorb(const std::vector<RelaxedStart>& starts, const Hits& each) {
  tally_.starts += static_cast<int>(starts.size());
  std::vector<std::size_t> pending;
  for (const RelaxedStart& start : starts) {
    least_residual_ = std::min(least_residual_, start.residual);
    tally_.blocked += start.blocked ? 1 : 0;
    if (start.found) note(start.path, each, pending);
  }
  const bool only_least = !policy_.wants_more() && !std::isfinite(options_.max_length);
  Polished tally;
  while (!pending.empty()) {
    const auto next = only_least ? discrete_.take_promising(pending) : std::exchange(pending, {});
    if (next.empty()) {
      tally_.converged += discrete_.give_up(pending).all();
      break;
    }
    Refinements refined = refine_all(next, tally);
    if (only_least) {
      polish_least(std::move(refined), tally);
    } else {
      polish_all(refined, tally);
    }
  }
  return tally;
}

Search::Refinements Search::refine_all(const std::vector<std::size_t>& indices, Polished& tally) {
  std::vector<Refinement> refinements(indices.size());
  parallel_for(static_cast<int>(indices.size()), threads_, [&](int i) {
    if (!stop_.reached()) {
      refinements[i] = refine_to_polish(ladder_, discrete_[indices[i]].path, stop_);
    }
  });
  Refinements refined;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::size_t index = indices[i];
    const std::size_t known = discrete_.refine(index, refinements[i].finer, extremals_);
    if (known == index) {
      refined.emplace_back(index, std::move(refinements[i]));
      continue;
    }
    hit(discrete_[known], discrete_[index].hits);
    if (discrete_[known].fate == Fate::kArtefact) ++tally.failed;
  }
  return refined;
}

void Search::polish_least(Refinements refined, Polished& tally) {
  const auto indices = [&] {
    std::vector<std::size_t> of_refined;
    for (const auto& [index, refinement] : refined) of_refined.push_back(index);
    return of_refined;
  };
  const auto take_out = [&](const std::vector<std::size_t>& chosen) {
    const auto others = std::stable_partition(refined.begin(), refined.end(), [&](auto& item) {
      return std::find(chosen.begin(), chosen.end(), item.first) == chosen.end();
    });
    Refinements taken(std::make_move_iterator(others), std::make_move_iterator(refined.end()));
    refined.erase(others, refined.end());
    return taken;
  };
  while (!refined.empty()) {
    const double infinity = std::numeric_limits<double>::infinity();
    const double least = extremals_.empty() ? infinity : extremals_.least_action();
    const std::vector<std::size_t> next = discrete_.perhaps_least(indices(), least);
    if (next.empty()) break;
    polish_all(take_out(next), tally);  // where they come to nothing, others may be least
  }
  if (refined.empty()) return;
  const std::vector<std::size_t> beyond =
      discrete_.beyond_rivals(indices(), extremals_.least_action());
  tally_.converged += discrete_.give_up(beyond).all();
  take_out(beyond);
  polish_all(refined, tally);
}

void Search::polish_all(const Refinements& refined, Polished& tally) {
  std::vector<Outcome> polished(refined.size());
  parallel_for(static_cast<int>(refined.size()), threads_, [&](int i) {
    const auto& [index, refinement] = refined[i];
    if (stop_.reached()) return;
    polished[i] = polish(ladder_, options_, discrete_[index].path, refinement, stop_);
  });
  for (std::size_t i = 0; i < refined.size(); ++i) {
    DiscreteExtremal& discrete = discrete_[refined[i].first];
    furthest_ = std::max(furthest_, polished[i].reason);
    // No finer grid helps there: with them sideways parking to 1e-22 took 15 s to say so, not 7.
    if (polished[i].reason == Reason::kMethodTooCoarse ||
        polished[i].reason == Reason::kBeyondDouble) {
      discrete.fate = Fate::kTooRough;
      tally_.rough += discrete.hits.all();
      continue;
    }
    if (!polished[i].extremal) {
      discrete.fate = Fate::kArtefact;
      discrete.others.clear();
      ++tally.failed;
      continue;
    }
    discrete.fate = Fate::kExtremal;
    // Where shooting led elsewhere, a start on a finer grid may lead to the extremal itself. If
    // that counts as this one, 27 of 400 targets of falling-cat are missed instead of 13.
    if (!discrete.foretells(polished[i].extremal->geodesic.action)) discrete.others.clear();
    discrete.extremal = extremals_.add(*polished[i].extremal);
    extremals_.hit(discrete.extremal, discrete.hits);
    tally_.converged += discrete.hits.all();
    ++tally.good;
  }
}

void Search::take(const std::optional<Extremal>& extremal) {
  if (!extremal) return;
  extremals_.hit(extremals_.add(*extremal), kOneStart);
  ++tally_.converged;
}

void Search::take(const Outcome& outcome) {
  furthest_ = std::max(furthest_, outcome.reason);
  // Not beyond double: of momenta that are drawn some lead to long extremals, others to short ones.
  if (outcome.reason == Reason::kMethodTooCoarse) ++tally_.rough;
  take(outcome.extremal);
}

}  // namespace carnot::internal
