#include "atlas/chunk_list.h"

namespace carnot::apps {

ChunkList::ChunkList(const Journal& journal, long chunks) {
  for (long k = chunks - 1; k >= 0; --k) {
    if (!journal.holds(k)) left_.push_back(k);
  }
}

long ChunkList::next() {
  const std::lock_guard lock(mutex_);
  if (left_.empty()) return -1;
  const long chunk = left_.back();
  left_.pop_back();
  return chunk;
}

}  // namespace carnot::apps
