#include "carnot/tableau/gauss_tableau.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "carnot/tableau/order_conditions.h"
#include "carnot/tableau/rooted_trees.h"

namespace carnot::gauss_tableau_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

// Over the number of stages s.
class GaussTableauTest : public ::testing::TestWithParam<int> {
 protected:
  const int s_ = GetParam();
  const Tableau<double> tableau_ = gauss_tableau<double>(s_);
  const Tableau<long double> wide_ = gauss_tableau<long double>(s_);
  // Each law sums s terms of size at most 1 whose factors carry a few roundings
  // of the nodes.
  const long double tolerance_ = 16 * s_ * kWideEps;
};

INSTANTIATE_TEST_SUITE_P(AllStages,
                         GaussTableauTest,
                         ::testing::Range(1, kMostCoupledStages + 1),
                         [](const auto& stages) { return "s" + std::to_string(stages.param); });

// B(2s): the quadrature is exact for degree < 2s, and not for degree 2s.
TEST_P(GaussTableauTest, QuadratureHasDegreeOfExactness2s) {
  for (int k = 1; k <= 2 * s_; ++k) {
    EXPECT_LE(quadrature_defect(wide_, k), k * tolerance_) << "k = " << k;
  }
  if (s_ <= 8) {  // the defect, (s!)^4 / (2s)!^2, is above round-off up to here
    EXPECT_GT(quadrature_defect(wide_, 2 * s_ + 1), 4 * tolerance_);
  }
}

// C(s): the stages are exact for polynomials of degree < s.
TEST_P(GaussTableauTest, StagesCollocate) {
  for (int k = 1; k <= s_; ++k) {
    EXPECT_LE(stage_defect(wide_, k), k * tolerance_) << "k = " << k;
  }
}

// D(s).
TEST_P(GaussTableauTest, TransposedStagesCollocate) {
  for (int k = 1; k <= s_; ++k) {
    EXPECT_LE(transposed_defect(wide_, k), k * tolerance_) << "k = " << k;
  }
}

// Order 2s: B(2s), C(s), D(s) imply it (Butcher 1964), the trees show it.
TEST_P(GaussTableauTest, OrderConditionsOfTreesHold) {
  constexpr int kMostOrder = 8;
  constexpr int kRoundings = 4;  // every entry of a term is rounded to half a unit
  const RootedTrees<double> trees(tableau_, kMostOrder);
  EXPECT_EQ(tableau_.order, 2 * s_);
  EXPECT_EQ(trees.order(kRoundings), std::min(2 * s_, kMostOrder));
}

TEST_P(GaussTableauTest, SymplecticityHoldsExactly) {
  EXPECT_TRUE(is_symplectic(tableau_));
  EXPECT_TRUE(is_symplectic(wide_));
  for (int i = 0; i < s_; ++i) {
    for (int j = 0; j < s_; ++j) {
      EXPECT_EQ(tableau_.mu(j, i), 1.0 - tableau_.mu(i, j));
      EXPECT_EQ(wide_.mu(j, i), 1.0L - wide_.mu(i, j));
    }
  }
}

// Reflection t -> 1 - t maps the method to itself, exactly.
TEST_P(GaussTableauTest, IsSymmetric) {
  for (int i = 0; i < s_; ++i) {
    const int ri = s_ - 1 - i;
    EXPECT_EQ(tableau_.b[i], tableau_.b[ri]);
    EXPECT_NEAR(tableau_.c[i] + tableau_.c[ri], 1, kEps);
    for (int j = 0; j < s_; ++j) {
      EXPECT_EQ(tableau_.mu(i, j) + tableau_.mu(ri, s_ - 1 - j), 1.0);
      EXPECT_EQ(wide_.mu(i, j) + wide_.mu(ri, s_ - 1 - j), 1.0L);
    }
  }
}

// Rounded once: each double entry is the long double one to half a unit.
TEST_P(GaussTableauTest, DoubleIsTheRoundedWideTableau) {
  constexpr double kHalfUnit = 0.5001 * kEps;  // of numbers up to 1, plus the wide error
  const auto error = [](double x, long double wide) { return static_cast<double>(x - wide); };
  for (int i = 0; i < s_; ++i) {
    EXPECT_NEAR(error(tableau_.c[i], wide_.c[i]), 0, kHalfUnit);
    EXPECT_NEAR(error(tableau_.b[i], wide_.b[i]), 0, kHalfUnit);
    for (int j = 0; j < s_; ++j) {
      const long double mu = wide_.mu(i, j);
      const double unit = std::max(1.0, static_cast<double>(std::abs(mu)));
      EXPECT_NEAR(error(tableau_.mu(i, j), mu), 0, 2 * kHalfUnit * unit);
    }
  }
}

TEST_P(GaussTableauTest, NodesAscendInsideTheStep) {
  for (int i = 0; i < s_; ++i) {
    EXPECT_GT(tableau_.c[i], i == 0 ? 0.0 : tableau_.c[i - 1]);
    EXPECT_LT(tableau_.c[i], 1.0);
    EXPECT_GT(tableau_.b[i], 0.0);
  }
  EXPECT_NEAR(tableau_.b.sum(), 1, s_ * kEps);
}

// The extrapolated increments of a polynomial rate of degree < s are those of
// the next step.
TEST_P(GaussTableauTest, ExtrapolationReproducesPolynomials) {
  for (int degree = 0; degree < s_; ++degree) {
    for (int i = 0; i < s_; ++i) {
      long double sum = 0;
      long double size = 0;
      for (int j = 0; j < s_; ++j) {
        const long double term =
            wide_.extrapolation(i, j) * wide_.b[j] * std::pow(wide_.c[j], degree);
        sum += term;
        size += std::abs(term);
      }
      const long double exact = wide_.b[i] * std::pow(1 + wide_.c[i], degree);
      // Extrapolation is ill-conditioned: the terms are larger than their sum;
      // node differences as small as 1/s^2 enter s times.
      const long double tolerance = 16 * s_ * s_ * kWideEps * size;
      EXPECT_LE(std::abs(sum - exact), tolerance) << "degree " << degree << ", node " << i;
    }
  }
}

TEST(GaussTableauClosedForm, OneStageIsTheMidpointRule) {
  const auto t = gauss_tableau<double>(1);
  EXPECT_EQ(t.c[0], 0.5);
  EXPECT_EQ(t.b[0], 1.0);
  EXPECT_EQ(t.mu(0, 0), 0.5);
  EXPECT_EQ(t.extrapolation(0, 0), 1.0);
}

TEST(GaussTableauClosedForm, TwoStages) {
  const auto t = gauss_tableau<double>(2);
  const double r = std::sqrt(3.0) / 6;
  EXPECT_NEAR(t.c[0], 0.5 - r, kEps);
  EXPECT_NEAR(t.c[1], 0.5 + r, kEps);
  EXPECT_NEAR(t.b[0], 0.5, kEps);
  EXPECT_NEAR(t.mu(0, 1) * t.b[1], 0.25 - r, kEps);
  EXPECT_NEAR(t.mu(1, 0) * t.b[0], 0.25 + r, kEps);
}

TEST(GaussTableauClosedForm, ThreeStages) {
  const auto t = gauss_tableau<double>(3);
  const double r = std::sqrt(15.0);
  Matrix<double, 3, 3> a;
  // clang-format off
  a << 5. / 36,          2. / 9 - r / 15,  5. / 36 - r / 30,
       5. / 36 + r / 24, 2. / 9,           5. / 36 - r / 24,
       5. / 36 + r / 30, 2. / 9 + r / 15,  5. / 36;
  // clang-format on
  EXPECT_NEAR(t.c[0], 0.5 - r / 10, kEps);
  EXPECT_EQ(t.c[1], 0.5);
  EXPECT_NEAR(t.b[0], 5. / 18, kEps);
  EXPECT_NEAR(t.b[1], 4. / 9, kEps);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(t.mu(i, j) * t.b[j], a(i, j), kEps);
  }
}

// Of a number and its complement both are exact, also outside [0, 1].
TEST(RoundedWithComplementTest, SumsToOneExactly) {
  for (int k = -4000; k <= 4000; ++k) {
    const long double wide = static_cast<long double>(k) / 1237;
    const auto x = rounded_with_complement<double>(wide);
    const double complement = 1 - x;
    EXPECT_EQ(x + complement, 1.0) << k;
    EXPECT_EQ(1 - complement, x) << k;
    const double unit = std::max(1.0, static_cast<double>(std::abs(wide)));
    EXPECT_NEAR(static_cast<double>(x - wide), 0, kEps * unit) << k;
  }
}

template <class T, int s>
void expect_equal(const Tableau<T, s>& fixed, const Tableau<T>& of) {
  EXPECT_EQ(fixed.stages(), of.stages());
  EXPECT_EQ(fixed.order, of.order);
  EXPECT_EQ(fixed.c, of.c);
  EXPECT_EQ(fixed.b, of.b);
  EXPECT_EQ(fixed.omega, of.b);
  EXPECT_EQ(fixed.mu, of.mu);
  EXPECT_EQ(fixed.extrapolation, of.extrapolation);
  EXPECT_TRUE(is_symplectic(fixed));
}

TEST(FixedStagesTest, HoldTheSameNumbers) {
  expect_equal(fixed_stages<1>(gauss_tableau<double>(1)), gauss_tableau<double>(1));
  expect_equal(fixed_stages<8>(gauss_tableau<double>(8)), gauss_tableau<double>(8));
  expect_equal(fixed_stages<3>(gauss_tableau<long double>(3)), gauss_tableau<long double>(3));
}

}  // namespace
}  // namespace carnot::gauss_tableau_test
