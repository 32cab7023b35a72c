// Generalized Hamiltonian scenes for tests, and the midpoint rule as the paper writes it for them.
#pragma once

#include <gtest/gtest.h>

#include <array>

#include "carnot/numerics/gradient.h"
#include "carnot/numerics/lu.h"
#include "carnot/scene/generalized_hamiltonian_scene.h"
#include "testing/canonical.h"
#include "testing/distance.h"
#include "testing/random_points.h"

namespace carnot::test {

// A^-1 B, so that no test needs a decomposition.
template <int N, int M>
Matrix<double, N, M> solved(const Matrix<double, N, N>& a, const Matrix<double, N, M>& b) {
  std::array<double, N * N> factor;  // by rows, as x
  std::array<double, N * M> x;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) factor[i * N + j] = a(i, j);
    for (int j = 0; j < M; ++j) x[i * M + j] = b(i, j);
  }
  EXPECT_TRUE(lu_solve(N, factor.data(), M, x.data()));
  Matrix<double, N, M> solution;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < M; ++j) solution(i, j) = x[i * M + j];
  }
  return solution;
}

// The same scene in other coordinates, z = A w: J becomes A'J A and H(w) = H(A w).
template <class Scene>
struct InBasis {
  static constexpr int kSize = Scene::kSize;
  static constexpr int kDof = Scene::kDof;

  Scene scene;
  Matrix<double, kSize, kSize> basis;  // A

  template <class T>
  [[nodiscard]] T hamiltonian(const Vector<T, kSize>& w) const {
    Vector<T, kSize> z;
    for (int i = 0; i < kSize; ++i) {
      z[i] = constant<T>(0);
      for (int j = 0; j < kSize; ++j) z[i] += constant<T>(basis(i, j)) * w[j];
    }
    return scene.hamiltonian(z);
  }
  [[nodiscard]] Matrix<double, kSize, kSize> structure_matrix() const {
    const Matrix<double, kSize, kSize> j = scene.structure_matrix();
    return transposed_times(basis, product(j, basis));
  }
  [[nodiscard]] Vector<double, kSize> from_original(const Vector<double, kSize>& z) const {
    return solved(basis, z);
  }
  // |A| |A^-1|, Frobenius norms.
  [[nodiscard]] double condition() const {
    return norm(basis) * norm(solved(basis, identity<kSize, double>()));
  }
};

// Entries in [-1, 1], and 2 more on the diagonal: the condition is about a hundred.
template <class Scene>
InBasis<Scene> in_random_basis(const Scene& scene, unsigned seed) {
  constexpr int N = Scene::kSize;
  Generator generator(seed);
  Matrix<double, N, N> a = random_matrix<N, N>(generator);
  for (int i = 0; i < N; ++i) a(i, i) += 2;
  return {scene, a};
}

// A scene with velocity constraints as Prop. 1 has it, M diagonal and regular: z = (q, p, lambda),
// H = (p + G'lambda)' M^-1 (p + G'lambda)/2.
template <class Constrained>
struct AsGeneralized {
  static constexpr int kDof = Constrained::kDof;
  static constexpr int kMultipliers = Constrained::kMultipliers;
  static constexpr int kSize = 2 * kDof + kMultipliers;

  Constrained constrained;

  template <class T>
  [[nodiscard]] T hamiltonian(const Vector<T, kSize>& z) const {
    const Vector<T, kDof> q = part<0, kDof>(z);
    const Matrix<T, kMultipliers, kDof> g = constrained.constraints(q);
    const Matrix<T, kDof, kDof> mass = constrained.mass(q);
    T sum = constant<T>(0);
    for (int i = 0; i < kDof; ++i) {
      T momentum = z[kDof + i];
      for (int k = 0; k < kMultipliers; ++k) momentum += z[2 * kDof + k] * g(k, i);
      sum += momentum * momentum / mass(i, i);
    }
    return constant<T>(0.5) * sum;
  }
  [[nodiscard]] Matrix<double, kSize, kSize> structure_matrix() const {
    return canonical(kSize, kDof);
  }
};

// A particle on the unit circle, z = (q, p, lambda), its constraint written as lambda h(q): H_yy is
// zero and the index is 3.
struct LambdaH {
  static constexpr int kSize = 5;
  static constexpr int kDof = 2;

  template <class T>
  [[nodiscard]] T hamiltonian(const Vector<T, 5>& z) const {
    const T half = constant<T>(0.5);
    const T h = half * (z[0] * z[0] + z[1] * z[1] - constant<T>(1));
    return half * (z[2] * z[2] + z[3] * z[3]) + z[4] * h;
  }
  [[nodiscard]] Matrix<double, 5, 5> structure_matrix() const { return canonical(5, 2); }
};

// J (z1 - z0)/h = grad H((z0 + z1)/2), eq. (15) of the paper, in the scene's own coordinates: N
// equations for the N unknowns of the midpoint, by Newton's method, with the derivative of z1.
template <class Scene>
struct NaiveMidpoint {
  static constexpr int N = Scene::kSize;
  Vector<double, N> middle;
  Vector<double, N> end;
  Matrix<double, N, N> tangent;  // d end / d z0
  double residual = 0;

  NaiveMidpoint(const Scene& scene, double h, const Vector<double, N>& z0) : middle(z0) {
    Matrix<double, N, N> twice_j = scene.structure_matrix();
    add_to(twice_j, twice_j);
    constexpr int kIterations = 15;
    for (int i = 0; i < kIterations; ++i) {
      Vector<double, N> change = middle;
      subtract_from(change, z0);
      Vector<double, N> rest = product(twice_j, change);
      Matrix<double, N, N> matrix = twice_j;
      for (int c = 0; c < N; ++c) {
        const Vector<Jet<double, 1>, N> slope = slope_along(scene, middle, c);
        for (int r = 0; r < N; ++r) matrix(r, c) -= h * slope[r].v[0];
        rest[c] -= h * slope[c].a;
      }
      residual = norm(rest);
      subtract_from(middle, solved(matrix, rest));
      tangent = solved(matrix, twice_j);
      add_to(tangent, tangent);
      subtract_from(tangent, identity<N, double>());
    }
    end = middle;
    add_to(end, middle);
    subtract_from(end, z0);
  }

 private:
  // grad H with its derivative by z_c: one column of the Hessian.
  static Vector<Jet<double, 1>, N> slope_along(const Scene& scene,
                                               const Vector<double, N>& z,
                                               int c) {
    using Line = Jet<double, 1>;
    Vector<Line, N> x = unseeded<Line>(z);
    x[c].v[0] = 1;
    return gradient([&](const auto& point) { return scene.hamiltonian(point); }, x);
  }
};

}  // namespace carnot::test
