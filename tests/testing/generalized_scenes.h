// Generalized Hamiltonian scenes for tests, and the midpoint rule as the paper writes it for them.
#pragma once

#include <gtest/gtest.h>

#include "carnot/numerics/gradient.h"
#include "carnot/numerics/lu.h"
#include "carnot/scene/generalized_hamiltonian_scene.h"
#include "testing/canonical.h"
#include "testing/random_points.h"

namespace carnot::test {

// A^-1 B, so that no test needs a decomposition.
template <int N, int M>
Matrix<double, N, M> solved(const Matrix<double, N, N>& a, const Matrix<double, N, M>& b) {
  Eigen::Matrix<double, N, N, Eigen::RowMajor> factor = a;
  Eigen::Matrix<double, N, M, M == 1 ? Eigen::ColMajor : Eigen::RowMajor> x = b;
  EXPECT_TRUE(lu_solve(N, factor.data(), M, x.data()));
  return x;
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
    return basis.transpose() * scene.structure_matrix() * basis;
  }
  [[nodiscard]] Vector<double, kSize> from_original(const Vector<double, kSize>& z) const {
    return solved(basis, z);
  }
  // |A| |A^-1|, Frobenius norms.
  [[nodiscard]] double condition() const {
    const Matrix<double, kSize, kSize> identity = Matrix<double, kSize, kSize>::Identity();
    return basis.norm() * solved(basis, identity).norm();
  }
};

// Entries in [-1, 1], and 2 more on the diagonal: the condition is about a hundred.
template <class Scene>
InBasis<Scene> in_random_basis(const Scene& scene, unsigned seed) {
  constexpr int N = Scene::kSize;
  Generator generator(seed);
  const Matrix<double, N, N> a = random_matrix<N, N>(generator);
  return {scene, a + 2 * Matrix<double, N, N>::Identity()};
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
    const Vector<T, kDof> q = z.template head<kDof>();
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
    const Matrix<double, N, N> j = scene.structure_matrix();
    const Matrix<double, N, N> identity = Matrix<double, N, N>::Identity();
    constexpr int kIterations = 15;
    for (int i = 0; i < kIterations; ++i) {
      Vector<double, N> rest = 2 * j * (middle - z0);
      Matrix<double, N, N> matrix = 2 * j;
      for (int c = 0; c < N; ++c) {
        const Vector<Jet<double, 1>, N> slope = slope_along(scene, middle, c);
        for (int r = 0; r < N; ++r) matrix(r, c) -= h * slope[r].v[0];
        rest[c] -= h * slope[c].a;
      }
      residual = rest.norm();
      middle -= solved(matrix, rest);
      tangent = 2 * solved(matrix, Matrix<double, N, N>(2 * j)) - identity;
    }
    end = 2 * middle - z0;
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
