// The chunks that are still to be done, handed out one at a time.
#pragma once

#include <mutex>

#include "atlas/journal.h"

namespace carnot::apps {

// Safe to call from many threads, and while the journal grows.
class ChunkList {
 public:
  // Those that the journal does not hold now.
  ChunkList(const Journal& journal, long chunks);

  // -1: none are left.
  [[nodiscard]] long next();

 private:
  std::mutex mutex_;
  std::vector<long> left_;  // the next one last
};

}  // namespace carnot::apps
