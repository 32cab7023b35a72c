// Who solves the chunks of an atlas: this process, and the ranks beside it.
#pragma once

#include <algorithm>
#include <functional>
#include <string>

#include "atlas/journal.h"
#include "atlas/ranks.h"

namespace carnot::apps {

struct CrewWork {
  long problems = 0;
  long chunk = 1;  // problems in each
  // Solves the chunks that `next` gives, until that is -1, and hands in their records. False when
  // `progress` has stopped it.
  std::function<bool(const std::function<long()>& next,
                     const std::function<void(long chunk, const std::string& text)>& hand_in,
                     const Progress& progress)>
      solve;

  [[nodiscard]] long chunks() const { return (problems + chunk - 1) / chunk; }
  [[nodiscard]] long size_of(long k) const { return std::min(chunk, problems - k * chunk); }
  // The last chunk of a list that has grown since is not whole: it is solved again.
  void drop_parts(Journal& journal) const;
  // How many problems the journal has the answers of.
  [[nodiscard]] long done(const Journal& journal) const;
};

// Rank 0: works on chunks and hands out others, until the journal has all. False when interrupted.
bool lead(Ranks& ranks, const CrewWork& work, Journal& journal, bool quiet);

// Another rank: asks for chunks until there are no more. False when interrupted.
bool follow(Ranks& ranks, const CrewWork& work);

}  // namespace carnot::apps
