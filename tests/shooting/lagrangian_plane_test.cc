// Planes in closed form: two oscillators, X = diag(sin a, sin b), P = diag(cos a, cos b).
#include "carnot/shooting/linear/lagrangian_plane.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "carnot/shooting/linear/dense.h"
#include "shooting/symplectic.h"
#include "testing/canonical.h"

namespace carnot::internal::lagrangian_plane_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;
constexpr double kRounded = 1e-13;

MatrixXd plane_of(double a, double b) {
  MatrixXd plane = MatrixXd::Zero(4, 2);
  plane.diagonal() << std::sin(a), std::sin(b);
  plane.bottomRows(2).diagonal() << std::cos(a), std::cos(b);
  return plane;
}

MatrixXd rotation(double angle) {
  MatrixXd r(2, 2);
  r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return r;
}

TEST(LagrangianPlane, PhasesAreTwiceTheAngles) {
  const VectorXd phases = phases_of(plane_of(-0.6, 0.2));
  EXPECT_NEAR(phases[0], 0.4, kRounded);
  EXPECT_NEAR(phases[1], -1.2, kRounded);
}

TEST(LagrangianPlane, PhasesDoNotDependOnTheBasis) {
  const MatrixXd plane = plane_of(0.9, 0.3);
  for (const double angle : {0.4, 2.0, kPi}) {
    EXPECT_LE((phases_of(plane * rotation(angle)) - phases_of(plane)).norm(), kRounded);
  }
}

TEST(LagrangianPlane, EqualPhasesAreBothSeen) {
  const VectorXd phases = phases_of(plane_of(0.5, 0.5) * rotation(0.7));
  EXPECT_NEAR(phases[0], 1, kRounded);
  EXPECT_NEAR(phases[1], 1, kRounded);
}

TEST(LagrangianPlane, PhasesVanishWithTheKernelOfX) {
  EXPECT_LE(phases_of(plane_of(0, 0)).norm(), kRounded);
  const VectorXd one = phases_of(plane_of(kPi, 0.7));
  EXPECT_NEAR(one[0], 0, kRounded);
  EXPECT_NEAR(one[1], 1.4, kRounded);
}

// Planes in any number of coordinates, X = A P with a symmetric A: exp(i theta_j) are the
// eigenvalues of W = U U', and the sum of all theta_j is the argument of its determinant.
TEST(LagrangianPlane, PhasesAreThoseOfTheUnitaryMatrix) {
  constexpr double kOfEight = 1e-12;  // 8 x 8, entries of A of size 3
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int n = 1; n <= 8; ++n) {
    const MatrixXd some = MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    MatrixXd plane(2 * n, n);
    plane << some + some.transpose(), MatrixXd::Identity(n, n);
    plane = orthonormal(plane);
    const Eigen::MatrixXcd u = plane.bottomRows(n) + std::complex<double>(0, 1) * plane.topRows(n);
    const Eigen::MatrixXcd w = u * u.transpose();
    const VectorXd phases = phases_of(plane);
    EXPECT_NEAR(std::abs(std::polar(1.0, phases.sum()) - w.determinant()), 0, kOfEight);
    for (int j = 0; j < n; ++j) {
      const Eigen::MatrixXcd shifted =
          w - std::polar(1.0, phases[j]) * Eigen::MatrixXcd::Identity(n, n);
      EXPECT_LE(std::abs(shifted.determinant()), kOfEight);
      if (j > 0) {
        EXPECT_GE(std::abs(phases[j]), std::abs(phases[j - 1]));
      }
    }
  }
}

// What a symplectic map makes of a plane is one, too.
TEST(LagrangianPlane, SymplecticImagesHaveUnitaryBases) {
  const MatrixXd image = orthonormal(test::symplectic_shear(2) * plane_of(0.4, 1.1));
  const MatrixXd w = image.transpose() * test::canonical(4, 2) * image;
  EXPECT_LE(w.norm(), kRounded);
  EXPECT_TRUE(phases_of(image).allFinite());
}

// The image spans what the map makes of the plane, once both are in balanced coordinates.
TEST(LagrangianPlane, ImagesAreInBalancedCoordinates) {
  constexpr double kOfEight = 1e-12;  // 16 x 16, condition of S about 20
  constexpr double kScale = 3;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto entry = [&] { return normal(random); };
  for (int n = 1; n <= 8; ++n) {
    const MatrixXd some = MatrixXd::NullaryExpr(n, n, entry);
    const MatrixXd s = some * some.transpose() / n + MatrixXd::Identity(n, n);
    const Balance balance{s, s.inverse()};
    const MatrixXd map = MatrixXd::NullaryExpr(2 * n, 2 * n, entry);
    const MatrixXd plane = MatrixXd::NullaryExpr(2 * n, n, entry);  // (S^-1 X / c, S P c)
    MatrixXd unbalanced(2 * n, n);
    unbalanced << kScale * s * plane.topRows(n), s.inverse() * plane.bottomRows(n) / kScale;
    const MatrixXd moved = map * unbalanced;
    MatrixXd expected(2 * n, n);
    expected << s.inverse() * moved.topRows(n) / kScale, kScale * s * moved.bottomRows(n);
    const MatrixXd image = image_of(map, balance, kScale, plane);
    EXPECT_LE((image.transpose() * image - MatrixXd::Identity(n, n)).norm(), kOfEight);
    EXPECT_LE((image * (image.transpose() * expected) - expected).norm(),
              kOfEight * expected.norm());
  }
}

TEST(LagrangianPlane, BalancedGraphsHaveModerateAngles) {
  const MatrixXd plane = plane_of(1e-6, 1.2);
  const Graph graph = graph_of(plane);
  EXPECT_EQ(graph.kernel, 0);
  EXPECT_NEAR(graph.regularity, std::tan(1e-6) / std::tan(1.2), 1e-18);
  MatrixXd balanced = plane;
  balanced.topRows(2) = lu_inverse(graph.balance) * plane.topRows(2);
  balanced.bottomRows(2) = graph.balance * plane.bottomRows(2);
  // X = P: all angles are 45 degrees.
  EXPECT_LE((balanced.topRows(2) - balanced.bottomRows(2)).norm(), 1e-9 * balanced.norm());
}

TEST(LagrangianPlane, GraphsShowTheKernelOfX) {
  EXPECT_EQ(graph_of(plane_of(0, 0.8)).kernel, 1);
  const Graph turned = graph_of(plane_of(0, 0.8) * rotation(0.3));
  EXPECT_EQ(turned.kernel, 1);
  EXPECT_TRUE(turned.balance.allFinite());
}

// Infinite in one direction, the graph is what it is in the others.
TEST(LagrangianPlane, GraphsPassOverTheKernelOfP) {
  for (const double angle : {0.0, 0.3}) {
    const MatrixXd turn = rotation(angle);
    MatrixXd plane(4, 2);  // in other coordinates, in which neither X nor P is diagonal
    plane.topRows(2) = turn * plane_of(kPi / 2, 0.8).topRows(2);
    plane.bottomRows(2) = turn * plane_of(kPi / 2, 0.8).bottomRows(2);
    const Graph graph = graph_of(plane * rotation(0.7));
    EXPECT_EQ(graph.kernel, 0);
    ASSERT_TRUE(graph.balance.allFinite());
    const MatrixXd squared = graph.balance * graph.balance;
    EXPECT_LE((squared - std::tan(0.8) * MatrixXd::Identity(2, 2)).norm(), kRounded);
  }
  const Graph both = graph_of(plane_of(kPi / 2, 0));
  EXPECT_EQ(both.kernel, 1);
  EXPECT_TRUE(both.balance.allFinite());
}

}  // namespace
}  // namespace carnot::internal::lagrangian_plane_test
