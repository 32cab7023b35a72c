// What may be asked of a steering function.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace carnot {

struct SteeringOptions {
  double time = 1;                // T; with V = 0 the path does not depend on it
  bool mod_angles = true;         // angles need to agree modulo their periods only
  std::vector<bool> free_target;  // which coordinates of targets are free; empty: none
  int starts = 0;            // paths to relax; 0: until the least action has been hit often enough
  double tolerance = 1e-10;  // largest endpoint error, in the natural scales of a question
  // |to - from| below which the path is estimated, in the natural scales of the scene: lengths over
  // that of a wheelbase, say. A scene without a length of its own is measured in its own units.
  double resolution = 1e-9;
  std::uint64_t seed = 0;
  int threads = 1;            // of one search
  std::size_t memory = 4096;  // answers kept, of about 4 KB each; the oldest are dropped
  // Asked now and then by every search, in its thread, whether to go on; empty: always. A search
  // that is stopped fails with Reason::kInterrupted, and is not kept.
  std::function<bool()> goes_on;
};

}  // namespace carnot
