// The discrete extremals that a search has seen, and what became of each.
//
// A discrete extremal that is known is not polished again. What it became counts as hit instead. It
// is known on the grid that it was found on and on those that it was refined to, so that starts on
// finer grids find it known. Of what a coarse grid parts in two, both halves become one on a finer
// grid; they are merged there.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "carnot/shooting/extremal/symmetry.h"
#include "carnot/shooting/problem/mass_ladder.h"
#include "carnot/shooting/search/extremal_list.h"

namespace carnot::internal {

enum class Fate {
  kPending,   // it waits to be polished,
  kExtremal,  // it became an extremal of the list,
  kArtefact,  // polishing it gave nothing,
  kTooRough,  // there is an extremal that round-off or the method's error keeps from its end,
  kGivenUp,   // its action is clearly more than the least and only that is wanted,
  kMerged     // or on a finer grid it is another one, which has its paths and hits
};

struct DiscretePath {
  Path path;
  double action = 0;
};

struct DiscreteExtremal {
  Path path;
  double action = 0;
  Fate fate = Fate::kPending;
  std::size_t extremal = 0;  // the index of the one that it became
  Hits hits;                 // how often it was seen before it became one
  int descents = 0;          // how often the ways down from it were taken, on finer grids each
  std::vector<DiscretePath> others;  // the same on finer grids, and what was merged into it
  // The action without the error of the grids, and how much that may be off. Of two grids the
  // combination (4 fine - coarse)/3 (refinement.h); a whole correction is allowed for.
  double estimate = 0;
  double uncertainty = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool foretells(double action_of_extremal) const {
    return std::abs(action_of_extremal - estimate) <= uncertainty;
  }
};

class DiscreteList {
 public:
  // Keeps a reference to the ladder.
  explicit DiscreteList(const MassLadder& ladder)
      : ladder_(ladder), symmetries_(symmetries_of(ladder.on(0))) {}

  [[nodiscard]] std::size_t size() const { return list_.size(); }
  [[nodiscard]] DiscreteExtremal& operator[](std::size_t index) { return list_[index]; }
  [[nodiscard]] auto begin() { return list_.begin(); }
  [[nodiscard]] auto end() { return list_.end(); }
  [[nodiscard]] auto begin() const { return list_.begin(); }
  [[nodiscard]] auto end() const { return list_.end(); }

  // The index of a path with the same nodes, or with those of a mirror partner, on the same grid;
  // size() where the path is new. All members of one family of `extremals` count as the same.
  [[nodiscard]] std::size_t find(const Path& path, const ExtremalList& extremals) const;
  // Adds a path that is new, with the hit that found it. Returns its index.
  std::size_t add(const Path& path, const Hits& found);
  // Remembers what it is on finer grids, from coarse to fine. Where one of these is known already,
  // it is merged into the known one. Returns the index of the one that it is now.
  std::size_t refine(std::size_t index,
                     const std::vector<Path>& finer,
                     const ExtremalList& extremals);

  // Takes out of `pending` those that may have the least action, as far as their grids tell.
  [[nodiscard]] std::vector<std::size_t> take_promising(std::vector<std::size_t>& pending) const;
  // Those of `refined` that may have less action than the best extremal, which has `least`, and
  // than each other, as far as their grids tell.
  [[nodiscard]] std::vector<std::size_t> perhaps_least(const std::vector<std::size_t>& refined,
                                                       double least) const;
  // Those of `refined` that are no rivals of the best extremal, which has the action `least`.
  [[nodiscard]] std::vector<std::size_t> beyond_rivals(const std::vector<std::size_t>& refined,
                                                       double least) const;
  // Gives these up. Returns how often they were seen.
  Hits give_up(const std::vector<std::size_t>& pending);

  // How often each of those given up was seen: of the grid where that was most often, for another
  // grid shows the same ones again.
  [[nodiscard]] std::vector<Hits> hits_given_up() const;
  // The path of least action, on the lowest rung that any is known on; null where there is none.
  [[nodiscard]] const Path* least() const;
  // At most `count` paths of extremals and of those given up, least action first. They are valid
  // until the list changes.
  [[nodiscard]] std::vector<const Path*> least(int count) const;

 private:
  [[nodiscard]] double action_of(const Path& path) const;

  const MassLadder& ladder_;
  std::vector<ProblemSymmetry> symmetries_;
  std::vector<DiscreteExtremal> list_;
};

}  // namespace carnot::internal
