#include "carnot/shooting/extremal/ranking.h"

#include <gtest/gtest.h>

#include <cmath>

namespace carnot::internal::ranking_test {
namespace {

Extremal extremal(double action, double p) {
  Extremal result;
  result.geodesic.action = action;
  result.geodesic.p0 = {p};
  return result;
}

TEST(Ranking, ByActionThenByMomentum) {
  std::vector<Extremal> list{extremal(2, 0), extremal(1 + 1e-13, -3), extremal(1, 3)};
  rank(list);
  EXPECT_EQ(list[0].geodesic.p0[0], -3);
  EXPECT_EQ(list[1].geodesic.p0[0], 3);
  EXPECT_EQ(list[2].geodesic.action, 2);
}

TEST(Ranking, KnotsComeLastAmongEquals) {
  std::vector<Extremal> list{extremal(1, -3), extremal(1 + 1e-13, 3)};
  list[0].geodesic.verification = Verification::kKnots;
  rank(list);
  EXPECT_EQ(list[0].geodesic.p0[0], 3);
}

TEST(MissedEstimate, IsThatOfChao) {
  EXPECT_EQ(missed_estimate({}), 0);
  EXPECT_EQ(missed_estimate({7, 3, 5}), 0);
  EXPECT_FALSE(std::signbit(missed_estimate({7, 3, 5})));
  EXPECT_EQ(missed_estimate({1, 1, 1, 1, 2, 2, 9}), 4);
  EXPECT_EQ(missed_estimate({1, 1, 1}), 3);
}

TEST(MissedEstimate, IsAtLeastOneWhereTheLeastIsNoMinimumOrWasHitOnce) {
  Geodesic least;
  least.label = Label::kLocallyMinimal;
  least.hits = 7;
  EXPECT_EQ(missed_estimate({7, 3, 5}, least), 0);
  EXPECT_EQ(missed_estimate({1, 1, 1, 1, 2, 2, 9}, least), 4);
  least.hits = 1;
  EXPECT_EQ(missed_estimate({1, 3, 5}, least), 1);
  for (const Label label : {Label::kConjugatePassed, Label::kNotMinimal}) {
    least.label = label;
    least.hits = 7;
    EXPECT_EQ(missed_estimate({7, 3, 5}, least), 1);
    EXPECT_EQ(missed_estimate({1, 1, 1, 1, 2, 2, 9}, least), 4);
  }
}

}  // namespace
}  // namespace carnot::internal::ranking_test
