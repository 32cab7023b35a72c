// LU factors of a small symmetric matrix that may be indefinite, such as H_yy of a saddle.
//
// A = D^-1 P'L U D^-1 with partial pivoting, D diagonal such that the rows of D A D are of size
// one: whether A counts as singular does not depend on the units of its rows. Real scalars only; on
// Jets a constant A is applied to each component of a right-hand side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/round_off.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// m rows, or where m is Eigen::Dynamic, as many as `a` has, at most `most`.
template <class T, int m, int most = m>
class ScaledLu {
 public:
  template <class U>
  using Column = Eigen::Matrix<U, m, 1, 0, most, 1>;
  using Square = Eigen::Matrix<T, m, m, 0, most, most>;

  explicit ScaledLu(const Square& a) : lu_(a), scale_(a.rows()) {
    using std::abs;
    balance();
    const int size = static_cast<int>(lu_.rows());
    const T threshold = pivot_round_off<T>(size);
    for (int j = 0; j < size; ++j) {
      int pivot = j;
      for (int i = j + 1; i < size; ++i) {
        if (abs(lu_(i, j)) > abs(lu_(pivot, j))) pivot = i;
      }
      row_[j] = pivot;
      if (pivot != j) {
        for (int k = 0; k < size; ++k) std::swap(lu_(j, k), lu_(pivot, k));
        determinant_ = -determinant_;
      }
      determinant_ *= lu_(j, j) / (scale_[j] * scale_[j]);
      regular_ = regular_ && abs(lu_(j, j)) > threshold;
      for (int i = j + 1; i < size; ++i) {
        lu_(i, j) /= lu_(j, j);
        for (int k = j + 1; k < size; ++k) lu_(i, k) -= lu_(i, j) * lu_(j, k);
      }
    }
  }

  // False when the scaled matrix is singular to round-off, or not finite.
  [[nodiscard]] bool regular() const { return regular_; }
  [[nodiscard]] T determinant() const { return determinant_; }

  // A^-1 b. On Jets each component of b: A is a constant.
  template <class Derived>
  [[nodiscard]] Column<typename Derived::Scalar> solve(const Eigen::MatrixBase<Derived>& b) const {
    using U = typename Derived::Scalar;
    const int size = static_cast<int>(lu_.rows());
    if constexpr (kIsJet<U>) {
      Column<typename U::Scalar> part(size);
      Column<U> x(size);
      for (int i = 0; i < size; ++i) part[i] = b[i].a;
      part = solve(part);
      for (int i = 0; i < size; ++i) x[i].a = part[i];
      for (int d = 0; d < U::kDirections; ++d) {
        for (int i = 0; i < size; ++i) part[i] = b[i].v[d];
        part = solve(part);
        for (int i = 0; i < size; ++i) x[i].v[d] = part[i];
      }
      return x;
    } else {
      Column<T> x(size);
      for (int i = 0; i < size; ++i) x[i] = b[i] * scale_[i];
      for (int i = 0; i < size; ++i) std::swap(x[i], x[row_[i]]);
      for (int i = 1; i < size; ++i) {
        for (int k = 0; k < i; ++k) x[i] -= lu_(i, k) * x[k];
      }
      for (int i = size - 1; i >= 0; --i) {
        for (int k = i + 1; k < size; ++k) x[i] -= lu_(i, k) * x[k];
        x[i] /= lu_(i, i);
      }
      for (int i = 0; i < size; ++i) x[i] *= scale_[i];
      return x;
    }
  }

 private:
  // Ruiz' iteration: each sweep takes the square root of the distance of the row sizes from 1.
  void balance() {
    using std::abs, std::sqrt;
    constexpr int kSweeps = 3;
    const int rows = static_cast<int>(lu_.rows());
    for (int i = 0; i < rows; ++i) scale_[i] = T(1);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      Column<T> d(rows);
      for (int i = 0; i < rows; ++i) {
        T size(0);
        for (int j = 0; j < rows; ++j) size = std::max(size, abs(lu_(i, j)));
        d[i] = size > T(0) ? T(1) / sqrt(size) : T(1);
      }
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < rows; ++j) lu_(i, j) *= d[i] * d[j];
      }
      for (int i = 0; i < rows; ++i) scale_[i] *= d[i];
    }
  }

  Square lu_;
  Column<T> scale_;
  std::array<int, most> row_;
  T determinant_ = T(1);
  bool regular_ = true;
};

}  // namespace carnot
