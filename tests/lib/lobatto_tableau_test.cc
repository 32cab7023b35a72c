#include "carnot/tableau/lobatto_tableau.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "carnot/tableau/order_conditions.h"
#include "carnot/tableau/rooted_trees.h"

namespace carnot::lobatto_tableau_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

// Over the number of stages s.
class LobattoTableauTest : public ::testing::TestWithParam<int> {
 protected:
  const int s_ = GetParam();
  const Tableau<double> tableau_ = lobatto_tableau<double>(s_);
  const Tableau<long double> wide_ = lobatto_tableau<long double>(s_);
  // Each law sums s terms of size at most 1 whose factors carry a few roundings of the nodes.
  const long double tolerance_ = 16 * s_ * kWideEps;
};

INSTANTIATE_TEST_SUITE_P(AllStages,
                         LobattoTableauTest,
                         ::testing::Range(2, kMostCoupledStages + 1),
                         [](const auto& stages) { return "s" + std::to_string(stages.param); });

// B(2s - 2); IIIA: C(s), D(s - 2); IIIB: C(s - 2), D(s). No more.
TEST_P(LobattoTableauTest, SimplifyingAssumptionsHold) {
  for (int k = 1; k <= 2 * s_ - 2; ++k) {
    EXPECT_LE(quadrature_defect(wide_, k), k * tolerance_) << "B, k = " << k;
  }
  for (int k = 1; k <= s_; ++k) {
    EXPECT_LE(stage_defect(wide_, k), k * tolerance_) << "k = " << k;
    EXPECT_LE(transposed_defect(wide_, k, Part::kMomentum), k * tolerance_) << "k = " << k;
  }
  for (int k = 1; k <= s_ - 2; ++k) {
    EXPECT_LE(stage_defect(wide_, k, Part::kMomentum), k * tolerance_) << "k = " << k;
    EXPECT_LE(transposed_defect(wide_, k), k * tolerance_) << "k = " << k;
  }
  if (s_ <= 8) {  // above round-off up to here
    EXPECT_GT(quadrature_defect(wide_, 2 * s_ - 1), 4 * tolerance_);
    EXPECT_GT(stage_defect(wide_, s_ - 1, Part::kMomentum), 4 * tolerance_);
    EXPECT_GT(transposed_defect(wide_, s_ - 1), 4 * tolerance_);
  }
}

// All trees with vertices of two colours: q' = f(q, p), p' = g(q, p).
TEST_P(LobattoTableauTest, OrderConditionsOfColouredTreesHold) {
  constexpr int kMostOrder = 7;
  constexpr int kRoundings = 4;  // every entry of a term is rounded to half a unit
  const RootedTrees<double> trees(tableau_, kMostOrder);
  EXPECT_EQ(tableau_.order, 2 * s_ - 2);
  EXPECT_EQ(trees.order(kRoundings), std::min(2 * s_ - 2, kMostOrder));
}

TEST(ColouredTreesTest, AreCountedWithoutTheColourOfTheRoot) {
  // Half of 2, 4, 14, 52, 214, 916, 4116, 18996, the rooted trees with two colours.
  const RootedTrees<double> trees(lobatto_tableau<double>(5), 8);
  const int counts[] = {1, 2, 7, 26, 107, 458, 2058, 9498};
  for (int order = 1; order <= 8; ++order) {
    EXPECT_EQ(trees.of_order(order).trees, counts[order - 1]) << order;
  }
  EXPECT_EQ(trees.order(4), 8);
}

TEST_P(LobattoTableauTest, PairIsSymplecticExactly) {
  EXPECT_TRUE(is_symplectic(tableau_));
  EXPECT_TRUE(is_symplectic(wide_));
  for (int i = 0; i < s_; ++i) {
    for (int j = 0; j < s_; ++j) {
      EXPECT_EQ(tableau_.mu_p(i, j), 1.0 - tableau_.mu(j, i));
      EXPECT_EQ(tableau_.mu(j, i), 1.0 - tableau_.mu_p(i, j));
      EXPECT_EQ(wide_.mu(j, i), 1.0L - wide_.mu_p(i, j));
    }
  }
}

TEST_P(LobattoTableauTest, NeitherOfThePairIsSymplecticAlone) {
  Tableau<double> alone = tableau_;
  alone.partitioned = false;
  EXPECT_FALSE(is_symplectic(alone));
  alone.mu = tableau_.mu_p;
  EXPECT_FALSE(is_symplectic(alone));
}

// Reflection t -> 1 - t maps both to themselves, exactly.
TEST_P(LobattoTableauTest, BothAreSymmetric) {
  for (int i = 0; i < s_; ++i) {
    const int ri = s_ - 1 - i;
    EXPECT_EQ(tableau_.b[i], tableau_.b[ri]);
    EXPECT_NEAR(tableau_.c[i] + tableau_.c[ri], 1, kEps);
    for (int j = 0; j < s_; ++j) {
      EXPECT_EQ(tableau_.mu(i, j) + tableau_.mu(ri, s_ - 1 - j), 1.0);
      EXPECT_EQ(tableau_.mu_p(i, j) + tableau_.mu_p(ri, s_ - 1 - j), 1.0);
    }
  }
}

// Q_1 = q and Q_s = q+ exactly; L_s does not enter P_i and L_1 enters all with weight 1.
TEST_P(LobattoTableauTest, EndsAreStagesOfQ) {
  EXPECT_EQ(tableau_.c[0], 0.0);
  EXPECT_EQ(tableau_.c[s_ - 1], 1.0);
  for (int j = 0; j < s_; ++j) {
    EXPECT_EQ(tableau_.mu(0, j), 0.0);
    EXPECT_EQ(tableau_.mu(s_ - 1, j), 1.0);
    EXPECT_EQ(tableau_.mu_p(j, 0), 1.0);
    EXPECT_EQ(tableau_.mu_p(j, s_ - 1), 0.0);
  }
}

// Rounded once: each double entry is the long double one to a unit of the larger of the pair.
TEST_P(LobattoTableauTest, DoubleIsTheRoundedWideTableau) {
  constexpr double kHalfUnit = 0.501 * kEps;  // of numbers up to 1, plus the wide error
  const auto error = [](double x, long double wide) { return static_cast<double>(x - wide); };
  for (int i = 0; i < s_; ++i) {
    EXPECT_NEAR(error(tableau_.c[i], wide_.c[i]), 0, kHalfUnit);
    EXPECT_NEAR(error(tableau_.b[i], wide_.b[i]), 0, kHalfUnit);
    for (int j = 0; j < s_; ++j) {
      const double mu = tableau_.mu(i, j);
      const double unit = std::max(std::abs(mu), std::abs(1 - mu));
      EXPECT_NEAR(error(mu, wide_.mu(i, j)), 0, kHalfUnit * std::max(1.0, unit));
    }
  }
}

// So the exactness of 1 - mu is not a matter of mu in [0, 1].
TEST(LobattoTableauClosedForm, EntriesLieOutsideTheUnitInterval) {
  EXPECT_LT(lobatto_tableau<double>(4).mu.minCoeff(), -0.01);
  EXPECT_GT(lobatto_tableau<double>(4).mu.maxCoeff(), 1.01);
}

TEST(LobattoTableauClosedForm, TwoStagesAreStoermerVerlet) {
  const auto t = lobatto_tableau<double>(2);
  EXPECT_EQ(t.b, (Vector<double, 2>(0.5, 0.5)));
  EXPECT_EQ(t.mu, (Matrix<double, 2, 2>{{0, 0}, {1, 1}}));
  EXPECT_EQ(t.mu_p, (Matrix<double, 2, 2>{{1, 0}, {1, 0}}));
}

TEST(LobattoTableauClosedForm, ThreeStages) {
  const auto t = lobatto_tableau<double>(3);
  Matrix<double, 3, 3> a;
  Matrix<double, 3, 3> a_p;
  // clang-format off
  a << 0,       0,      0,
       5. / 24, 1. / 3, -1. / 24,
       1. / 6,  2. / 3, 1. / 6;
  a_p << 1. / 6, -1. / 6, 0,
         1. / 6, 1. / 3,  0,
         1. / 6, 5. / 6,  0;
  // clang-format on
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(t.mu(i, j) * t.b[j], a(i, j), kEps);
      EXPECT_NEAR(t.mu_p(i, j) * t.b[j], a_p(i, j), kEps);
    }
  }
}

TEST(LobattoTableauClosedForm, FourStages) {
  const auto t = lobatto_tableau<double>(4);
  const double r = std::sqrt(5.0);
  EXPECT_NEAR(t.c[1], (5 - r) / 10, kEps);
  EXPECT_NEAR(t.b[0], 1. / 12, kEps);
  EXPECT_NEAR(t.b[1], 5. / 12, kEps);
  EXPECT_NEAR(t.mu(1, 0) * t.b[0], (11 + r) / 120, kEps);
  EXPECT_NEAR(t.mu(1, 1) * t.b[1], (25 - r) / 120, kEps);
  EXPECT_NEAR(t.mu(1, 2) * t.b[2], (25 - 13 * r) / 120, kEps);
  EXPECT_NEAR(t.mu(1, 3) * t.b[3], (-1 + r) / 120, kEps);
  EXPECT_NEAR(t.mu_p(0, 1) * t.b[1], (-1 - r) / 24, kEps);
  EXPECT_NEAR(t.mu_p(1, 2) * t.b[2], (25 - 13 * r) / 120, kEps);
}

}  // namespace
}  // namespace carnot::lobatto_tableau_test
