#include "carnot/shooting/search/stopping_policy.h"

#include <gtest/gtest.h>

namespace carnot::internal::stopping_policy_test {
namespace {

GeodesicOptions options_for(int count, bool all = false, int starts = 0) {
  GeodesicOptions options;
  options.count = count;
  options.all = all;
  options.starts = starts;
  return options;
}

TEST(StoppingPolicy, StartsThatAreGivenAreAllDrawn) {
  const StoppingPolicy policy(options_for(1, false, 20), true, false);
  EXPECT_EQ(policy.left({}), 20);
  EXPECT_EQ(policy.left({16, 16, 10, 16}), 4) << "blocked ones count";
  EXPECT_EQ(policy.round({16, 16, 0, 16}), 4);
  EXPECT_FALSE(policy.may_end({16, 16, 0, 16}));
  EXPECT_EQ(policy.sweeps(), 0);
}

TEST(StoppingPolicy, BlockedStartsAreMadeUpFor) {
  const StoppingPolicy policy(options_for(1), true, false);
  const int limit = policy.left({});
  EXPECT_EQ(policy.left({8, 8, 5, 0}), limit - 8 + 5);
  EXPECT_EQ(policy.left({0, 0, 100 * limit, 0}), 3 * limit) << "up to twice the limit";
}

// Unless somebody asked for all of them.
TEST(StoppingPolicy, StartsThatOnlyTellOfRoundOffAreInVain) {
  const StoppingPolicy policy(options_for(1), true, false);
  EXPECT_FALSE(policy.are_in_vain({100, 100, 0, 0, 0}));
  EXPECT_FALSE(policy.are_in_vain({100, 100, 0, 0, 10}));
  EXPECT_TRUE(policy.are_in_vain({100, 100, 0, 0, 60}));
  EXPECT_FALSE(
      StoppingPolicy(options_for(1, false, 300), true, false).are_in_vain({100, 100, 0, 0, 60}));
}

TEST(StoppingPolicy, NearTargetsGetFewerStarts) {
  const StoppingPolicy far(options_for(1), true, false);
  const StoppingPolicy near(options_for(1), true, true);
  EXPECT_LT(near.left({}), far.left({}));
  EXPECT_EQ(StoppingPolicy(options_for(1, false, 300), true, true).left({}), 300);
}

TEST(StoppingPolicy, RoundsAreShortWhereTheSearchMayEnd) {
  const StoppingPolicy one(options_for(1), true, false);
  const StoppingPolicy more(options_for(4), true, false);
  EXPECT_EQ(one.round({}), 8);
  EXPECT_EQ(one.round({8, 8, 0, 8}), 4);
  EXPECT_EQ(one.round({16, 16, 0, 16}), 8);
  EXPECT_EQ(more.round({8, 8, 0, 8}), 8);
}

TEST(StoppingPolicy, SharesGoFromNoneToAll) {
  const StoppingPolicy one(options_for(1, false, 20), true, false);
  EXPECT_EQ(one.share({}), 0);
  EXPECT_EQ(one.share({10, 10, 0, 0}), 0.5);
  EXPECT_EQ(one.share({20, 20, 0, 0}), 1);
  const StoppingPolicy more(options_for(4), true, false);
  ASSERT_GT(more.sweeps(), 0);
  EXPECT_EQ(more.share({1000, more.left({}), 0, 0}), 0.5) << "half of it is for the sweeps";
}

TEST(StoppingPolicy, OnlyPathsAreSwept) {
  EXPECT_EQ(StoppingPolicy(options_for(4), false, false).sweeps(), 0);
  EXPECT_EQ(StoppingPolicy(options_for(4, false, 30), true, false).sweeps(), 0);
}

TEST(StoppingPolicy, LacksWhatWasAskedFor) {
  EXPECT_TRUE(StoppingPolicy(options_for(4), true, false).lacks(3));
  EXPECT_FALSE(StoppingPolicy(options_for(4), true, false).lacks(4));
  EXPECT_TRUE(StoppingPolicy(options_for(1, true), true, false).lacks(1000));
}

TEST(StoppingPolicy, MayEndEarlyWhereMostConverge) {
  const StoppingPolicy one(options_for(1), true, false);
  EXPECT_FALSE(one.may_end({8, 8, 0, 8}));
  EXPECT_TRUE(one.may_end({12, 12, 0, 9}));
  EXPECT_FALSE(one.may_end({12, 12, 0, 8}));
  EXPECT_TRUE(one.may_end({16, 16, 0, 0}));
  EXPECT_FALSE(StoppingPolicy(options_for(4), true, false).may_end({12, 12, 0, 12}));
  const StoppingPolicy near(options_for(1), true, true);
  EXPECT_FALSE(near.may_end({23, 23, 0, 23}));
  EXPECT_TRUE(near.may_end({24, 24, 0, 0}));
}

TEST(StoppingPolicy, EndsWhenTheLeastActionIsHitOftenEnough) {
  const StoppingPolicy policy(options_for(1), true, false);
  EXPECT_TRUE(policy.ends({16, 16, 0, 16}, {{3, 0}, 1}));
  EXPECT_FALSE(policy.ends({16, 16, 0, 16}, {{2, 0}, 1}));
  EXPECT_FALSE(policy.ends({16, 16, 0, 15}, {{8, 0}, 2})) << "a rival asks for more";
  EXPECT_FALSE(policy.ends({24, 24, 0, 19}, {{8, 0}, 2})) << "ten of them";
  EXPECT_TRUE(policy.ends({24, 24, 0, 20}, {{8, 0}, 2}));
  // Sooner only without a rival.
  EXPECT_TRUE(policy.ends({12, 12, 0, 12}, {{8, 0}, 1}));
  EXPECT_FALSE(policy.ends({12, 12, 0, 12}, {{7, 0}, 1}));
  EXPECT_FALSE(policy.ends({12, 12, 0, 16}, {{12, 0}, 2}));
}

TEST(StoppingPolicy, PathsTakeMoreStartsThanOthers) {
  StoppingPolicy policy(options_for(1), true, false);
  const int limit = policy.left({});
  policy.plan_for_paths(4, false);
  EXPECT_FALSE(policy.may_end({23, 23, 0, 23}));
  EXPECT_TRUE(policy.may_end({24, 24, 0, 18}));
  EXPECT_FALSE(policy.may_end({24, 24, 0, 17}));
  EXPECT_TRUE(policy.may_end({32, 32, 0, 0}));
  EXPECT_TRUE(policy.ends({24, 24, 0, 24}, {{15, 0}, 1}));
  EXPECT_FALSE(policy.ends({24, 24, 0, 24}, {{15, 0}, 2})) << "a rival";
  EXPECT_TRUE(policy.ends({32, 32, 0, 32}, {{3, 0}, 2}));
  EXPECT_EQ(policy.left({}), limit);
  for (const int starts : {0, 8, 16, 32}) EXPECT_EQ(policy.round({starts, starts}), 8);
  for (const int starts : {24, 28}) EXPECT_EQ(policy.round({starts, starts}), 4);
  StoppingPolicy near(options_for(1), true, true);
  near.plan_for_paths(4, false);
  EXPECT_TRUE(near.may_end({24, 24, 0, 0}));
}

TEST(StoppingPolicy, AnglesTakeMoreStartsAndMoreHits) {
  StoppingPolicy policy(options_for(1), true, false);
  const Competition alone{{64, 0}, 1};
  ASSERT_TRUE(policy.may_end({12, 12, 0, 12}));
  ASSERT_TRUE(policy.ends({12, 12, 0, 12}, {{12, 0}, 1}));
  ASSERT_TRUE(policy.ends({80, 80, 0, 80}, {{20, 0}, 1, 50}));
  policy.plan_for_paths(3, true);
  EXPECT_FALSE(policy.may_end({63, 63, 0, 63}));
  EXPECT_TRUE(policy.may_end({64, 64, 0, 0}));
  EXPECT_TRUE(policy.ends({64, 64, 0, 64}, alone));
  EXPECT_FALSE(policy.ends({300, 300, 0, 300}, {{199, 400}, 1, 50}));
  EXPECT_TRUE(policy.ends({300, 300, 0, 300}, {{200, 0}, 1, 50}));
  EXPECT_TRUE(policy.ends({300, 300, 0, 300}, {{199, 401}, 1, 50}));
  // None ends before 64, so that no round has to be short.
  for (const int starts : {0, 8, 16, 24, 56, 64}) EXPECT_EQ(policy.round({starts, starts}), 8);
}

TEST(StoppingPolicy, ManyCoordinatesTakeMoreStartsAndMoreHits) {
  for (const int coordinates : {4, 5, 6}) {
    StoppingPolicy policy(options_for(1), true, false);
    policy.plan_for_paths(coordinates, false);
    const bool few = coordinates == 4;
    EXPECT_EQ(policy.may_end({47, 47, 0, 47}), few);
    EXPECT_TRUE(policy.may_end({48, 48, 0, 48}));
    EXPECT_EQ(policy.ends({48, 48, 0, 48}, {{20, 0}, 1}), few) << "not clear";
    EXPECT_TRUE(policy.ends({48, 48, 0, 48}, {{30, 0}, 1}));
    EXPECT_TRUE(policy.ends({64, 64, 0, 48}, {{20, 0}, 1}));
    EXPECT_EQ(policy.ends({100, 100, 0, 100}, {{39, 80}, 1, 50}), few);
    EXPECT_TRUE(policy.ends({100, 100, 0, 100}, {{40, 0}, 1, 50}));
    EXPECT_TRUE(policy.ends({100, 100, 0, 100}, {{39, 81}, 1, 50}));
  }
}

// One geodesic is worth twice as many starts there. What was asked for stays so, and near targets
// have a way of their own.
TEST(StoppingPolicy, AnglesAndManyCoordinatesHaveAHigherLimit) {
  for (const int coordinates : {3, 5}) {
    const bool only_angles = coordinates == 3;
    for (const int count : {1, 2}) {
      StoppingPolicy policy(options_for(count), true, false);
      const int before = policy.left({});
      policy.plan_for_paths(coordinates, only_angles);
      EXPECT_EQ(policy.left({}), count == 1 ? 2 * before : before);
    }
    GeodesicOptions given = options_for(1);
    given.starts = 50;
    StoppingPolicy policy(given, true, false);
    policy.plan_for_paths(coordinates, only_angles);
    EXPECT_EQ(policy.left({}), 50);
    StoppingPolicy near(options_for(1), true, true);
    const int before = near.left({});
    near.plan_for_paths(coordinates, only_angles);
    EXPECT_EQ(near.left({}), before);
    EXPECT_TRUE(near.may_end({24, 24, 0, 24}));
  }
}

// Crossings are made of what is known: that they find it again does not say that nothing is missed.
TEST(StoppingPolicy, CrossingsAreNoIndependentStarts) {
  const StoppingPolicy policy(options_for(1), true, false);
  EXPECT_TRUE(policy.ends({100, 80, 0, 60, 0, 20, 20}, {{8, 9}, 4}));
  EXPECT_FALSE(policy.ends({100, 80, 0, 60, 0, 20, 21}, {{8, 9}, 4})) << "39 starts converged";
  EXPECT_FALSE(policy.ends({100, 80, 0, 60, 0, 20, 20}, {{2, 15}, 4}));
}

TEST(StoppingPolicy, CrossingsTakeTurnsWithManyStarts) {
  const StoppingPolicy policy(options_for(1), true, false);
  const auto after = [](int drawn, int crossed) {
    SearchTally tally;
    tally.drawn = drawn;
    tally.crossed = crossed;
    return tally;
  };
  EXPECT_FALSE(policy.turn_of_crossings(after(64, 0)));
  EXPECT_TRUE(policy.turn_of_crossings(after(72, 0)));
  EXPECT_FALSE(policy.turn_of_crossings(after(72, 8)));
  EXPECT_TRUE(policy.turn_of_crossings(after(80, 8)));
  EXPECT_EQ(policy.left(after(72, 8)), 2 * policy.left({}) - 80) << "the limit is higher with them";
  EXPECT_TRUE(StoppingPolicy(options_for(4), true, false).turn_of_crossings(after(72, 0)));
  // Near targets are relaxed elsewhere.
  EXPECT_FALSE(StoppingPolicy(options_for(1), true, true).turn_of_crossings(after(72, 0)));
  EXPECT_EQ(StoppingPolicy(options_for(1, false, 100), true, false).left(after(72, 8)), 20);
}

TEST(StoppingPolicy, GoesOnWhereSomethingWasMissedByChaosEstimate) {
  StoppingPolicy policy(options_for(1), true, false);
  EXPECT_TRUE(policy.ends({24, 24, 0, 24}, {{8, 0}, 1, 0.5}));
  EXPECT_FALSE(policy.ends({24, 24, 0, 24}, {{8, 0}, 1, 1}));
  EXPECT_FALSE(policy.ends({64, 64, 0, 64}, {{19, 40}, 1, 50}));
  EXPECT_TRUE(policy.ends({64, 64, 0, 64}, {{20, 0}, 1, 50})) << "whatever it says";
  EXPECT_TRUE(policy.ends({64, 64, 0, 64}, {{12, 48}, 1, 50})) << "with those by crossings";
  // Starts of drift say too little for an estimate.
  policy.plan_for(8, 40);
  EXPECT_TRUE(policy.ends({24, 24, 0, 24}, {{8, 0}, 1, 1}));
}

}  // namespace
}  // namespace carnot::internal::stopping_policy_test
