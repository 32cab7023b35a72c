#include "atlas/crew.h"

#include <atomic>
#include <future>
#include <mutex>

#include "atlas/chunk_list.h"
#include "text/interrupt.h"
#include "text/progress_bar.h"

namespace carnot::apps {

void CrewWork::drop_parts(Journal& journal) const {
  for (long k = 0; k < chunks(); ++k) {
    if (journal.holds(k) && journal.lines(k) != size_of(k)) journal.drop(k);
  }
}

long CrewWork::done(const Journal& journal) const {
  long count = 0;
  for (long k = 0; k < chunks(); ++k) {
    if (journal.holds(k)) count += size_of(k);
  }
  return count;
}

bool lead(Ranks& ranks, const CrewWork& work, Journal& journal, bool quiet) {
  const long resumed = work.done(journal);
  ChunkList list(journal, work.chunks());
  std::mutex mutex;
  std::atomic<long> known{resumed};
  const auto next = [&] { return list.next(); };
  const auto take = [&](long k, std::string_view text) {
    const std::lock_guard lock(mutex);
    journal.append(k, text);
    known += work.size_of(k);
  };
  const auto left = static_cast<double>(std::max(1L, work.problems - resumed));
  ProgressBar bar("problems", left, quiet);
  std::atomic<bool> failed{false};
  const Progress progress = [&, tell = bar.callback()](double /*of the chunks of this rank*/) {
    return !failed && tell(static_cast<double>(known - resumed) / left);
  };
  if (ranks.size() == 1) return work.solve(next, take, progress);
  auto own = std::async(std::launch::async, [&] {
    try {
      return work.solve(next, take, progress);
    } catch (...) {
      failed = true;  // the others get no more chunks
      throw;
    }
  });
  try {
    ranks.serve({next, take, [&] { return progress(0); }});
  } catch (...) {
    failed = true;  // the own work ends, too
    own.wait();
    throw;
  }
  return own.get() && known == work.problems;
}

bool follow(Ranks& ranks, const CrewWork& work) {
  const auto ask = [&] { return ranks.ask(); };
  const auto hand_in = [&](long k, const std::string& text) { ranks.hand_in(k, text); };
  try {
    const bool finished = work.solve(ask, hand_in, [](double) { return !interrupted(); });
    ranks.leave();
    return finished;
  } catch (...) {
    ranks.leave();
    throw;
  }
}

}  // namespace carnot::apps
