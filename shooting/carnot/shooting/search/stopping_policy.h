// When a search for extremals has seen enough.
//
// The search for one geodesic ends when the least action has been hit often enough, and the more
// starts converged the more rivals it has, and nothing seems to be missed: extremals that were hit
// once only say that there are others (Chao, Scand. J. Statist. 11, 1984). It ends somewhat sooner
// where most starts converge, most of them to one extremal, and nothing comes near its action. A
// search for more goes on to a limit. Where many starts were tried, every second round is one of
// crossings, in both.
#pragma once

#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/search/extremal_list.h"

namespace carnot::internal {

// What a search has done so far.
struct SearchTally {
  int starts = 0;               // that were tried, near hits and ways down among them
  int drawn = 0;                // of the sequence of starts
  int blocked = 0;              // that ran into a singularity of the coordinates
  int converged = 0;            // that led to an extremal, or to one that was given up
  int rough = 0;                // of them, that led to what is too rough to be verified
  int crossed = 0;              // crossings that were tried (crossing.h); they are among the starts
  int crossings_converged = 0;  // of those that converged
};

// How many starts a search asks for before it ends.
struct Caution {
  int easy;            // the least number, where most starts agree
  int starts;          // the least number, where they do not
  int sure;            // hits of the least action that are enough whatever seems to be missed
  int with_crossings;  // the same with hits by crossings
};

class StoppingPolicy {
 public:
  // `by_paths`: starts are paths, not momenta. `near`: paths are relaxed to a target further away.
  StoppingPolicy(const GeodesicOptions& options, bool by_paths, bool near);

  // For starts of drift: so many of scaled drift, which are all tried, and at most so many more.
  void plan_for(int scaled, int actuated);
  // For starts that are paths of so many coordinates. They are cheap, so there are more of them;
  // many coordinates, or angles only, take more caution still, and a higher limit.
  void plan_for_paths(int coordinates, bool only_angles);

  // More than the extremal of least action.
  [[nodiscard]] bool wants_more() const { return wants_more_; }
  // Fewer than asked for.
  [[nodiscard]] bool lacks(std::size_t extremals) const { return all_ || extremals < count_; }
  // Rounds of near hits after the starts.
  [[nodiscard]] int sweeps() const { return sweeps_; }

  // How many starts of the sequence may still be drawn. Those that ran into the end of the chart do
  // not count, or not before there are many.
  [[nodiscard]] int left(const SearchTally& tally) const;
  // How many to draw in the next round: fewer where the search may end after it.
  [[nodiscard]] int round(const SearchTally& tally) const;
  // Whether the next round is one of crossings.
  [[nodiscard]] bool turn_of_crossings(const SearchTally& tally) const;
  // The fraction done, before the sweeps.
  [[nodiscard]] double share(const SearchTally& tally) const;

  // Whether more starts would only say again that round-off is too large. Nothing was found.
  [[nodiscard]] bool are_in_vain(const SearchTally& tally) const;
  // Whether so many starts may be enough, whatever they led to.
  [[nodiscard]] bool may_end(const SearchTally& tally) const;
  // Whether they are. The best extremal is known to be a local minimum.
  [[nodiscard]] bool ends(const SearchTally& tally, const Competition& competition) const;

 private:
  bool wants_more_;
  bool all_;
  std::size_t count_;
  bool given_;  // the number of starts is that of the options
  bool near_;
  int limit_;
  bool by_drift_ = false;
  int first_ = 0;  // starts that are tried in any case
  Caution caution_;
  int enough_hits_;
  int sweeps_;
};

}  // namespace carnot::internal
