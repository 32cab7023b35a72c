#include "carnot/tableau/dop853_tableau.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/tableau/order_conditions.h"
#include "carnot/tableau/rooted_trees.h"

namespace carnot::dop853_tableau_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();
constexpr int kStages = 12;

class Dop853TableauTest : public ::testing::Test {
 protected:
  const Tableau<double> tableau_ = dop853_tableau<double>();
  const Tableau<long double> wide_ = dop853_tableau<long double>();
  // A law sums up to twelve terms as large as 44, each with a few roundings.
  const long double tolerance_ = 44 * kStages * kWideEps;
};

// All 200 rooted trees up to order 8; order 9 fails.
TEST_F(Dop853TableauTest, OrderConditionsOfTreesHold) {
  constexpr int kRoundings = 4;  // every entry of a term is rounded to half a unit
  const RootedTrees<double> trees(tableau_, 9);
  const RootedTrees<long double> wide_trees(wide_, 9);
  EXPECT_EQ(tableau_.order, 8);
  EXPECT_EQ(trees.order(kRoundings), 8);
  EXPECT_EQ(wide_trees.order(kRoundings), 8);
}

TEST_F(Dop853TableauTest, QuadratureHasDegreeOfExactness8) {
  for (int k = 1; k <= 8; ++k) {
    EXPECT_LE(quadrature_defect(wide_, k), k * tolerance_) << "k = " << k;
  }
  EXPECT_GT(quadrature_defect(wide_, 9), 1e-4L);
}

// C(1) everywhere: the nodes, known exactly, are the row sums. C(2) from the third stage on, C(3)
// from the fourth (with a_i2 = 0), and D(1).
TEST_F(Dop853TableauTest, SimplifyingAssumptionsHold) {
  EXPECT_LE(stage_defect(wide_, 1), tolerance_);
  EXPECT_LE(stage_defect(wide_, 2, Part::kPosition, 2), 2 * tolerance_);
  EXPECT_LE(stage_defect(wide_, 3, Part::kPosition, 3), 3 * tolerance_);
  EXPECT_LE(transposed_defect(wide_, 1), tolerance_);
  EXPECT_GT(stage_defect(wide_, 2, Part::kPosition, 1), 1e-4L);
}

TEST_F(Dop853TableauTest, IsExplicitWithVanishingWeights) {
  EXPECT_EQ(tableau_.coupling, Coupling::kExplicit);
  EXPECT_FALSE(tableau_.partitioned);
  for (int i = 0; i < kStages; ++i) {
    for (int j = i; j < kStages; ++j) EXPECT_EQ(tableau_.mu(i, j), 0.0);
    const bool vanishes = i >= 1 && i <= 4;
    EXPECT_EQ(tableau_.b[i] == 0.0, vanishes) << i;
    EXPECT_EQ(tableau_.update[i], vanishes ? 0.0 : 1.0) << i;
    EXPECT_EQ(tableau_.omega[i], vanishes ? 1.0 : tableau_.b[i]) << i;
  }
}

TEST_F(Dop853TableauTest, IsNotSymplectic) { EXPECT_FALSE(is_symplectic(tableau_)); }

TEST_F(Dop853TableauTest, DoubleIsTheRoundedWideTableau) {
  const auto error = [](double x, long double wide) {
    const double unit = std::max(1.0, std::abs(x)) * kEps;
    return static_cast<double>(x - wide) / unit;
  };
  constexpr double kHalfUnit = 0.502;  // plus the wide error
  for (int i = 0; i < kStages; ++i) {
    EXPECT_NEAR(error(tableau_.c[i], wide_.c[i]), 0, kHalfUnit);
    EXPECT_NEAR(error(tableau_.b[i], wide_.b[i]), 0, kHalfUnit);
    for (int j = 0; j < i; ++j) {
      EXPECT_NEAR(error(tableau_.mu(i, j), wide_.mu(i, j)), 0, kHalfUnit) << i << ' ' << j;
    }
  }
}

// The classical method of order 4, to hold the trees themselves to account.
TEST(RootedTreesTest, KnowTheClassicalMethod) {
  Tableau<double> classical;
  classical.b = Vector<double, 4>(1. / 6, 1. / 3, 1. / 3, 1. / 6);
  classical.c = Vector<double, 4>(0, 0.5, 0.5, 1);
  classical.mu = Matrix<double, 4, 4>{{0, 0, 0, 0}, {3, 0, 0, 0}, {0, 1.5, 0, 0}, {0, 0, 3, 0}};
  set_weights(classical);
  const RootedTrees<double> trees(classical, 9);
  EXPECT_EQ(trees.order(2), 4);
  // The tree with all leaves at the root: |1 - 5 sum b c^4| = 1/24.
  EXPECT_NEAR(static_cast<double>(quadrature_defect(classical, 5)), 1. / 24, 4 * kEps);
  const int counts[] = {1, 1, 2, 4, 9, 20, 48, 115, 286};
  for (int order = 1; order <= 9; ++order) {
    EXPECT_EQ(trees.of_order(order).trees, counts[order - 1]) << order;
  }
}

// Euler's rule: Phi = 0 of every tree but the first, so the coefficients of h^order in the error
// are 1/(gamma sigma), |t| = order: 1/2; then 1/3 and 1/2 over sigma = 2, and 1/6.
TEST(RootedTreesTest, CountSymmetriesInTheErrorConstant) {
  Tableau<double> euler;
  euler.b.setOnes(1);
  euler.c.setZero(1);
  euler.mu.setZero(1, 1);
  set_weights(euler);
  const RootedTrees<double> trees(euler, 3);
  EXPECT_EQ(trees.order(1), 1);
  EXPECT_NEAR(trees.error_constant(2), 1. / 2, kEps);
  EXPECT_NEAR(trees.error_constant(3), std::hypot(1. / 6, 1. / 6), kEps);
}

}  // namespace
}  // namespace carnot::dop853_tableau_test
