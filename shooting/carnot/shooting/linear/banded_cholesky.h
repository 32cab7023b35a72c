// Cholesky factors of a banded symmetric positive definite matrix, A = U'D^-1 U with D = diag U.
//
// Without pivots nothing leaves the band (Golub & Van Loan, Matrix Computations, 4.3.6). Only the
// diagonal and what is above it are stored, row by row. Cost about size above^2 multiplications.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace carnot::internal {

class BandedCholesky {
 public:
  // `above` diagonals above the main one.
  BandedCholesky(int size, int above)
      : size_(size), width_(above + 1), a_(static_cast<std::size_t>(size) * width_, 0.0) {}

  void clear() { std::fill(a_.begin(), a_.end(), 0.0); }

  // Entry (i, j), i <= j <= i + above.
  double& operator()(int i, int j) { return a_[static_cast<std::size_t>(i) * width_ + (j - i)]; }

  // Overwrites the matrix by its factors. False where it is not positive definite.
  [[nodiscard]] bool factor() {
    for (int i = 0; i < size_; ++i) {
      const double* row = &(*this)(i, i);
      if (!(row[0] > 0)) return false;
      const int last = std::min(width_, size_ - i);
      for (int c = 1; c < last; ++c) {
        const double multiplier = row[c] / row[0];
        double* below = &(*this)(i + c, i + c);
        for (int k = c; k < last; ++k) below[k - c] -= multiplier * row[k];
      }
    }
    return true;
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
