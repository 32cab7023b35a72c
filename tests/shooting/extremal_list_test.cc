#include "carnot/shooting/search/extremal_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace carnot::internal::extremal_list_test {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// A path in the line from 0 by way of `middle` to 1.
Extremal extremal(double action, double middle) {
  Extremal result;
  result.geodesic.action = action;
  result.geodesic.length = action;
  result.path = {{0}, {middle}, {1}};
  return result;
}

// The path through -middle, and the path itself.
std::vector<Extremal> mirrored(const Extremal& of) {
  Extremal image = of;
  image.path[1][0] *= -1;
  return {image, of};
}

TEST(ExtremalList, KeepsWhatIsDistinct) {
  ExtremalList list;
  EXPECT_TRUE(list.empty());
  EXPECT_EQ(list.add(extremal(1, 0.3)), 0U);
  EXPECT_EQ(list.add(extremal(2, 0.4)), 1U);
  EXPECT_EQ(list.add(extremal(1, 0.3 + 1e-8)), 0U);
  EXPECT_EQ(list.size(), 2U);
}

TEST(ExtremalList, WhatNeedsNoKnotsTakesThePlace) {
  ExtremalList list;
  Extremal joined = extremal(1, 0.3);
  joined.geodesic.verification = Verification::kKnots;
  list.add(joined);
  list.add(extremal(1, 0.3));
  EXPECT_EQ(list[0].geodesic.verification, Verification::kSingle);
  list.add(joined);
  EXPECT_EQ(list[0].geodesic.verification, Verification::kSingle);
  EXPECT_EQ(list.size(), 1U);
}

TEST(ExtremalList, OneMemberStandsForAFamily) {
  ExtremalList list;
  Extremal member = extremal(1, 0.3);
  member.singular = true;
  list.add(member);
  member.path[1][0] = -0.7;
  EXPECT_EQ(list.add(member), 0U);
  member.singular = false;
  EXPECT_EQ(list.add(member), 1U);
}

testing::Matcher<Hits> are(int starts, int crossings) {
  return testing::AllOf(testing::Field(&Hits::starts, starts),
                        testing::Field(&Hits::crossings, crossings));
}

TEST(ExtremalList, PartnersAreHitTogether) {
  ExtremalList list(mirrored);
  list.add(extremal(2, 0.4));
  list.add(extremal(1, 0.3));
  ASSERT_EQ(list.size(), 4U);
  EXPECT_EQ(list[1].path[1][0], -0.4);
  list.hit(0, {1, 0});
  list.hit(1, {1, 3});
  EXPECT_THAT(list.hits(), testing::ElementsAre(are(2, 3)));
  list.hit(3, {0, 1});
  EXPECT_THAT(list.hits(), testing::ElementsAre(are(2, 3), are(0, 1)));
  std::vector<int> hits;
  for (const Extremal& each : list.up_to(kUnlimited)) hits.push_back(each.geodesic.hits);
  EXPECT_THAT(hits, testing::ElementsAre(5, 5, 1, 1));
}

TEST(ExtremalList, LongOnesAreLeftOut) {
  ExtremalList list;
  list.add(extremal(3, 0.3));
  list.add(extremal(1, 0.4));
  EXPECT_EQ(list.up_to(2).size(), 1U);
  EXPECT_EQ(list.up_to(2)[0].geodesic.action, 1);
  EXPECT_TRUE(list.up_to(0.5).empty());
  EXPECT_EQ(list.size(), 2U);
}

TEST(ExtremalList, CompetitionForTheLeastAction) {
  ExtremalList list;
  list.add(extremal(1.5, 0.1));
  list.add(extremal(1 + 1e-12, 0.2));
  list.add(extremal(1, 0.3));
  list.add(extremal(1.01, 0.4));
  for (int i = 0; i < 4; ++i) list.hit(i, {1 << i, i});
  EXPECT_EQ(list.best(), 2U);
  EXPECT_EQ(list.least_action(), 1);
  EXPECT_THAT(list.competition().hits, are(2 + 4, 1 + 2));
  EXPECT_EQ(list.competition().rivals, 3);
}

}  // namespace
}  // namespace carnot::internal::extremal_list_test
