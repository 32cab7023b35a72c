#include "carnot/shooting/search/discrete_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "carnot/shooting/search/starts.h"
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

// How often starts hit each.
std::vector<int> starts_of(const std::vector<Hits>& hits) {
  std::vector<int> starts;
  for (const Hits& of_one : hits) starts.push_back(of_one.starts);
  return starts;
}

struct DiscreteListTest : testing::Test {
  BoundaryValueProblem problem = test::heisenberg_group({1, 0, 0});
  MassLadder ladder{problem};
  DiscreteList list{ladder};
  ExtremalList extremals;
};

TEST_F(DiscreteListTest, KnowsWhatItHasSeen) {
  EXPECT_EQ(list.least(), nullptr);
  EXPECT_EQ(list.find(wiggle(0.1), extremals), 0U);
  EXPECT_EQ(list.add(wiggle(0.1), kOneStart), 0U);
  EXPECT_EQ(list.add(wiggle(0.3), kOneStart), 1U);
  EXPECT_EQ(list.find(wiggle(0.1), extremals), 0U);
  EXPECT_EQ(list.find(wiggle(0.3 + 1e-9), extremals), 1U);
  EXPECT_EQ(list.find(wiggle(0.2), extremals), list.size());
  EXPECT_EQ(list.find(wiggle(0.1, 64), extremals), list.size()) << "another grid";
}

TEST_F(DiscreteListTest, MirrorPartnersAreTheSame) {
  const std::vector<ProblemSymmetry> symmetries = symmetries_of(problem);
  ASSERT_FALSE(symmetries.empty());
  const Path path = turned(wiggle(0.2), 0.4);
  list.add(path, kOneStart);
  for (const ProblemSymmetry& symmetry : symmetries) {
    EXPECT_EQ(list.find(partner(problem.dynamics.info, symmetry, path), extremals), 0U);
  }
}

TEST_F(DiscreteListTest, MembersOfAFamilyAreTheSame) {
  list.add(wiggle(0.2), kOneStart);
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
  for (const double size : {0.5, 0.1, 0.12}) list.add(wiggle(size), kOneStart);
  EXPECT_LT(list[1].action, list[2].action);
  EXPECT_EQ(list.least(), &list[1].path);
  std::vector<std::size_t> pending{0, 1, 2};
  EXPECT_THAT(list.take_promising(pending), testing::ElementsAre(1, 2));
  EXPECT_THAT(pending, testing::ElementsAre(0));
}

// Actions of paths with more mass are those of other problems.
TEST_F(DiscreteListTest, TheLeastIsOfTheLowestRung) {
  const BoundaryValueProblem light = test::light_steering({1, 1, 0.5, 0.2}, 1e-3);
  const MassLadder rungs(light);
  DiscreteList of_rungs(rungs);
  const auto path_on = [&](int rung, int number, int intervals) {
    Path path = make_start(light, 0, number, intervals).path;
    path.lambda.assign(2 * intervals, 0.0);
    path.rung = rung;
    return path;
  };
  ASSERT_EQ(of_rungs.add(path_on(2, 0, 16), kOneStart), 0U);  // the straight line: of least action
  EXPECT_EQ(of_rungs.least(), &of_rungs[0].path);
  ASSERT_EQ(of_rungs.add(path_on(1, 1, 16), kOneStart), 1U);
  ASSERT_EQ(of_rungs.add(path_on(1, 2, 16), kOneStart), 2U);
  ASSERT_LT(of_rungs[0].action, std::min(of_rungs[1].action, of_rungs[2].action));
  const std::size_t less = of_rungs[1].action < of_rungs[2].action ? 1 : 2;
  EXPECT_EQ(of_rungs.least(), &of_rungs[less].path);
  of_rungs.refine(0, {path_on(1, 3, 32), path_on(0, 4, 64)}, extremals);
  ASSERT_NE(of_rungs.least(), nullptr);
  EXPECT_EQ(of_rungs.least()->rung, 0);
  EXPECT_EQ(of_rungs.least()->intervals, 64);
}

TEST_F(DiscreteListTest, OnlyVerifiedOnesAreMeasuresOnceThereAreAny) {
  for (const double size : {0.5, 0.1, 0.48}) list.add(wiggle(size), kOneStart);
  list[0].fate = Fate::kExtremal;
  list[1].fate = Fate::kArtefact;
  std::vector<std::size_t> pending{2};
  EXPECT_THAT(list.take_promising(pending), testing::ElementsAre(2));
  EXPECT_TRUE(pending.empty());
}

TEST_F(DiscreteListTest, IsKnownOnTheGridsThatItWasRefinedTo) {
  list.add(wiggle(0.1), kOneStart);
  EXPECT_EQ(list.refine(0, {wiggle(0.11, 64), wiggle(0.12, 128)}, extremals), 0U);
  EXPECT_EQ(list.find(wiggle(0.1), extremals), 0U);
  EXPECT_EQ(list.find(wiggle(0.11, 64), extremals), 0U);
  EXPECT_EQ(list.find(wiggle(0.12, 128), extremals), 0U);
  EXPECT_EQ(list.find(wiggle(0.12, 64), extremals), list.size());
}

// A coarse grid makes two of it.
TEST_F(DiscreteListTest, WhatIsTheSameOnAFinerGridIsMerged) {
  list.add(wiggle(0.1), kOneStart);
  list.add(wiggle(0.3), kOneStart);
  ASSERT_EQ(list.refine(0, {wiggle(0.2, 64)}, extremals), 0U);
  EXPECT_EQ(list.refine(1, {wiggle(0.25, 64), wiggle(0.2, 128)}, extremals), 1U);
  list.add(wiggle(0.4), kOneStart);
  EXPECT_EQ(list.refine(2, {wiggle(0.2, 64)}, extremals), 0U);
  EXPECT_EQ(list[2].fate, Fate::kMerged);
  EXPECT_EQ(list.find(wiggle(0.4), extremals), 0U);
}

// (4 fine - coarse)/3 of the action on two grids is that of the curve up to h^4.
TEST_F(DiscreteListTest, ForetellsTheAction) {
  constexpr double kFourthOrder = 1e-2;  // of the error of the coarse grid; h^2 is 1e-3
  constexpr double kSize = 0.3;
  const auto lifted = [&](int intervals) {
    Path path = wiggle(kSize, intervals);
    for (int i = 0; i <= intervals; ++i) {
      const double s = static_cast<double>(i) / intervals;
      const double turned = s * std::sin(kPi * s) + 2 / kPi * (std::cos(kPi * s) - 1);
      path.configuration(i)[2] = 0.5 * kSize * turned;  // z' = (x y' - y x') / 2
    }
    return path;
  };
  list.add(lifted(32), kOneStart);
  EXPECT_FALSE(std::isfinite(list[0].uncertainty));
  list.refine(0, {lifted(64)}, extremals);
  const double exact = 0.5 + 0.25 * kSize * kSize * kPi * kPi;  // int (x'^2 + y'^2) / 2
  const double error = std::abs(list[0].action - exact);
  EXPECT_GT(error, 0);
  EXPECT_LT(std::abs(list[0].estimate - exact), kFourthOrder * error);
  EXPECT_TRUE(list[0].foretells(exact));
  EXPECT_FALSE(list[0].foretells(exact + error));
}

TEST_F(DiscreteListTest, FinerGridsTellWhatMayBeLeast) {
  for (const double size : {0.1, 0.11, 0.5}) list.add(wiggle(size), kOneStart);
  for (std::size_t i = 0; i < 3; ++i) {
    list[i].estimate = list[i].action;
    list[i].uncertainty = 0.01 * list[i].action;
  }
  EXPECT_THAT(list.perhaps_least({0, 1, 2}, 1e300), testing::ElementsAre(0, 1));
  EXPECT_TRUE(list.perhaps_least({0, 1, 2}, 0.5 * list[0].action).empty());
  list[2].uncertainty = 1;
  EXPECT_THAT(list.perhaps_least({0, 1, 2}, 1e300), testing::ElementsAre(0, 1, 2));
  list.add(wiggle(0.6), kOneStart);
  EXPECT_THAT(list.perhaps_least({0, 3}, 1e300), testing::ElementsAre(0, 3)) << "not refined";
}

TEST_F(DiscreteListTest, RivalsAreToldByFinerGrids) {
  for (const double size : {0.1, 0.11, 0.5}) list.add(wiggle(size), kOneStart);
  for (std::size_t i = 0; i < 3; ++i) {
    list[i].estimate = list[i].action;
    list[i].uncertainty = 0.01 * list[i].action;
  }
  EXPECT_THAT(list.beyond_rivals({0, 1, 2}, list[0].action), testing::ElementsAre(2));
  EXPECT_THAT(list.beyond_rivals({0, 1, 2}, 0.5 * list[0].action), testing::ElementsAre(0, 1, 2));
  list[2].uncertainty = 2;
  EXPECT_TRUE(list.beyond_rivals({0, 1, 2}, list[0].action).empty()) << "it may be one";
  list.add(wiggle(0.6), kOneStart);
  EXPECT_TRUE(list.beyond_rivals({0, 3}, list[0].action).empty()) << "not refined: it may be one";
}

TEST_F(DiscreteListTest, GivesUp) {
  for (const double size : {0.1, 0.5, 0.6}) list.add(wiggle(size), kOneStart);
  list[2].hits = {3, 2};
  EXPECT_EQ(list.give_up({1, 2}).starts, 4);
  EXPECT_THAT(starts_of(list.hits_given_up()), testing::ElementsAre(1, 3));
  EXPECT_EQ(list[0].fate, Fate::kPending);
}

TEST_F(DiscreteListTest, ThoseOfLeastActionThatLeadOnComeFirst) {
  for (const double size : {0.5, 0.1, 0.3, 0.2, 0.4}) list.add(wiggle(size), kOneStart);
  EXPECT_TRUE(list.least(5).empty()) << "none is known to be an extremal";
  for (const std::size_t i : {0, 1, 2}) list[i].fate = Fate::kExtremal;
  list[3].fate = Fate::kArtefact;
  list[4].fate = Fate::kGivenUp;
  EXPECT_THAT(list.least(3), testing::ElementsAre(&list[1].path, &list[2].path, &list[4].path));
  EXPECT_EQ(list.least(9).size(), 4U);
}

TEST_F(DiscreteListTest, GivenUpOnesOfTheGridThatSawMoreOfThemCount) {
  list.add(wiggle(0.5), kOneStart);
  for (const double size : {0.5, 0.6}) list.add(wiggle(size, 64), kOneStart);
  EXPECT_EQ(list.give_up({0, 1, 2}).all(), 3);
  EXPECT_THAT(starts_of(list.hits_given_up()), testing::ElementsAre(1, 1));
  list[0].hits = {3, 0};
  EXPECT_THAT(starts_of(list.hits_given_up()), testing::ElementsAre(3));
}

}  // namespace
}  // namespace carnot::internal::discrete_list_test
