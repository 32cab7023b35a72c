// The linearized stage equations with one Jacobian J for all stages, in systems of one stage's
// size.
//
// The simplified Newton's method asks for X with X - h J X A' = R, a column per stage, where
// a_ij = mu_ij b_j. Scale the columns by beta_j = sqrt(b_j): A becomes beta beta'/2 + S with
// S_ij = beta_i (mu_ij - 1/2) beta_j. For a Gauss method S is skew, since mu_ij + mu_ji = 1, and
// changes its sign where the stages are reversed. So it maps even combinations of stages to odd
// ones and back: with its singular vectors, S o_k = sigma_k e_k and S e_k = -sigma_k o_k. beta is
// even, of length one, and has the coefficients w_k along the e_k. The coefficients x_k, y_k of X
// and r_k, t_k of R along e_k, o_k obey
//
//   x_k - h J (w_k g/2 + sigma_k y_k) = r_k,   y_k + sigma_k h J x_k = t_k,   g = sum_k w_k x_k,
//
// and with M_k = I + (sigma_k h J)^2
//
//   x_k = M_k^-1 (r_k + sigma_k h J t_k + w_k h J g/2),
//   (I - sum_k w_k^2 M_k^-1 h J/2) g = sum_k w_k M_k^-1 (r_k + sigma_k h J t_k).
//
// That makes s/2 + 1 real systems of size 2n of one with s 2n unknowns.
// Source: Antonana, Makazaga & Murua, Efficient implementation of symplectic implicit Runge-Kutta
// schemes with simplified Newton iterations, Numerical Algorithms 78 (2018).
#pragma once

#include <Eigen/Jacobi>
#include <array>
#include <cmath>

#include "carnot/lu.h"
#include "carnot/tableau.h"

namespace carnot {

// Real scalars; up to `most` stages of `size` numbers.
template <class T, int size, int most>
class DecoupledStages {
 public:
  using Square = Eigen::Matrix<T, size, size, Eigen::RowMajor>;

  // Finds the singular vectors. False where the method is not symplectic and symmetric.
  template <int s>
  [[nodiscard]] bool set_method(const Tableau<T, s>& tableau) {
    using std::sqrt;
    count_ = tableau.stages();
    pairs_ = 0;
    if (tableau.partitioned || !is_symplectic(tableau) || !is_symmetric(tableau)) return false;
    const Combinations beta = tableau.b.cwiseSqrt();
    Basis skew(count_, count_);
    for (int i = 0; i < count_; ++i) {
      for (int j = 0; j < count_; ++j) {
        skew(i, j) = beta[i] * (tableau.mu(i, j) - T(0.5)) * beta[j];
      }
    }
    pairs_ = (count_ + 1) / 2;
    Basis even = Basis::Zero(count_, pairs_);
    for (int k = 0; k < pairs_; ++k) {
      const T part = 2 * k + 1 == count_ ? T(1) : sqrt(T(0.5));
      even(k, k) = even(count_ - 1 - k, k) = part;
    }
    Basis image = skew.lazyProduct(even);
    orthogonalize(image, even);
    for (int k = 0; k < pairs_; ++k) {
      sigma_[k] = image.col(k).norm();
      weight_[k] = beta.dot(even.col(k));
      // An odd number of stages has an even combination without partner: sigma = 0.
      const T inverse = sigma_[k] > sqrt(epsilon<T>()) ? T(-1) / sigma_[k] : T(0);
      if (inverse == T(0)) sigma_[k] = T(0);
      image.col(k) *= inverse;
    }
    from_even_ = beta.asDiagonal() * even;
    from_odd_ = beta.asDiagonal() * image;
    to_even_ = beta.cwiseInverse().asDiagonal() * even;
    to_odd_ = beta.cwiseInverse().asDiagonal() * image;
    return true;
  }

  // For the Jacobian h J. False where a system is singular. Cost: s/2 + 1 inverses.
  [[nodiscard]] bool factor(const Square& jacobian) {
    jacobian_ = jacobian;
    const Square square = jacobian.lazyProduct(jacobian);
    Square sum = Square::Identity();
    for (int k = 0; k < pairs_; ++k) {
      const Square m = Square::Identity() + (sigma_[k] * sigma_[k]) * square;
      if (!invert(m, inverse_[k])) return false;
      sum -= (weight_[k] * weight_[k] / T(2)) * inverse_[k].lazyProduct(jacobian);
    }
    return invert(sum, inverse_mean_);
  }

  // Overwrites R, a column after the other, by X.
  void solve(T* columns) const {
    Eigen::Map<Eigen::Matrix<T, size, Eigen::Dynamic, 0, size, most>> x(columns, size, count_);
    std::array<Point, kPairs> even;
    std::array<Point, kPairs> odd;
    Point sum = Point::Zero();
    for (int k = 0; k < pairs_; ++k) {
      odd[k] = x.lazyProduct(from_odd_.col(k));
      even[k] = x.lazyProduct(from_even_.col(k));
      even[k] += sigma_[k] * Point(jacobian_.lazyProduct(odd[k]));
      even[k] = inverse_[k].lazyProduct(even[k]).eval();
      sum += weight_[k] * even[k];
    }
    const Point mean = inverse_mean_.lazyProduct(sum);
    const Point common = jacobian_.lazyProduct(mean) / T(2);
    x.setZero();
    for (int k = 0; k < pairs_; ++k) {
      even[k] += weight_[k] * Point(inverse_[k].lazyProduct(common));
      odd[k] -= sigma_[k] * Point(jacobian_.lazyProduct(even[k]));
      x += even[k].lazyProduct(to_even_.col(k).transpose());
      x += odd[k].lazyProduct(to_odd_.col(k).transpose());
    }
  }

 private:
  static constexpr int kPairs = (most + 1) / 2;
  using Point = Vector<T, size>;
  using Combinations = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, most, 1>;
  using Basis = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;

  // mu_ij - 1/2 changes its sign where the stages are reversed.
  template <int s>
  static bool is_symmetric(const Tableau<T, s>& tableau) {
    const T round_off = T(1000) * epsilon<T>();
    const int last = tableau.stages() - 1;
    for (int i = 0; i <= last; ++i) {
      for (int j = 0; j <= last; ++j) {
        const T sum = tableau.mu(i, j) + tableau.mu(last - i, last - j);
        if (!(abs(sum - T(1)) <= round_off)) return false;
      }
    }
    return true;
  }

  // Rotates the columns of both alike until those of `image` are orthogonal (one-sided Jacobi).
  static void orthogonalize(Basis& image, Basis& even) {
    constexpr int kSweeps = 12;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (int q = 1; q < image.cols(); ++q) {
        for (int p = 0; p < q; ++p) {
          Eigen::JacobiRotation<T> rotation;
          rotation.makeJacobi(image.col(p).squaredNorm(),
                              image.col(p).dot(image.col(q)),
                              image.col(q).squaredNorm());
          image.applyOnTheRight(p, q, rotation);
          even.applyOnTheRight(p, q, rotation);
        }
      }
    }
  }

  [[nodiscard]] static bool invert(Square m, Square& inverse) {
    inverse.setIdentity();
    return lu_solve(size, m.data(), size, inverse.data());
  }

  int count_ = 0;  // stages
  int pairs_ = 0;
  std::array<T, kPairs> sigma_;
  std::array<T, kPairs> weight_;  // w_k
  Basis from_even_;               // a column for each k: coefficients from columns of stages,
  Basis from_odd_;
  Basis to_even_;  // and back
  Basis to_odd_;
  Square jacobian_;                     // h J
  std::array<Square, kPairs> inverse_;  // of M_k
  Square inverse_mean_;
};

}  // namespace carnot
