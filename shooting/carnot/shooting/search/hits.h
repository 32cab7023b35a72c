// How often an extremal was found.
#pragma once

namespace carnot::internal {

// Starts of the sequence are independent of each other, so they tell how many extremals were missed
// (Chao's estimate). Crossings (crossing.h) are made of what is known, so they do not.
struct Hits {
  int starts = 0;
  int crossings = 0;

  [[nodiscard]] int all() const { return starts + crossings; }

  Hits& operator+=(const Hits& other) {
    starts += other.starts;
    crossings += other.crossings;
    return *this;
  }
};
inline constexpr Hits kOneStart{1, 0};
inline constexpr Hits kOneCrossing{0, 1};

}  // namespace carnot::internal
