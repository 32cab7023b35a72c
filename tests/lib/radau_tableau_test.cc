#include "carnot/tableau/radau_tableau.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "carnot/tableau/order_conditions.h"
#include "carnot/tableau/rooted_trees.h"

namespace carnot::radau_tableau_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

// Over the number of stages s.
class RadauTableauTest : public ::testing::TestWithParam<int> {
 protected:
  const int s_ = GetParam();
  const Tableau<double> tableau_ = radau_tableau<double>(s_);
  const Tableau<long double> wide_ = radau_tableau<long double>(s_);
  // Each law sums s terms of size at most 1 whose factors carry a few roundings of the nodes.
  const long double tolerance_ = 16 * s_ * kWideEps;
};

INSTANTIATE_TEST_SUITE_P(AllStages,
                         RadauTableauTest,
                         ::testing::Range(1, kMostCoupledStages + 1),
                         [](const auto& stages) { return "s" + std::to_string(stages.param); });

// B(2s - 1), C(s), D(s - 1), and no more.
TEST_P(RadauTableauTest, SimplifyingAssumptionsHold) {
  for (int k = 1; k < 2 * s_; ++k) {
    EXPECT_LE(quadrature_defect(wide_, k), k * tolerance_) << "B, k = " << k;
  }
  for (int k = 1; k <= s_; ++k) {
    EXPECT_LE(stage_defect(wide_, k), k * tolerance_) << "C, k = " << k;
  }
  for (int k = 1; k < s_; ++k) {
    EXPECT_LE(transposed_defect(wide_, k), k * tolerance_) << "D, k = " << k;
  }
  if (s_ <= 8) {  // above round-off up to here
    EXPECT_GT(quadrature_defect(wide_, 2 * s_), 4 * tolerance_);
    EXPECT_GT(stage_defect(wide_, s_ + 1), 4 * tolerance_);
    EXPECT_GT(transposed_defect(wide_, s_), 4 * tolerance_);
  }
}

TEST_P(RadauTableauTest, OrderConditionsOfTreesHold) {
  constexpr int kMostOrder = 8;
  constexpr int kRoundings = 4;  // every entry of a term is rounded to half a unit
  const RootedTrees<double> trees(tableau_, kMostOrder);
  EXPECT_EQ(tableau_.order, 2 * s_ - 1);
  EXPECT_EQ(trees.order(kRoundings), std::min(2 * s_ - 1, kMostOrder));
}

// The last stage is the end of the step.
TEST_P(RadauTableauTest, IsStifflyAccurate) {
  EXPECT_EQ(tableau_.c[s_ - 1], 1.0);
  for (int j = 0; j < s_; ++j) EXPECT_EQ(tableau_.mu(s_ - 1, j), 1.0);
  EXPECT_EQ(tableau_.update.minCoeff(), 1.0);
}

TEST_P(RadauTableauTest, NodesAscend) {
  for (int i = 0; i < s_; ++i) {
    EXPECT_GT(tableau_.c[i], i == 0 ? 0.0 : tableau_.c[i - 1]);
    EXPECT_GT(tableau_.b[i], 0.0);
  }
}

TEST_P(RadauTableauTest, IsNotSymplectic) { EXPECT_FALSE(is_symplectic(tableau_)); }

// Rounded once: each double entry is the long double one to half a unit.
TEST_P(RadauTableauTest, DoubleIsTheRoundedWideTableau) {
  constexpr double kHalfUnit = 0.501 * kEps;  // of numbers up to 1, plus the wide error
  const auto error = [](double x, long double wide) { return static_cast<double>(x - wide); };
  for (int i = 0; i < s_; ++i) {
    EXPECT_NEAR(error(tableau_.c[i], wide_.c[i]), 0, kHalfUnit);
    EXPECT_NEAR(error(tableau_.b[i], wide_.b[i]), 0, kHalfUnit);
    for (int j = 0; j < s_; ++j) {
      const double unit = std::max(1.0, std::abs(tableau_.mu(i, j)));
      EXPECT_NEAR(error(tableau_.mu(i, j), wide_.mu(i, j)), 0, kHalfUnit * unit);
    }
  }
}

TEST(RadauTableauClosedForm, OneStageIsTheImplicitEulerRule) {
  const auto t = radau_tableau<double>(1);
  EXPECT_EQ(t.c[0], 1.0);
  EXPECT_EQ(t.b[0], 1.0);
  EXPECT_EQ(t.mu(0, 0), 1.0);
}

TEST(RadauTableauClosedForm, TwoStages) {
  const auto t = radau_tableau<double>(2);
  EXPECT_NEAR(t.c[0], 1. / 3, kEps);
  EXPECT_NEAR(t.b[0], 3. / 4, kEps);
  EXPECT_NEAR(t.b[1], 1. / 4, kEps);
  EXPECT_NEAR(t.mu(0, 0) * t.b[0], 5. / 12, kEps);
  EXPECT_NEAR(t.mu(0, 1) * t.b[1], -1. / 12, kEps);
}

TEST(RadauTableauClosedForm, ThreeStages) {
  const auto t = radau_tableau<double>(3);
  const double r = std::sqrt(6.0);
  Matrix<double, 3, 3> a;
  // clang-format off
  a << (88 - 7 * r) / 360,     (296 - 169 * r) / 1800, (-2 + 3 * r) / 225,
       (296 + 169 * r) / 1800, (88 + 7 * r) / 360,     (-2 - 3 * r) / 225,
       (16 - r) / 36,          (16 + r) / 36,          1. / 9;
  // clang-format on
  EXPECT_NEAR(t.c[0], (4 - r) / 10, kEps);
  EXPECT_NEAR(t.c[1], (4 + r) / 10, kEps);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(t.mu(i, j) * t.b[j], a(i, j), kEps);
  }
}

}  // namespace
}  // namespace carnot::radau_tableau_test
