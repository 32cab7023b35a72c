// Numbers of several problems of one shape side by side, one in each lane.
//
// What is calculated in a lane does not depend on what stands in the others.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "carnot/numerics/pack.h"

namespace carnot::internal {

inline constexpr int kLanes = 8;
using LanePack = Pack<kLanes>;

// One number of every lane, where packs may be loaded from and stored to without crossing a line of
// the cache.
struct alignas(kLanes * sizeof(double)) Lanes {
  std::array<double, kLanes> at{};

  Lanes() = default;
  explicit Lanes(const LanePack& x) { x.store(at.data()); }
  [[nodiscard]] LanePack pack() const { return LanePack::load(at.data()); }
  void set(const LanePack& x) { x.store(at.data()); }
  void add(const LanePack& x) { (pack() + x).store(at.data()); }
  [[nodiscard]] double* data() { return at.data(); }
  [[nodiscard]] const double* data() const { return at.data(); }
};

// Which lanes are meant.
struct ChosenLanes {
  std::array<bool, kLanes> lane{};

  bool& operator[](int l) { return lane[l]; }
  bool operator[](int l) const { return lane[l]; }
  [[nodiscard]] LanePack::Mask mask() const {
    Lanes chosen;
    for (int l = 0; l < kLanes; ++l) chosen.at[l] = lane[l] ? 1 : 0;
    return chosen.pack() > LanePack(0);
  }
};

// `to` becomes `from` in the lanes of the mask.
template <class LaneVector>
void take_lanes(const LanePack::Mask& mask, const LaneVector& from, LaneVector& to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i].set(select(mask, from[i].pack(), to[i].pack()));
  }
}

}  // namespace carnot::internal
