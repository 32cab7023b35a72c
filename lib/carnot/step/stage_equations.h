// The equations of the stages, U_i = z + e + sum_j mu_ij L_j, and their linearization.
//
// Columns of the matrices belong to stages. Notation: tableau.h, runge_kutta.h.
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
  u = increments.lazyProduct(tableau.mu.transpose());
  if (tableau.partitioned) {
    u.template bottomRows<n / 2>() =
        increments.template bottomRows<n / 2>().lazyProduct(tableau.mu_p.transpose());
  }
  u.colwise() += z.compensation;
  u.colwise() += z.value;
}

// U_i from the increments up to L_i. Those after it are not of this step.
template <class T, int s, class Stages, int n>
Vector<T, n> stage_argument(const Tableau<T, s>& tableau,
                            const Stages& increments,
                            const Compensated<Vector<T, n>>& z,
                            int i) {
  Vector<T, n> sum = z.compensation;
  for (int j = 0; j <= i; ++j) {
    if (tableau.mu(i, j) != T(0)) sum += tableau.mu(i, j) * increments.col(j);
  }
  return sum + z.value;
}

// sum_j u_j L_j, by which z moves.
template <class T, int s, class Stages>
auto sum_of_increments(const Tableau<T, s>& tableau, const Stages& increments) {
  using Sum = Vector<T, Stages::RowsAtCompileTime>;
  if constexpr (s == kAnyStages) {
    return Sum(increments.lazyProduct(tableau.update));
  } else {
    return Sum(increments.rowwise().sum());
  }
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
