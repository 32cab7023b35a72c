// Decompositions written out, for matrices whose size the compiler may know.
//
// Where it does, loops are unrolled and nothing is allocated: planes of 3 or 4 coordinates then
// take a third of the time, and most scenes have few.
#pragma once

#include <Eigen/Core>
#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/shooting/linear/known_width.h"

namespace carnot::internal {

// run(std::integral_constant of `size`) for sizes that are worth code of their own, else of
// Eigen::Dynamic.
template <class Run>
auto with_known_size(Eigen::Index size, const Run& run) {
  return with_known_width<3, 4, 5>(static_cast<int>(size), [&](auto known) {
    constexpr int kSize = known == 0 ? Eigen::Dynamic : static_cast<int>(known);
    return run(std::integral_constant<int, kSize>{});
  });
}

// n x n, and 2n x n as a plane is, where n is known or Eigen::Dynamic.
template <int n>
using KnownSquare = Eigen::Matrix<double, n, n>;
template <int n>
using KnownPlane = Eigen::Matrix<double, n == Eigen::Dynamic ? n : 2 * n, n>;

// The eigenvalues of a symmetric matrix, in no order, on the diagonal of `a`, and eigenvectors as
// columns of `vectors`. Jacobi's method, row by row: small eigenvalues keep their digits beside
// large ones. Some ten sweeps; ends where the entries beside the diagonal are round-off of those on
// it.
template <class Matrix>
void diagonalise(Matrix& a, Matrix& vectors) {
  constexpr double kEps = std::numeric_limits<double>::epsilon();
  constexpr int kMostSweeps = 60;
  const Eigen::Index n = a.rows();
  vectors.setIdentity(n, n);
  const double nothing = kEps * kEps * a.norm();
  bool rotated = true;
  for (int sweep = 0; rotated && sweep < kMostSweeps; ++sweep) {
    rotated = false;
    for (Eigen::Index p = 0; p < n; ++p) {
      for (Eigen::Index q = p + 1; q < n; ++q) {
        const double size = std::sqrt(std::abs(a(p, p) * a(q, q)));
        if (std::abs(a(p, q)) <= std::max(kEps * size, nothing)) continue;
        Eigen::JacobiRotation<double> rotation;
        if (!rotation.makeJacobi(a, p, q)) continue;
        rotated = true;
        a.applyOnTheLeft(p, q, rotation.adjoint());
        a.applyOnTheRight(p, q, rotation);
        vectors.applyOnTheRight(p, q, rotation);
      }
    }
  }
}

// Householder's factors of a matrix with no more columns than rows: the columns become those of Q,
// orthonormal, and `r` the upper triangle R.
template <class Matrix, class Square>
void orthonormalise(Matrix& a, Square& r) {
  const Eigen::Index rows = a.rows();
  const Eigen::Index cols = a.cols();
  Eigen::Matrix<double, Matrix::ColsAtCompileTime, 1> factors(cols);
  r.setZero(cols, cols);
  // Multiplies column j of a matrix by 1 - factor v v', where v is (1, a(k + 1, k), ...).
  const auto reflect = [&](Eigen::Index k, Matrix& m, Eigen::Index j) {
    double sum = m(k, j);
    for (Eigen::Index i = k + 1; i < rows; ++i) sum += a(i, k) * m(i, j);
    sum *= factors[k];
    m(k, j) -= sum;
    for (Eigen::Index i = k + 1; i < rows; ++i) m(i, j) -= sum * a(i, k);
  };
  for (Eigen::Index k = 0; k < cols; ++k) {
    double below = 0;
    for (Eigen::Index i = k + 1; i < rows; ++i) below += a(i, k) * a(i, k);
    const double first = a(k, k);
    factors[k] = 0;
    if (below > std::numeric_limits<double>::min()) {
      const double size = std::sqrt(first * first + below);
      const double image = first >= 0 ? -size : size;
      factors[k] = (image - first) / image;
      for (Eigen::Index i = k + 1; i < rows; ++i) a(i, k) /= first - image;
      a(k, k) = image;
    }
    for (Eigen::Index j = k + 1; j < cols; ++j) reflect(k, a, j);
    for (Eigen::Index i = 0; i <= k; ++i) r(i, k) = a(i, k);
  }
  Matrix q = Matrix::Identity(rows, cols);
  for (Eigen::Index k = cols - 1; k >= 0; --k) {
    for (Eigen::Index j = k; j < cols; ++j) reflect(k, q, j);
  }
  a = q;
}

}  // namespace carnot::internal
