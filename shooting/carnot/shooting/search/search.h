// The search for extremals, round by round.
//
// Rounds of starts are relaxed, tightened and, where new, polished and verified. Where many starts
// do not agree, rounds of crossings take turns with them (crossing.h); rounds of near hits follow
// where more than the best is wanted. What is found goes into two lists (extremal_list.h,
// discrete_list.h), and stopping_policy.h says when it is enough. The order of the starts decides
// the order of the lists, so it does not depend on the number of threads.
#pragma once

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/problem/mass_ladder.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/search/discrete_list.h"
#include "carnot/shooting/search/drift_starts.h"
#include "carnot/shooting/search/relaxed_start.h"
#include "carnot/shooting/search/stopping_policy.h"

namespace carnot::internal {

class Search {
 public:
  // Keeps references to both.
  Search(const BoundaryValueProblem& problem, const GeodesicOptions& options);

  // Runs rounds of starts until the list is good enough. False when interrupted.
  bool run();

  // Polishes one guess of p0 instead.
  void polish_guess();

  // None longer than options.max_length, unless `longer` ones are asked for too.
  [[nodiscard]] std::vector<Extremal> extremals(bool longer = false) const {
    return extremals_.up_to(longer ? std::numeric_limits<double>::infinity() : options_.max_length);
  }
  // How often starts hit each, up to symmetry, and each that was given up. Zero for those that only
  // crossings led to.
  [[nodiscard]] std::vector<int> hits() const;
  // Whether they tell how many were missed. Starts of drift find minima, and some find none but
  // one: there the least must have been hit often, and nothing once only.
  [[nodiscard]] bool counts() const;
  [[nodiscard]] int starts() const { return tally_.starts; }
  [[nodiscard]] int converged() const { return tally_.converged; }
  // Whether the search ended since its time was up.
  [[nodiscard]] bool timed_out() const { return stop_.late(); }
  // How many starts ran into a singularity of the coordinates.
  [[nodiscard]] int blocked() const { return tally_.blocked; }
  // How far the best attempt came that did not become an extremal.
  [[nodiscard]] Reason furthest() const { return furthest_; }
  // Whether coordinates were given more mass at first (mass_ladder.h).
  [[nodiscard]] bool has_light_masses() const { return ladder_.height() > 0; }
  // The discrete extremal of least action, on the lowest rung; null where there is none.
  [[nodiscard]] const Path* nearest_discrete() const { return discrete_.least(); }
  // The least residual that a path was tightened to, relative to its momenta.
  [[nodiscard]] double least_residual() const { return least_residual_; }
  // Whether there may be abnormal curves; and the least action of paths that were pulled tight and
  // of which Newton's method made no discrete extremals (abnormal_search.h).
  [[nodiscard]] bool seeks_abnormal() const { return seeks_abnormal_; }
  [[nodiscard]] double least_relaxed() const { return least_relaxed_; }

 private:
  static constexpr int kSegments = 8;      // of multiple shooting; divides the intervals of a path
  static constexpr long kFirstSteps = 32;  // of the method over [0, T]

  // The verified mirror partners, where more than the best extremal is wanted.
  [[nodiscard]] static ExtremalList::Partners partners_for(const BoundaryValueProblem& problem,
                                                           const GeodesicOptions& options,
                                                           const StoppingPolicy& policy);
  // Whether there is an answer, and as many starts as it takes to ask whether it is enough.
  [[nodiscard]] bool may_end() const;
  // Whether the best extremal is past a conjugate time: then a nearby path is better, and the
  // search goes on from there.
  [[nodiscard]] bool best_is_passed();
  // Whether what was found says that little can be missing.
  [[nodiscard]] bool settled() const;
  // Whether momenta take turns with starts of drift: while these found nothing.
  [[nodiscard]] bool turn_of_momenta() const;
  void relax_round(int count);
  // The next starts of the sequence, relaxed. Some may have been made ahead.
  [[nodiscard]] std::vector<RelaxedStart> next_starts(int count);
  // The same from crossings of what is known (crossing.h). False where too little is known.
  [[nodiscard]] bool cross_round(int count);
  // The grid of the next round of starts, or of crossings, of which `drawn` were tried before.
  [[nodiscard]] int intervals_of_round(int drawn) const;
  // The same where the scene has no transcription of its own.
  void drift_round(int count);
  // The same from momenta, where forces keep the path on a manifold.
  void momentum_round(int count);
  // Shoots along the straight line. This helps where paths are relaxed to another target.
  void shoot_straight();
  // Newton's method on the grid did not make discrete extremals of some relaxed paths. Remembers
  // the least action of these where there may be abnormal curves.
  void note_relaxed(const std::vector<RelaxedStart>& starts);
  // Shoots along the one of least action among these. Where one geodesic is wanted and there is
  // one, that is not worth its time: a fifth of that of a search (vehicle, 60 random targets).
  void shoot_along_relaxed(const std::vector<RelaxedStart>& starts);
  // Goes down from the best extremal, which is no minimum. False where that gives nothing better.
  bool descend_round();
  // Newton's method on the end point from random momenta of less energy than the best extremal has,
  // where forces keep the path on a manifold; once for each best extremal that is a minimum. True
  // where that finds a better one. Paths find few of the basins there: without momenta 7 of 200
  // answers for random targets of skate-on-sphere were not the least, now all are, in 1.1 times the
  // time. To one of them one path of 500 leads, and one momentum of four.
  [[nodiscard]] bool shoot_below();
  [[nodiscard]] bool shoots_below() const {
    return problem_.dynamics.forced > 0 && !policy_.wants_more();
  }
  // Standard deviations of random momenta.
  [[nodiscard]] std::vector<double> momentum_scale() const;
  // Near hits (sweep.h) on energies from that of the shortest extremal to twice that, or to that of
  // the longest one; in every second round to that of the largest length, where one is asked for.
  void sweep_round(int round);
  // Grids do not see what happens where the frame loses rank. So the near hits of which Newton's
  // method on the grid did not make discrete extremals are joined by multiple shooting.
  void shoot_near_hits(const std::vector<Path>& paths, const std::vector<RelaxedStart>& tightened);

  // What became of new discrete extremals.
  struct Polished {
    int good = 0;
    int failed = 0;  // mostly artefacts of a coarse grid
  };
  // Polishes what is new among paths that were tightened, and adds it to the list. Each that was
  // found counts as `each`.
  Polished absorb(const std::vector<RelaxedStart>& starts, const Hits& each = kOneStart);
  // Adds the path to the discrete extremals where it is new. Else counts it as a hit.
  void note(const Path& path, const Hits& found, std::vector<std::size_t>& fresh);
  // Counts hits of a discrete extremal that is known.
  void hit(DiscreteExtremal& known, const Hits& hits);
  // New discrete extremals on finer grids, by their indices; without those that become known ones.
  using Refinements = std::vector<std::pair<std::size_t, Refinement>>;
  Refinements refine_all(const std::vector<std::size_t>& indices, Polished& tally);
  // Polishes those that may have the least action, then their rivals, and gives up the others.
  void polish_least(Refinements refined, Polished& tally);
  void polish_all(const Refinements& refined, Polished& tally);
  // Adds an extremal that a start led to, if it did, and counts the hit.
  void take(const std::optional<Extremal>& extremal);
  // The same, and remembers how far an attempt came that failed.
  void take(const Outcome& outcome);

  const BoundaryValueProblem& problem_;
  const GeodesicOptions& options_;
  double shown_ = 0;  // of the search is done; does not fall where crossings raise the limit
  Stop stop_;
  int threads_;
  std::optional<NearTarget> near_;    // where paths are relaxed to a target further away
  std::optional<DriftStarts> drift_;  // where the scene has no transcription of its own
  StoppingPolicy policy_;
  ExtremalList extremals_;
  MassLadder ladder_;
  DiscreteList discrete_;
  SearchTally tally_;
  // Starts that were relaxed and not yet looked at, and how.
  struct Ahead {
    int stiffness = 0;
    std::vector<StartDraw> draws;
    std::vector<RelaxedStart> starts;
  };
  Ahead ahead_;
  Reason furthest_ = Reason::kNone;
  double least_residual_ = std::numeric_limits<double>::infinity();
  bool seeks_abnormal_;
  double least_relaxed_ = std::numeric_limits<double>::infinity();
  int stiffness_ = 0;  // how often most starts of a round had to raise the penalty
  // Of the coarsest grid that paths are relaxed on. On the targets of stopping_policy.cc the median
  // search on 16 intervals takes 0.54 to 0.68 of the time of 32, and 0.92 on trailer2; answers are
  // the same but for hard targets. On 8 intervals 11 of 60 targets of falling-cat are missed
  // instead of 4.
  int intervals_ = 16;
  bool descends_ = false;  // the best extremal so far is no minimum
  // The least action that there was when momenta were tried below it.
  double shot_below_ = std::numeric_limits<double>::infinity();
};

}  // namespace carnot::internal
