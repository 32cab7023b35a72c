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

namespace carnot {

class BandedLu {
 public:
  BandedLu(int size, int below, int above)
      : size_(size), below_(below), width_(2 * below + above + 1), a_(size * width_, 0.0) {}

  void clear() { std::fill(a_.begin(), a_.end(), 0.0); }

  // Entry (i, j), |i - j| within the band.
  double& operator()(int i, int j) { return a_[i * width_ + j - i + below_]; }

  // Overwrites the matrix by its factors and `b` by the solution. False when a pivot vanishes.
  [[nodiscard]] bool solve(std::vector<double>& b) {
    for (int j = 0; j < size_; ++j) {
      const int last_row = std::min(size_ - 1, j + below_);
      const int last_column = std::min(size_ - 1, j + width_ - 1 - below_);
      int pivot = j;
      for (int i = j + 1; i <= last_row; ++i) {
        if (std::abs((*this)(i, j)) > std::abs((*this)(pivot, j))) pivot = i;
      }
      if (!(std::abs((*this)(pivot, j)) > 0)) return false;
      if (pivot != j) {
        for (int c = j; c <= last_column; ++c) std::swap((*this)(j, c), (*this)(pivot, c));
        std::swap(b[j], b[pivot]);
      }
      for (int i = j + 1; i <= last_row; ++i) eliminate(i, j, last_column, b);
    }
    for (int i = size_ - 1; i >= 0; --i) {
      const int last_column = std::min(size_ - 1, i + width_ - 1 - below_);
      for (int c = i + 1; c <= last_column; ++c) b[i] -= (*this)(i, c) * b[c];
      b[i] /= (*this)(i, i);
    }
    return true;
  }

 private:
  void eliminate(int i, int j, int last_column, std::vector<double>& b) {
    const double factor = (*this)(i, j) / (*this)(j, j);
    if (factor == 0) return;
    double* row = &(*this)(i, j);
    const double* pivot_row = &(*this)(j, j);
    for (int c = 0; c <= last_column - j; ++c) row[c] -= factor * pivot_row[c];
    b[i] -= factor * b[j];
  }

  int size_;
  int below_;
  int width_;
  std::vector<double> a_;
};

}  // namespace carnot
