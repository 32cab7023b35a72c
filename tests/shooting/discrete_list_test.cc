#include "carnot/shooting/search/discrete_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shooting/problems.h"

namespace carnot::internal::discrete_list_test {
namespace {

constexpr double kPi = std::numbers::pi;

// The straight line of the Heisenberg group to (1, 0, 0) with a wiggle in y. The action grows with
// its size.
Path wiggle(double size, int intervals = 32) {
  Path path{intervals, 3, {}, {}, {}};
  for (int i = 0; i <= intervals; ++i) {
    const double s = static_cast<double>(i) / intervals;
    path.q.insert(path.q.end(), {s, size * std::sin(kPi * s), 0});
  }
  path.lambda.assign(intervals, 0.0);
  return path;
}

// The same turned about z.
Path turned(Path path, double angle) {
  for (int i = 0; i <= path.intervals; ++i) {
    double* q = path.configuration(i);
    const double x = q[0];
    q[0] = std::cos(angle) * x - std::sin(angle) * q[1];
    q[1] = std::sin(angle) * x + std::cos(angle) * q[1];
  }
  return path;
}

struct DiscreteListTest : testing::Test {
  BoundaryValueProblem problem = test::heisenberg_group({1, 0, 0});
  DiscreteList list{problem};
  ExtremalList extremals;
};

TEST_F(DiscreteListTest, KnowsWhatItHasSeen) {
  EXPECT_EQ(list.least(), nullptr);
  EXPECT_EQ(list.find(wiggle(0.1), extremals), 0U);
  EXPECT_EQ(list.add(wiggle(0.1)), 0U);
  EXPECT_EQ(list.add(wiggle(0.3)), 1U);
  EXPECT_EQ(list.find(wiggle(0.1), extremals), 0U);
  EXPECT_EQ(list.find(wiggle(0.3 + 1e-9), extremals), 1U);
  EXPECT_EQ(list.find(wiggle(0.2), extremals), list.size());
  EXPECT_EQ(list.find(wiggle(0.1, 64), extremals), list.size()) << "another grid";
}

TEST_F(DiscreteListTest, MirrorPartnersAreTheSame) {
  const std::vector<ProblemSymmetry> symmetries = symmetries_of(problem);
  ASSERT_FALSE(symmetries.empty());
  const Path path = turned(wiggle(0.2), 0.4);
  list.add(path);
  for (const ProblemSymmetry& symmetry : symmetries) {
    EXPECT_EQ(list.find(partner(problem.dynamics.info, symmetry, path), extremals), 0U);
  }
}

TEST_F(DiscreteListTest, MembersOfAFamilyAreTheSame) {
  list.add(wiggle(0.2));
  const Path member = turned(wiggle(0.2), 0.4);
  EXPECT_EQ(list.find(member, extremals), list.size());
  Extremal found;
  found.path = {{0}, {1}};
  found.singular = true;
  list[0].fate = Fate::kExtremal;
  list[0].extremal = extremals.add(found);
  EXPECT_EQ(list.find(member, extremals), 0U);
}

TEST_F(DiscreteListTest, WhatIsClearlyLongerWaits) {
  for (const double size : {0.5, 0.1, 0.12}) list.add(wiggle(size));
  EXPECT_LT(list[1].action, list[2].action);
  EXPECT_EQ(list.least(), &list[1].path);
  std::vector<std::size_t> pending{0, 1, 2};
  EXPECT_THAT(list.take_promising(pending), testing::ElementsAre(1, 2));
  EXPECT_THAT(pending, testing::ElementsAre(0));
}

TEST_F(DiscreteListTest, OnlyVerifiedOnesAreMeasuresOnceThereAreAny) {
  for (const double size : {0.5, 0.1, 0.48}) list.add(wiggle(size));
  list[0].fate = Fate::kExtremal;
  list[1].fate = Fate::kArtefact;
  std::vector<std::size_t> pending{2};
  EXPECT_THAT(list.take_promising(pending), testing::ElementsAre(2));
  EXPECT_TRUE(pending.empty());
}

TEST_F(DiscreteListTest, GivesUp) {
  for (const double size : {0.1, 0.5, 0.6}) list.add(wiggle(size));
  list[2].hits = 3;
  EXPECT_EQ(list.give_up({1, 2}), 4);
  EXPECT_THAT(list.hits_given_up(), testing::ElementsAre(1, 3));
  EXPECT_EQ(list[0].fate, Fate::kPending);
}

TEST_F(DiscreteListTest, GivenUpOnesOfTheGridThatSawMoreOfThemCount) {
  list.add(wiggle(0.5));
  for (const double size : {0.5, 0.6}) list.add(wiggle(size, 64));
  EXPECT_EQ(list.give_up({0, 1, 2}), 3);
  EXPECT_THAT(list.hits_given_up(), testing::ElementsAre(1, 1));
  list[0].hits = 3;
  EXPECT_THAT(list.hits_given_up(), testing::ElementsAre(3));
}

}  // namespace
}  // namespace carnot::internal::discrete_list_test
