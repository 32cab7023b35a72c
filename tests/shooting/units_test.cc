// Units are a symplectic change of coordinates in which a short extremal has the length of one.
#include "carnot/shooting/problem/units.h"

#include <gtest/gtest.h>

#include "carnot/shooting/linear/dense.h"
#include "shooting/problems.h"
#include "shooting/symplectic.h"
#include "testing/canonical.h"

namespace carnot::internal::units_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRounded = 1e-12;
const std::vector<double> kShort{0.01, -0.005, 3e-4};

// An extremal of the Heisenberg group and the matrix of a shear, which is symplectic.
struct UnitsTest : testing::Test {
  BoundaryValueProblem problem = test::heisenberg_group({0.01, 0, 1e-5}, 2);
  Units units{problem, kShort};
  MatrixXd shear = test::symplectic_shear(3);
};

TEST_F(UnitsTest, LongExtremalsNeedNone) {
  const std::vector<double> p0{1, 0, 0};
  const Units none(problem, p0);
  EXPECT_FALSE(none.scaled());
  EXPECT_EQ(none.map(shear), shear);
  EXPECT_EQ(none.tangent(shear.rightCols(3)), shear.rightCols(3));
  EXPECT_EQ(none.size(VectorXd::Constant(3, 2)), VectorXd::Constant(3, 2).norm());
}

TEST_F(UnitsTest, ScenesWithoutTranscriptionHaveNone) {
  const BoundaryValueProblem other = test::oscillator({0, 0}, {1e-3, 0}, 1);
  const std::vector<double> p0{1e-3, 0};
  EXPECT_EQ(Units(other, p0).scaled(), other.dynamics.has_transcription());
}

TEST_F(UnitsTest, KeepSymplecticMaps) {
  ASSERT_TRUE(units.scaled());
  const MatrixXd j = test::canonical(6, 3);
  const MatrixXd scaled = units.map(shear);
  EXPECT_LE((scaled.transpose() * j * scaled - j).norm(), kRounded * scaled.squaredNorm());
  EXPECT_LE((units.map(MatrixXd::Identity(6, 6)) - MatrixXd::Identity(6, 6)).norm(), kRounded);
}

TEST_F(UnitsTest, MapsOfAProductAreProducts) {
  const MatrixXd other = shear.transpose();
  const MatrixXd both = units.map(shear * other);
  EXPECT_LE((units.map(shear) * units.map(other) - both).norm(), kRounded * both.norm());
}

TEST_F(UnitsTest, TangentsAreTheLastColumns) {
  const MatrixXd columns = units.tangent(shear.rightCols(3));
  EXPECT_LE((units.map(shear).rightCols(3) - columns).norm(), kRounded * columns.norm());
}

// p.q = c p~.q~ with c = length^2 / T.
TEST_F(UnitsTest, MomentaAreDualToDisplacements) {
  const VectorXd p = Eigen::Vector3d(0.3, -1, 2);
  const VectorXd q = Eigen::Vector3d(0.02, 0.01, -1e-4);
  const MatrixXd momenta = units.momenta(p);
  const double length2 = 4 * (kShort[0] * kShort[0] + kShort[1] * kShort[1]);  // |q'| T, T = 2
  EXPECT_NEAR(momenta.col(0).dot(q) / (0.5 * length2 * p.dot(units.displacement(q))), 1, 1e-9);
  EXPECT_NEAR(units.size(momenta.col(0)), p.norm(), kRounded * p.norm());
}

// z takes a bracket: d^2 where x and y are of size d.
TEST_F(UnitsTest, AreGraded) {
  const double x = units.displacement(Eigen::Vector3d(1, 0, 0)).norm();
  const double z = units.displacement(Eigen::Vector3d(0, 0, 1)).norm();
  const double length = 2 * std::hypot(kShort[0], kShort[1]);
  EXPECT_NEAR(x * length, 1, 0.01);
  EXPECT_GT(z, 0.1 / (length * length));
}

}  // namespace
}  // namespace carnot::internal::units_test
