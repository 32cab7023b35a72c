#include "carnot/tableau/composition_tableau.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "carnot/tableau/rooted_trees.h"

namespace carnot::composition_tableau_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

// Over the order.
class CompositionTableauTest : public ::testing::TestWithParam<int> {
 protected:
  const int order_ = GetParam();
  const Tableau<double> tableau_ = composition_tableau<double>(order_);
  const Tableau<long double> wide_ = composition_tableau<long double>(order_);
  const int s_ = tableau_.stages();
};

INSTANTIATE_TEST_SUITE_P(AllOrders,
                         CompositionTableauTest,
                         ::testing::Values(2, 4, 6, 8),
                         [](const auto& order) { return "order" + std::to_string(order.param); });

// All trees up to the order, in absolute terms; the next order fails.
TEST_P(CompositionTableauTest, OrderConditionsOfTreesHold) {
  constexpr double kTolerance = 1e-16;  // b is off by kEps, damped by the small steps it belongs to
  const RootedTrees<double> trees(tableau_, order_ + 1);
  const RootedTrees<long double> wide_trees(wide_, order_ + 1);
  EXPECT_EQ(tableau_.order, order_);
  for (int order = 1; order <= order_; ++order) {
    EXPECT_LE(trees.of_order(order).error, kTolerance) << order;
    EXPECT_LE(wide_trees.of_order(order).error, kTolerance * kWideEps / kEps) << order;
  }
  EXPECT_GT(trees.of_order(order_ + 1).error, 1e-6);
}

// The error at equal work, s^order times the coefficient of h^(order + 1), as the header says.
TEST(CompositionErrorTest, IsSmallerThanThatOfFewerStages) {
  const auto error_at_equal_work = [](const Tableau<long double>& tableau) {
    const RootedTrees<long double> trees(tableau, tableau.order + 1);
    return trees.error_constant(tableau.order + 1) * std::pow(tableau.stages(), tableau.order);
  };
  const auto own = [&](int order) {
    return error_at_equal_work(composition_tableau<long double>(order));
  };
  // Their ends leave [0, 1], which costs the rounding of the table a few epsilons.
  const auto triple_jump =
      make_composition_tableau<long double, 1>(4, {"1.351207191959657634047687808971460827"});
  const auto yoshida =
      make_composition_tableau<long double, 3>(6,
                                               {"0.784513610477557263819497633866",
                                                "0.235573213359358133684793182979",
                                                "-1.177679984178871006946415680964"});
  const auto suzuki_umeno =
      make_composition_tableau<long double, 7>(8,
                                               {"0.74167036435061295344822780",
                                                "-0.40910082580003159399730010",
                                                "0.19075471029623837995387626",
                                                "-0.57386247111608226665638773",
                                                "0.29906418130365592384446354",
                                                "0.33462491824529818378495798",
                                                "0.31529309239676659663205666"});
  EXPECT_NEAR(own(4), 1.55, 0.005);
  EXPECT_NEAR(error_at_equal_work(triple_jump), 8.2, 0.05);
  EXPECT_NEAR(own(6), 192, 0.5);
  EXPECT_NEAR(error_at_equal_work(yoshida), 523, 0.5);
  EXPECT_NEAR(own(8), 5.9e4, 0.05e4);
  EXPECT_NEAR(error_at_equal_work(suzuki_umeno), 1.9e5, 0.05e5);
}

TEST_P(CompositionTableauTest, IsDiagonallyImplicit) {
  EXPECT_EQ(tableau_.coupling, Coupling::kDiagonal);
  EXPECT_FALSE(tableau_.partitioned);
  for (int i = 0; i < s_; ++i) {
    for (int j = 0; j < s_; ++j) {
      EXPECT_EQ(tableau_.mu(i, j), j < i ? 1.0 : (i == j ? 0.5 : 0.0));
    }
  }
  EXPECT_TRUE(is_symplectic(tableau_));
  EXPECT_TRUE(is_symplectic(wide_));
}

// To the last bit: b is a palindrome, sums to one from either end, and c are the midpoints.
template <class T>
void expect_exact_steps(const Tableau<T>& tableau) {
  const int s = tableau.stages();
  T sum(0);
  for (int i = 0; i < s; ++i) {
    EXPECT_EQ(tableau.b[i], tableau.b[s - 1 - i]);
    EXPECT_EQ(tableau.c[i], sum + tableau.b[i] / 2);
    EXPECT_EQ(tableau.c[i] + tableau.c[s - 1 - i], T(1));
    EXPECT_EQ(tableau.omega[i], tableau.b[i]);
    EXPECT_GE(sum, T(0));
    EXPECT_LE(sum, T(1));
    sum += tableau.b[i];
  }
  EXPECT_EQ(sum, T(1));
}

TEST_P(CompositionTableauTest, StepsAreExact) {
  expect_exact_steps(tableau_);
  expect_exact_steps(wide_);
}

TEST_P(CompositionTableauTest, DoubleIsTheRoundedWideTableau) {
  for (int i = 0; i < s_; ++i) {
    // Both ends of a step are off by half a unit of one.
    EXPECT_NEAR(static_cast<double>(tableau_.b[i] - wide_.b[i]), 0, 1.001 * kEps);
  }
}

TEST(CompositionClosedForm, OrderFourIsSuzukis) {
  const auto t = composition_tableau<long double>(4);
  const long double gamma = 1 / (4 - std::cbrt(4.0L));
  for (const int i : {0, 1, 3, 4}) EXPECT_LE(std::abs(t.b[i] - gamma), 2 * kWideEps);
  EXPECT_LE(std::abs(t.b[2] - (1 - 4 * gamma)), 8 * kWideEps);
}

}  // namespace
}  // namespace carnot::composition_tableau_test
