// LU factors of a banded matrix with partial pivoting.
//
// Rows may swap within the band, so U gains `below` more diagonals (Golub & Van Loan, Matrix
// Computations, 4.3.5). Cost about 2 size below (below + above) multiplications; one allocation for
// a given shape.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace carnot::internal {

class BandedLu {
 public:
  BandedLu(int size, int below, int above)
      : size_(size),
        below_(below),
        width_(2 * below + above + 1),
        a_(static_cast<std::size_t>(size) * width_, 0.0),
        pivot_(size) {}

  void clear() { std::fill(a_.begin(), a_.end(), 0.0); }

  // Entry (i, j), |i - j| within the band.
  double& operator()(int i, int j) {
    return a_[static_cast<std::size_t>(i) * width_ + j - i + below_];
  }

  // Overwrites the matrix by its factors. False when a pivot vanishes.
  [[nodiscard]] bool factor() {
    for (int j = 0; j < size_; ++j) {
      const int last_row = std::min(size_ - 1, j + below_);
      const int last_column = std::min(size_ - 1, j + width_ - 1 - below_);
      int pivot = j;
      for (int i = j + 1; i <= last_row; ++i) {
        if (std::abs((*this)(i, j)) > std::abs((*this)(pivot, j))) pivot = i;
      }
      if (!(std::abs((*this)(pivot, j)) > 0)) return false;
      pivot_[j] = pivot;
      if (pivot != j) {
        for (int c = j; c <= last_column; ++c) std::swap((*this)(j, c), (*this)(pivot, c));
      }
      for (int i = j + 1; i <= last_row; ++i) eliminate(i, j, last_column);
    }
    return true;
  }

  // Overwrites `b` by the solution; after factor().
  void substitute(std::vector<double>& b) {
    for (int j = 0; j < size_; ++j) {
      std::swap(b[j], b[pivot_[j]]);
      const int last_row = std::min(size_ - 1, j + below_);
      for (int i = j + 1; i <= last_row; ++i) b[i] -= (*this)(i, j) * b[j];
    }
    for (int i = size_ - 1; i >= 0; --i) {
      const int last_column = std::min(size_ - 1, i + width_ - 1 - below_);
      const double* row = &(*this)(i, i);
      double sum = b[i];
      for (int c = 1; c <= last_column - i; ++c) sum -= row[c] * b[i + c];
      b[i] = sum / row[0];
    }
  }

  // Both.
  [[nodiscard]] bool solve(std::vector<double>& b) {
    if (!factor()) return false;
    substitute(b);
    return true;
  }

 private:
  // The multiplier stays where the entry was.
  void eliminate(int i, int j, int last_column) {
    double* row = &(*this)(i, j);
    if (row[0] == 0) return;
    const double* pivot_row = &(*this)(j, j);
    row[0] /= pivot_row[0];
    for (int c = 1; c <= last_column - j; ++c) row[c] -= row[0] * pivot_row[c];
  }

  int size_;
  int below_;
  int width_;
  std::vector<double> a_;
  std::vector<int> pivot_;
};

}  // namespace carnot::internal
