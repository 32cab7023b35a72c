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

namespace carnot::internal {

class BandedLdlt {
 public:
  // `above` diagonals above the main one.
  BandedLdlt(int size, int above)
      : size_(size), width_(above + 1), a_(static_cast<std::size_t>(size) * width_, 0.0) {}

  void clear() { std::fill(a_.begin(), a_.end(), 0.0); }

  // Entry (i, j), i <= j <= i + above.
  double& operator()(int i, int j) { return a_[static_cast<std::size_t>(i) * width_ + (j - i)]; }

  // Overwrites the matrix by its factors. Returns how many of its eigenvalues are negative; nothing
  // where a pivot vanishes.
  [[nodiscard]] std::optional<int> factor() {
    int negative = 0;
    for (int i = 0; i < size_; ++i) {
      const double* row = &(*this)(i, i);
      if (!(std::abs(row[0]) > 0) || !std::isfinite(row[0])) return std::nullopt;
      negative += row[0] < 0 ? 1 : 0;
      const int last = std::min(width_, size_ - i);
      for (int c = 1; c < last; ++c) {
        if (row[c] == 0) continue;
        const double multiplier = row[c] / row[0];
        double* below = &(*this)(i + c, i + c);
        for (int k = c; k < last; ++k) below[k - c] -= multiplier * row[k];
      }
    }
    return negative;
  }

  // Overwrites `b` by the solution; after factor().
  void substitute(std::vector<double>& b) {
    for (int i = 0; i < size_; ++i) {
      const double* row = &(*this)(i, i);
      const int last = std::min(width_, size_ - i);
      const double scaled = b[i] / row[0];
      for (int c = 1; c < last; ++c) b[i + c] -= row[c] * scaled;
    }
    for (int i = size_ - 1; i >= 0; --i) {
      const double* row = &(*this)(i, i);
      const int last = std::min(width_, size_ - i);
      double sum = b[i];
      for (int c = 1; c < last; ++c) sum -= row[c] * b[i + c];
      b[i] = sum / row[0];
    }
  }

 private:
  int size_;
  int width_;
  std::vector<double> a_;
};

}  // namespace carnot::internal
