// What is known of the points of a field, in little memory.
//
// A point keeps a few extremals, its branches, each in a slot. A slot takes
// 8 (2n + n^2 + n(n+1)/2) bytes of numbers and 16 + 2a bytes besides, with a axes: 190 for three
// coordinates, 296 for four. Different points may be read and written by different threads.
#pragma once

#include <cstdint>
#include <optional>
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

// A place for an extremal of a point.
enum class FieldSlot : long {};

class FieldStore {
 public:
  // Of so many points with n coordinates, on a grid of so many axes, with so many slots each.
  FieldStore(long points, int n, std::size_t axes, int branches);

  [[nodiscard]] long size() const { return static_cast<long>(doubted_.size()); }
  [[nodiscard]] int branches() const { return branches_; }
  [[nodiscard]] FieldSlot slot(long i, int branch) const {
    return FieldSlot{i * branches_ + branch};
  }
  [[nodiscard]] long point_of(FieldSlot slot) const { return at(slot) / branches_; }

  // Of point i. The first of its slots is filled first.
  [[nodiscard]] bool known(long i) const { return is_filled(slot(i, 0)); }
  // The slot of its least action, where it is known.
  [[nodiscard]] FieldSlot best(long i) const;
  [[nodiscard]] double action(long i) const { return action(best(i)); }
  // Whether it would take an extremal of this action that it does not have.
  [[nodiscard]] bool wants(long i, double action) const;
  // Whether a neighbour has promised less since it had its least action, and Newton's method
  // failed.
  [[nodiscard]] bool doubted(long i) const { return doubted_[i] != 0; }
  void doubt(long i) {
    doubted_[i] = 1;
    states_[at(slot(i, 0))].changed = true;
  }
  // Keeps an extremal where it is wanted: in the slot of the same one, if it has less there, or
  // else in a free one or that of the most action. That is news for its neighbours. Returns the
  // slot.
  std::optional<FieldSlot> put(long i, const FieldPoint& point);

  [[nodiscard]] bool is_filled(FieldSlot slot) const { return states_[at(slot)].known; }
  // Of a slot that is filled, as all that follow.
  [[nodiscard]] double action(FieldSlot slot) const { return states_[at(slot)].action; }
  [[nodiscard]] std::int8_t sign(FieldSlot slot) const { return states_[at(slot)].sign; }
  [[nodiscard]] FieldPoint point(FieldSlot slot) const;
  [[nodiscard]] SmallVector p0(FieldSlot slot) const;
  [[nodiscard]] std::vector<int> windings(FieldSlot slot) const;
  // Keeps the same extremal, made more exactly, without news.
  void replace(FieldSlot slot, const FieldPoint& point);
  // Who may be told of news: neighbours in the same slab, and those across a border, up and down.
  enum Whom : std::uint8_t { kSlab = 1, kUp = 2, kDown = 4 };
  // Whether there is news of a slot for these; never of one that is not filled.
  [[nodiscard]] bool has_news(FieldSlot slot, Whom whom) const {
    return (states_[at(slot)].news & whom) != 0;
  }
  // There is none any more.
  void told(FieldSlot slot, Whom whom) {
    State& state = states_[at(slot)];
    state.news = static_cast<std::uint8_t>(state.news & ~whom);
    state.changed = true;
  }

  // What has changed in slots that are filled, since the last call of this or of the next one.
  void write_changes(ByteWriter& out);
  void forget_changes();
  // What another store of the same sizes has written so. Returns the slots. Throws DamagedBytes.
  std::vector<FieldSlot> read_changes(ByteReader& in);

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
    bool changed = false;  // and not written since
  };

  static long at(FieldSlot slot) { return static_cast<long>(slot); }
  [[nodiscard]] const double* numbers(FieldSlot slot) const { return &numbers_[at(slot) * width_]; }
  [[nodiscard]] bool is_more(FieldSlot slot, double action) const;
  [[nodiscard]] bool is_same(FieldSlot slot, const FieldPoint& point) const;
  // Where an extremal of point i belongs, if it is wanted.
  [[nodiscard]] std::optional<FieldSlot> place_of(long i, const FieldPoint& point) const;

  int n_;
  std::size_t axes_;
  int branches_;
  std::size_t width_;  // numbers of a slot
  std::vector<State> states_;
  std::vector<double> numbers_;  // p(0), p(T), the inverse, the lower triangle of S
  std::vector<std::int16_t> windings_;
  std::vector<std::uint8_t> doubted_;  // of points
};

}  // namespace carnot::internal
