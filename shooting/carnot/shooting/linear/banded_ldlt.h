// Factors A = U'D U of a banded symmetric matrix that need not be definite, U with a unit diagonal.
//
// There are no pivots, so nothing leaves the band. That is stable for a quasi-definite matrix,
//
//   ( W  A' )
//   ( A  -C ),   W and C positive definite,
//
// in whatever order its rows are (Vanderbei, SIAM J. Optim. 5, 1995). The signs of D are those of
// the eigenvalues (Sylvester's law of inertia), so a count of the negative ones tells whether W is
// positive definite where A x = 0. Only the diagonal and what is above it are stored, row by row.
// Cost about size above^2 multiplications.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "carnot/shooting/linear/known_width.h"

namespace carnot::internal {

class BandedLdlt {
 public:
  // `above` diagonals above the main one.
  BandedLdlt(int size, int above)
      : size_(size),
        width_(above + 1),
        stride_((width_ + kPack - 1) / kPack * kPack + kPack),
        a_(static_cast<std::size_t>(size + width_) * stride_, 0.0) {}

  void clear() { std::fill(a_.begin(), a_.end(), 0.0); }

  // Entry (i, j), i <= j <= i + above.
  double& operator()(int i, int j) { return a_[static_cast<std::size_t>(i) * stride_ + (j - i)]; }

  // Overwrites the matrix by its factors. Returns how many of its eigenvalues are negative; nothing
  // where a pivot vanishes.
  [[nodiscard]] std::optional<int> factor() {
    int negative = 0;
    for (int i = 0; i < size_; ++i) {
      double* const row = &(*this)(i, i);
      if (!(std::abs(row[0]) > 0) || !std::isfinite(row[0])) return std::nullopt;
      negative += row[0] < 0 ? 1 : 0;
      row[0] = 1 / row[0];  // stays there: substitution is not to wait for divisions
      const int last = std::min(width_, size_ - i);
      for (int c = 1; c < last; ++c) {
        const double multiplier = row[c] * row[0];
        const double* const from = row + c;
        double* const below = &(*this)(i + c, i + c);
        for (int k = 0; k < last - c; k += kPack) {
#pragma GCC ivdep
          for (int l = 0; l < kPack; ++l) below[k + l] -= multiplier * from[k + l];
        }
      }
    }
    return negative;
  }

  // Overwrites `b` by the solution; after factor().
  void substitute(std::vector<double>& b) {
    // Paths with 2 to 6 coordinates. Measured with 124 rows of 8 entries: a substitution in 0.8 us
    // where it took 3.1.
    with_known_width<4, 6, 8, 10, 12>(
        width_, [this, &b](auto width) { substitute_rows<width()>(b.data()); });
  }

 private:
  // Calls eliminate(i, entries of row i) for each row in order, until one returns false.
  template <int width, class Eliminate>
  [[gnu::always_inline]] bool for_rows(const Eliminate& eliminate) const {
    int i = 0;
    for (; width > 0 && i + width <= size_; ++i) {
      if (!eliminate(i, width)) return false;
    }
    for (; i < size_; ++i) {
      if (!eliminate(i, std::min(width_, size_ - i))) return false;
    }
    return true;
  }

  template <int width>
  void substitute_rows(double* b) {
    (void)for_rows<width>([&](int i, int last) __attribute__((always_inline)) {
      const double* row = &(*this)(i, i);
      for (int c = 1; c < last; ++c) b[i + c] -= row[c] * row[0] * b[i];
      return true;
    });
    for (int i = size_ - 1; i >= 0; --i) {
      const double* row = &(*this)(i, i);
      const int last = std::min(width > 0 ? width : width_, size_ - i);
      double sum = b[i];
      for (int c = last - 1; c > 0; --c) sum -= row[c] * b[i + c];  // what is newest comes last
      b[i] = sum * row[0];
    }
  }

  // Rows are padded by zeros, so that the factor goes in whole packs, up to one beyond the end of a
  // row. Measured with 384 rows: of 9 entries in 5 us where it took 9, of 18 in 13 where it
  // took 19.
  static constexpr int kPack = 8;

  int size_;
  int width_;
  int stride_;  // from row to row
  std::vector<double> a_;
};

}  // namespace carnot::internal
