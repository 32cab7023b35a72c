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
//
// Loops over plain arrays: Eigen's expressions of these took a third of the time to compile a step.
#pragma once

#include <algorithm>
#include <array>

#include "carnot/numerics/lu.h"
#include "carnot/step/stage_pairs.h"

namespace carnot {

// Real scalars; up to `most` stages of `size` numbers.
template <class T, int size, int most>
class DecoupledStages {
 public:
  using Square = Matrix<T, size, size>;

  // False where the method is not symplectic and symmetric.
  template <int s>
  [[nodiscard]] bool set_method(const Tableau<T, s>& tableau) {
    return pairs_.set_method(tableau);
  }

  // For steps of h. False where a system is singular. Cost: s/2 + 1 inverses.
  [[nodiscard]] bool factor(const T& h, const Square& jacobian) {
    for (int i = 0; i < kEntries; ++i) jacobian_[i] = h * jacobian.data()[i];
    Columns square;
    Columns sum;
    multiply(jacobian_, jacobian_, square);
    set_identity(sum);
    for (int k = 0; k < pairs_.count; ++k) {
      Columns m;
      set_identity(m);
      const T sigma = pairs_.sigma[k];
      for (int i = 0; i < kEntries; ++i) m[i] += sigma * sigma * square[i];
      if (!invert(m, inverse_[k])) return false;
      multiply(inverse_[k], jacobian_, m);
      const T weight = pairs_.weight[k];
      for (int i = 0; i < kEntries; ++i) sum[i] -= weight * weight / T(2) * m[i];
    }
    return invert(sum, inverse_mean_);
  }

  // Overwrites R, a column after the other, by X.
  void solve(T* columns) const {
    std::array<Point, kPairs> even{};
    std::array<Point, kPairs> odd{};
    Point sum{};
    for (int k = 0; k < pairs_.count; ++k) {
      Point rhs{};
      for (int j = 0; j < pairs_.stages; ++j) {
        add(pairs_.from_even[k][j], columns + j * size, rhs.data());
        add(pairs_.from_odd[k][j], columns + j * size, odd[k].data());
      }
      add_product(pairs_.sigma[k], jacobian_, odd[k].data(), rhs.data());
      add_product(T(1), inverse_[k], rhs.data(), even[k].data());
      add(pairs_.weight[k], even[k].data(), sum.data());
    }
    Point mean{};
    Point common{};
    add_product(T(1), inverse_mean_, sum.data(), mean.data());
    add_product(T(0.5), jacobian_, mean.data(), common.data());
    std::fill_n(columns, size * pairs_.stages, T(0));
    for (int k = 0; k < pairs_.count; ++k) {
      add_product(pairs_.weight[k], inverse_[k], common.data(), even[k].data());
      add_product(-pairs_.sigma[k], jacobian_, even[k].data(), odd[k].data());
      for (int j = 0; j < pairs_.stages; ++j) {
        add(pairs_.to_even[k][j], even[k].data(), columns + j * size);
        add(pairs_.to_odd[k][j], odd[k].data(), columns + j * size);
      }
    }
  }

 private:
  using Pairs = StagePairs<T, most>;
  static constexpr int kPairs = Pairs::kPairs;
  static constexpr int kEntries = size * size;
  using Point = std::array<T, size>;
  using Columns = std::array<T, kEntries>;  // of a matrix, one after the other

  // y += weight x.
  static void add(const T& weight, const T* x, T* y) {
    for (int i = 0; i < size; ++i) y[i] += weight * x[i];
  }
  // y += weight a x.
  static void add_product(const T& weight, const Columns& a, const T* x, T* y) {
    Point ax;
    for (int i = 0; i < size; ++i) {
      T sum = a[i] * x[0];
      for (int j = 1; j < size; ++j) sum += a[j * size + i] * x[j];
      ax[i] = sum;
    }
    add(weight, ax.data(), y);
  }
  static void multiply(const Columns& a, const Columns& b, Columns& c) {
    c.fill(T(0));
    for (int j = 0; j < size; ++j) add_product(T(1), a, b.data() + j * size, c.data() + j * size);
  }
  static void set_identity(Columns& a) {
    a.fill(T(0));
    for (int i = 0; i < size; ++i) a[i * size + i] = T(1);
  }
  // lu_solve() takes rows for columns, which transposes m and its inverse alike.
  [[nodiscard]] static bool invert(Columns m, Columns& inverse) {
    set_identity(inverse);
    return lu_solve(size, m.data(), size, inverse.data());
  }

  Pairs pairs_;
  Columns jacobian_;                     // h J
  std::array<Columns, kPairs> inverse_;  // of M_k
  Columns inverse_mean_;
};

}  // namespace carnot
