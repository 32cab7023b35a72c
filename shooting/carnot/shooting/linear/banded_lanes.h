// Factors A = U'D U of banded symmetric matrices side by side, U with a unit diagonal.
//
// The method is that of banded_ldlt.h, without pivots. Of each row the diagonal and what is right
// of it is stored. Cost about size width^2 / 2 multiplications for all lanes together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "carnot/shooting/linear/kept_memory.h"
#include "carnot/shooting/linear/known_width.h"
#include "carnot/shooting/linear/lanes.h"

namespace carnot::internal {

class BandedLanes {
  // So that a row may stay in registers.
  template <class Run>
  auto with_known(const Run& run) const {
    return with_known_width<4, 6, 8, 10, 12, 14, 16>(width_, run);
  }

 public:
  // Rows of `width` numbers, the diagonal being the first. Beyond the last row there are as many of
  // zeros, so that each row is eliminated from as many others.
  BandedLanes(int size, int width)
      : size_(size), width_(width), a_(static_cast<std::size_t>(size + width) * width) {}

  // Entry (i, j), i <= j < i + width.
  Lanes& operator()(int i, int j) { return a_[static_cast<std::size_t>(i) * width_ + (j - i)]; }
  [[nodiscard]] const Lanes& operator()(int i, int j) const {
    return a_[static_cast<std::size_t>(i) * width_ + (j - i)];
  }
  // Becomes `other` in the lanes of the mask.
  void take(const LanePack::Mask& mask, const BandedLanes& other) {
    take_lanes(mask, other.a_, a_);
  }

  // Becomes the factors of `of`, of the same shape, with `more` on its diagonal. Returns 1 in the
  // lanes where all pivots are positive, else 0: whether the matrix is positive definite.
  LanePack factor(const BandedLanes& of, const std::vector<Lanes>& more) {
    return with_known([&](auto width) { return factor_rows<width()>(of, more); });
  }
  // The largest number of U, after factor(): what was divided by a small pivot is large, and with
  // it the round-off of what follows.
  [[nodiscard]] LanePack largest_multiplier() const {
    LanePack most(0);
    for (int i = 0; i < size_; ++i) {
      const LanePack inverse = (*this)(i, i).pack();
      for (int c = 1; c < width_; ++c) most = max(most, abs((*this)(i, i + c).pack() * inverse));
    }
    return most;
  }
  // Overwrites `b` by the solutions; after factor().
  void substitute(std::vector<Lanes>& b) const {
    with_known([this, &b](auto width) { substitute_rows<width()>(b); });
  }

 private:
  template <int known>
  LanePack factor_rows(const BandedLanes& of, const std::vector<Lanes>& more) {
    const int width = known > 0 ? known : width_;
    // Rows are copied just before the first of them is eliminated from, which waits for its pivot.
    const auto copy = [&](int i) {
      Lanes* const to = &(*this)(i, i);
      const Lanes* const from = &of(i, i);
      for (int c = 0; c < width; ++c) to[c].set(from[c].pack());
      if (i < size_) to[0].add(more[i].pack());
    };
    for (int i = 0; i + 1 < width; ++i) copy(i);
    LanePack positive(1);
    for (int i = 0; i < size_; ++i) {
      copy(i + width - 1);
      Lanes* const row = &(*this)(i, i);
      const LanePack pivot = row[0].pack();
      positive = select(pivot > LanePack(0), positive, LanePack(0));
      const LanePack inverse = LanePack(1) / pivot;
      row[0].set(inverse);  // stays there: substitution is not to wait for divisions
      for (int c = 1; c < width; ++c) {
        const LanePack multiplier = row[c].pack() * inverse;
        Lanes* const below = row + c * width;
        for (int k = 0; k < width - c; ++k) below[k].add(-(multiplier * row[c + k].pack()));
      }
    }
    return positive;
  }

  template <int known>
  void substitute_rows(std::vector<Lanes>& b) const {
    const int width = known > 0 ? known : width_;
    for (int i = 0; i < size_; ++i) {
      const Lanes* const row = &(*this)(i, i);
      const LanePack x = row[0].pack() * b[i].pack();
      const int last = std::min(width, size_ - i);
      for (int c = 1; c < last; ++c) b[i + c].add(-(row[c].pack() * x));
    }
    for (int i = size_ - 1; i >= 0; --i) {
      const Lanes* const row = &(*this)(i, i);
      const int last = std::min(width, size_ - i);
      LanePack sum = b[i].pack();
      for (int c = last - 1; c > 0; --c) sum -= row[c].pack() * b[i + c].pack();  // the newest last
      b[i].set(sum * row[0].pack());
    }
  }

  int size_;
  int width_;
  std::vector<Lanes, KeptMemory<Lanes>> a_;
};

}  // namespace carnot::internal
