// The equations of the stages, U_i = z + e + sum_j mu_ij L_j, and their linearization.
//
// Columns of the matrices belong to stages. Notation: tableau.h, runge_kutta.h. Loops over entries:
// see linear_algebra.h.
#pragma once

#include <array>

#include "carnot/numerics/lu.h"
#include "carnot/system/phase_space.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// All U from all L.
template <class T, int s, class Stages, int n>
void stage_arguments(const Tableau<T, s>& tableau,
                     const Stages& increments,
                     const Compensated<Vector<T, n>>& z,
                     Stages& u) {
  const int count = static_cast<int>(increments.cols());
  for (int i = 0; i < count; ++i) {
    std::array<T, n> sum;
    sum.fill(T(0));
    for (int j = 0; j < count; ++j) {
      const T mu = tableau.mu(i, j);
      const T momentum_mu = tableau.momentum_mu(i, j);
      for (int k = 0; k < n / 2; ++k) sum[k] += mu * increments(k, j);
      for (int k = n / 2; k < n; ++k) sum[k] += momentum_mu * increments(k, j);
    }
    for (int k = 0; k < n; ++k) u(k, i) = sum[k] + z.compensation[k] + z.value[k];
  }
}

// U_i from the increments up to L_i. Those after it are not of this step.
template <class T, int s, class Stages, int n>
Vector<T, n> stage_argument(const Tableau<T, s>& tableau,
                            const Stages& increments,
                            const Compensated<Vector<T, n>>& z,
                            int i) {
  std::array<T, n> sum;
  for (int k = 0; k < n; ++k) sum[k] = z.compensation[k];
  for (int j = 0; j <= i; ++j) {
    const T mu = tableau.mu(i, j);
    if (mu == T(0)) continue;
    for (int k = 0; k < n; ++k) sum[k] += mu * increments(k, j);
  }
  for (int k = 0; k < n; ++k) sum[k] += z.value[k];
  return Vector<T, n>(sum.data());
}

// sum_j u_j L_j, by which z moves.
template <class T, int s, class Stages>
auto sum_of_increments(const Tableau<T, s>& tableau, const Stages& increments) {
  constexpr int n = Stages::RowsAtCompileTime;
  std::array<T, n> sum;
  sum.fill(T(0));
  for (int j = 0; j < increments.cols(); ++j) {
    const T update = tableau.update[j];
    for (int k = 0; k < n; ++k) sum[k] += update * increments(k, j);
  }
  return Vector<T, n>(sum.data());
}

// The matrix I - mu_ij h omega_j df/dz(U_j) of up to `most` coupled stages, in blocks, row-major.
template <class T, int size, int most>
class StageEquations {
 public:
  // The blocks of stage j in the equations of the stages first, ..., end - 1; a = df/dz, and
  // weight = h omega_j.
  template <int s>
  void set_column(const Tableau<T, s>& tableau,
                  int first,
                  int end,
                  int j,
                  const T& weight,
                  const Matrix<T, size, size>& a) {
    const int width = size * (end - first);
    for (int i = first; i < end; ++i) {
      for (int row = 0; row < size; ++row) {
        const T mu = 2 * row < size ? tableau.mu(i, j) : tableau.momentum_mu(i, j);
        const T factor = mu * weight;
        T* const to = matrix_.data() + ((i - first) * size + row) * width + (j - first) * size;
        for (int c = 0; c < size; ++c) to[c] = T(i == j && row == c ? 1 : 0) - factor * a(row, c);
      }
    }
  }

  // Solves for `count` stages, one after the other in `x`: the right-hand side, then the solution.
  // Destroys the matrix. False where it is singular.
  [[nodiscard]] bool solve(int count, T* x) { return lu_solve(size * count, matrix_.data(), 1, x); }

 private:
  std::array<T, size * most * size * most> matrix_;
};

}  // namespace carnot
