// The search for extremals: the growing list of those that are distinct.
//
// Rounds of starts are relaxed, tightened and, where new, polished and verified; rounds of near
// hits follow where more than the best is wanted. The order of the starts decides the order of the
// list, so it does not depend on the number of threads.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/extremal/symmetry.h"
#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/reason.h"
#include "carnot/shooting/search/near_target.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

class Search {
 public:
  // Keeps references to both.
  Search(const BoundaryValueProblem& problem, const GeodesicOptions& options)
      : problem_(problem),
        options_(options),
        threads_(thread_count(options.threads)),
        symmetries_(symmetries_of(problem)),
        near_(NearTarget::of(problem)) {}

  // Runs rounds of starts until the list is good enough. False when interrupted.
  bool run();

  // Polishes one guess of p0 instead.
  void polish_guess();

  // None longer than options.max_length, unless `longer` ones are asked for too.
  [[nodiscard]] std::vector<Extremal> extremals(bool longer = false) const;
  // How often each was hit, up to symmetry.
  [[nodiscard]] std::vector<int> hits() const;
  [[nodiscard]] int starts() const { return starts_; }
  [[nodiscard]] int converged() const { return converged_; }
  // How many starts ran into a singularity of the coordinates.
  [[nodiscard]] int blocked() const { return blocked_; }
  // How far the best attempt came that did not become an extremal.
  [[nodiscard]] Reason furthest() const { return furthest_; }
  // The discrete extremal of least action; null where there is none. And the least residual that a
  // path was tightened to, relative to its momenta.
  [[nodiscard]] const Path* nearest_discrete() const;
  [[nodiscard]] double least_residual() const { return least_residual_; }

 private:
  static constexpr int kSegments = 8;      // of multiple shooting; divides the intervals of a path
  static constexpr long kFirstSteps = 32;  // of the method over [0, T]

  static constexpr int kNone = -1;
  static constexpr int kPending = -2;
  static constexpr int kTooLong = -3;

  // A relaxed path.
  struct Candidate {
    bool found = false;    // it satisfies the discrete equations
    bool relaxed = false;  // or it joins the ends of the problem and nearly does
    bool blocked = false;  // the coordinates end where it went
    int stiffness = 0;     // how often the penalty had to be raised
    double residual = std::numeric_limits<double>::infinity();  // relative to the momenta
    Path path;
  };

  [[nodiscard]] bool wants_more() const { return options_.all || options_.count > 1; }
  // Fewer extremals than asked for.
  [[nodiscard]] bool lacks() const;
  // The search for one geodesic ends when the least action has been hit often enough, and the more
  // often the more rivals it has; not while the best extremal is past a conjugate time, since then
  // a nearby path is better. It ends somewhat sooner where most starts converge, most of them to
  // one extremal, and nothing comes near its action. A search for more goes on to the limit.
  [[nodiscard]] bool settled();
  void relax_round(int count);
  // The same from momenta, where there is no transcription.
  void momentum_round(int count);
  // Along the straight line, by polish.h; to near targets, whose paths are relaxed to others.
  void shoot_straight();
  // From the path of least action, of those that Newton's method on the grid did not make discrete
  // extremals of.
  void shoot_along_relaxed(const std::vector<Candidate>& candidates);
  // Goes down from the best extremal, which is no minimum. False where that gives nothing better.
  bool descend_round();
  // Energies from that of the shortest extremal to twice that, or to the longest one; in every
  // second round to that of the largest length, where one is asked for.
  void sweep_round(int round);
  // By multiple shooting from the trajectories themselves, those that Newton's method on the grid
  // did not make discrete extremals of: grids do not see what happens where the frame loses rank.
  void shoot_near_hits(const std::vector<Path>& paths, const std::vector<Candidate>& candidates);
  // What became of new discrete extremals.
  struct Polished {
    int good = 0;
    int failed = 0;  // mostly artefacts of a coarse grid
  };
  // Polishes what is new among the candidates and adds it to the list.
  Polished absorb(const std::vector<Candidate>& candidates);
  // Those of discrete_ that are worth polishing next, of the pending ones `fresh`; the others wait
  // or, where only the least action is wanted and theirs is clearly more, are given up.
  std::vector<std::size_t> next_to_polish(std::vector<std::size_t>& fresh);
  [[nodiscard]] Candidate relax_start(int i) const;
  [[nodiscard]] std::size_t best() const;
  // What polishing gave, and where it ended if it did not give anything.
  struct Outcome {
    std::optional<Extremal> extremal;
    Reason reason = Reason::kNone;
  };
  // Of extremal `index`, if it is one.
  void count_hit(int index);
  // The same as below, and remembers how far it came.
  int add(const Outcome& outcome);
  // Adds what is new, and its mirror partners. Returns the index in the list, or -1.
  int add(const std::optional<Extremal>& extremal, int partner_of = kNone);
  // The one that stands for it and its mirror partners.
  [[nodiscard]] int root(int index) const {
    while (partner_of_[index] >= 0) index = partner_of_[index];
    return index;
  }
  // Index of a discrete extremal with the same nodes, or with those of its mirror partner, which
  // add() finds by itself; discrete_.size() when it is new.
  [[nodiscard]] std::size_t find_discrete(const Path& path) const;
  static bool same_nodes(const Path& a, const Path& b);

  // A discrete extremal that has been seen.
  struct Discrete {
    Path path;
    double action = 0;
    int extremal = kPending;  // the one it became, kNone, kPending or kTooLong,
    int pending_hits = 1;     // and how often it was seen before it became one
    int descents = 0;         // how often the ways down from it were taken, on finer grids each
  };

  const BoundaryValueProblem& problem_;
  const GeodesicOptions& options_;
  int threads_;
  std::vector<ProblemSymmetry> symmetries_;
  std::optional<NearTarget> near_;  // where paths are relaxed to a target further away
  std::vector<Extremal> extremals_;
  std::vector<int> hits_;
  std::vector<int> partner_of_;  // the extremal whose mirror image it is, or kNone
  int stiffness_ = 0;            // how often most starts of a round had to raise the penalty
  int intervals_ = 32;           // of the grid that paths are relaxed on
  bool descends_ = false;        // the best extremal so far is no minimum
  std::vector<Discrete> discrete_;
  Reason furthest_ = Reason::kNone;
  double least_residual_ = std::numeric_limits<double>::infinity();
  int starts_ = 0;
  int drawn_ = 0;  // of the sequence of starts; the others are near hits
  int blocked_ = 0;
  int converged_ = 0;
};

}  // namespace carnot::internal
