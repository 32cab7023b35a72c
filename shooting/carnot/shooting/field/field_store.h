// What is known of the points of a field, in little memory.
//
// A point takes 8 (2n + n^2 + n(n+1)/2) bytes of numbers and 16 + 2a bytes besides, with a axes:
// 190 for three coordinates, 296 for four. Different points may be read and written by different
// threads.
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/field/field_bytes.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {

// What is known of a point. In the natural scales of the problem (natural_scales.h).
struct FieldPoint {
  std::int8_t sign = 0;  // of det J
  int origin = -1;       // the seed that it comes from
  double action = 0;
  SmallVector p0;
  SmallVector p1;  // p(T)
  SmallMatrix inverse;
  SmallMatrix slope;          // S, which is symmetric
  std::vector<int> windings;  // whole periods of the axes, added to the target
};

class FieldStore {
 public:
  // Of so many points with n coordinates, on a grid of so many axes.
  FieldStore(long points, int n, std::size_t axes);

  [[nodiscard]] long size() const { return static_cast<long>(states_.size()); }
  [[nodiscard]] bool known(long i) const { return states_[i].known; }
  [[nodiscard]] double action(long i) const { return states_[i].action; }
  // Whether point i has more than this action, or nothing.
  [[nodiscard]] bool is_more(long i, double action) const {
    constexpr double kBetter = 1e-10;  // relative; less is round-off
    return !known(i) || action < (1 - kBetter) * states_[i].action;
  }
  [[nodiscard]] std::int8_t sign(long i) const { return states_[i].sign; }
  // Whether a neighbour has promised less since, and Newton's method failed.
  [[nodiscard]] bool doubted(long i) const { return states_[i].doubted; }
  void doubt(long i) { states_[i].doubted = true; }

  // Point i, which is known.
  [[nodiscard]] FieldPoint point(long i) const;
  [[nodiscard]] SmallVector p0(long i) const;
  [[nodiscard]] std::vector<int> windings(long i) const;
  // Makes it known; that is news for its neighbours.
  void put(long i, const FieldPoint& point);
  // The same without news: the point is the same, more exactly.
  void replace(long i, const FieldPoint& point);
  // Who may be told of news: neighbours in the same slab, and those across a border, up and down.
  enum Whom : std::uint8_t { kSlab = 1, kUp = 2, kDown = 4 };
  // Whether there is news of point i for these.
  [[nodiscard]] bool has_news(long i, Whom whom) const { return (states_[i].news & whom) != 0; }
  // There is none any more.
  void told(long i, Whom whom) {
    states_[i].news = static_cast<std::uint8_t>(states_[i].news & ~whom);
  }

  void write(ByteWriter& out) const;
  // What a store of the same sizes has written. Throws DamagedBytes.
  void read(ByteReader& in);

 private:
  struct State {
    double action = 0;
    int origin = -1;
    std::uint8_t news = 0;  // a bit for each that has not been told of the last improvement
    std::int8_t sign = 0;
    bool known = false;
    bool doubted = false;
  };

  [[nodiscard]] const double* numbers(long i) const { return &numbers_[i * width_]; }

  int n_;
  std::size_t axes_;
  std::size_t width_;  // numbers of a point
  std::vector<State> states_;
  std::vector<double> numbers_;  // p(0), p(T), the inverse, the lower triangle of S
  std::vector<std::int16_t> windings_;
};

}  // namespace carnot::internal
