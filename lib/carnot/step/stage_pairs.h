// Even and odd combinations of the stages of a symmetric symplectic method, in pairs that its
// matrix maps to one another: see decoupled_stages.h.
#pragma once

#include <Eigen/Jacobi>
#include <array>
#include <cmath>

#include "carnot/numerics/scalar.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// Real scalars; up to `most` stages.
template <class T, int most>
struct StagePairs {
  static constexpr int kPairs = (most + 1) / 2;
  using Weights = std::array<T, most>;        // of the stages
  using Basis = std::array<Weights, kPairs>;  // a combination for each k

  int stages = 0;
  int count = 0;  // of pairs
  std::array<T, kPairs> sigma;
  std::array<T, kPairs> weight;  // w_k
  Basis from_even;               // coefficients from columns of stages,
  Basis from_odd;
  Basis to_even;  // and back
  Basis to_odd;

  // Finds the singular vectors. False where the method is not symplectic and symmetric with
  // positive weights.
  template <int s>
  [[nodiscard]] bool set_method(const Tableau<T, s>& tableau) {
    using std::sqrt;
    stages = tableau.stages();
    count = 0;
    if (tableau.partitioned || !is_symplectic(tableau) || !is_symmetric(tableau)) return false;
    if (!(tableau.b.head(stages).minCoeff() > T(0))) return false;  // they are scaled by roots of b
    count = (stages + 1) / 2;
    Weights beta;
    for (int i = 0; i < stages; ++i) beta[i] = sqrt(tableau.b[i]);
    Basis even{};
    Basis image{};  // of them under S
    for (int k = 0; k < count; ++k) {
      const int last = stages - 1 - k;
      even[k][k] = even[k][last] = k == last ? T(1) : sqrt(T(0.5));
      for (int i = 0; i < stages; ++i) {
        for (int j = 0; j < stages; ++j) {
          image[k][i] += beta[i] * (tableau.mu(i, j) - T(0.5)) * beta[j] * even[k][j];
        }
      }
    }
    orthogonalize(image, even);
    for (int k = 0; k < count; ++k) {
      sigma[k] = sqrt(dot(image[k], image[k]));
      weight[k] = dot(beta, even[k]);
      // An odd number of stages has an even combination without partner: sigma = 0.
      const T inverse = sigma[k] > sqrt(epsilon<T>()) ? T(-1) / sigma[k] : T(0);
      if (inverse == T(0)) sigma[k] = T(0);
      for (int i = 0; i < stages; ++i) {
        const T odd = inverse * image[k][i];
        from_even[k][i] = beta[i] * even[k][i];
        from_odd[k][i] = beta[i] * odd;
        to_even[k][i] = even[k][i] / beta[i];
        to_odd[k][i] = odd / beta[i];
      }
    }
    return true;
  }

 private:
  // Where the stages are reversed b stays and mu_ij - 1/2 changes its sign.
  template <int s>
  static bool is_symmetric(const Tableau<T, s>& tableau) {
    using std::abs;
    const T round_off = T(1000) * epsilon<T>();
    const int last = tableau.stages() - 1;
    for (int i = 0; i <= last; ++i) {
      if (!(abs(tableau.b[i] - tableau.b[last - i]) <= round_off)) return false;
      for (int j = 0; j <= last; ++j) {
        const T sum = tableau.mu(i, j) + tableau.mu(last - i, last - j);
        if (!(abs(sum - T(1)) <= round_off)) return false;
      }
    }
    return true;
  }

  [[nodiscard]] T dot(const Weights& a, const Weights& b) const {
    T sum(0);
    for (int i = 0; i < stages; ++i) sum += a[i] * b[i];
    return sum;
  }

  // Rotates the combinations of both alike until those of `image` are orthogonal (one-sided
  // Jacobi).
  void orthogonalize(Basis& image, Basis& even) const {
    constexpr int kSweeps = 12;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (int q = 1; q < count; ++q) {
        for (int p = 0; p < q; ++p) {
          Eigen::JacobiRotation<T> rotation;
          rotation.makeJacobi(
              dot(image[p], image[p]), dot(image[p], image[q]), dot(image[q], image[q]));
          rotate(rotation.c(), rotation.s(), image[p], image[q]);
          rotate(rotation.c(), rotation.s(), even[p], even[q]);
        }
      }
    }
  }
  void rotate(const T& cosine, const T& sine, Weights& a, Weights& b) const {
    for (int i = 0; i < stages; ++i) {
      const T turned = cosine * a[i] - sine * b[i];
      b[i] = sine * a[i] + cosine * b[i];
      a[i] = turned;
    }
  }
};

}  // namespace carnot
