// The candidates that a search with limits has found, on all rungs of the ladder of masses.
//
// A candidate of a heavier problem goes down rung by rung (mass_ladder.h) until it is one of the
// problem itself, at the foot. Hits go with it, and so do those that follow.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "carnot/shooting/search/limited_finish.h"

namespace carnot::internal {

class CandidateList {
 public:
  // Adds a candidate, or counts its hits for one that is known: nearly the same nodes and action,
  // on the same rung. Of the two the one on the finer grid is kept, or that of less action, since a
  // wall may pin a path to different nodes. Returns its place in the list.
  std::size_t note(Candidate candidate);
  [[nodiscard]] const Candidate& operator[](std::size_t place) const {
    return list_[place].candidate;
  }

  // Those of a rung that have not gone down: all, or those of little more action than the least one
  // of that rung.
  [[nodiscard]] std::vector<std::size_t> waiting_on(int rung, bool all) const;
  // Says where one of them went; nothing where it has no counterpart one rung down.
  void went_down(std::size_t place, std::optional<std::size_t> to);

  // How often the least one at the foot was hit; 0 where there is none.
  [[nodiscard]] int hits_of_least() const;
  // Those at the foot that nobody has tried to finish, least action first. Good until the next one
  // is noted.
  [[nodiscard]] std::vector<Candidate*> open();

 private:
  struct Entry {
    Candidate candidate;
    bool gone = false;
    std::optional<std::size_t> to;
  };

  std::vector<Entry> list_;
};

}  // namespace carnot::internal
