// A search by itself: its lists, tallies and ends. What it finds is tested in geodesic_test.cc.
#include "carnot/shooting/search/search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "shooting/problems.h"

namespace carnot::internal::search_test {
namespace {

TEST(Search, CountsItsStarts) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 0});
  GeodesicOptions options;
  options.starts = 10;
  Search search(problem, options);
  EXPECT_EQ(search.nearest_discrete(), nullptr);
  EXPECT_TRUE(std::isinf(search.least_residual()));
  ASSERT_TRUE(search.run());
  EXPECT_EQ(search.starts(), 10);
  EXPECT_LE(search.converged(), 10);
  EXPECT_EQ(search.blocked(), 0);
  EXPECT_NE(search.nearest_discrete(), nullptr);
  const std::vector<int> hits = search.hits();
  EXPECT_EQ(std::accumulate(hits.begin(), hits.end(), 0), search.converged());
}

// Mirror partners are of equal action: half-way round the wheel to either side.
TEST(Search, PartnersCountWhereMoreIsWanted) {
  const BoundaryValueProblem problem = test::sideways();
  GeodesicOptions options;
  options.starts = 8;
  Search one(problem, options);
  options.count = 4;
  const GeodesicOptions more_options = options;
  Search more(problem, more_options);
  ASSERT_TRUE(one.run());
  ASSERT_TRUE(more.run());
  EXPECT_GT(more.extremals().size(), one.extremals().size());
}

TEST(Search, LongExtremalsAreKeptApart) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 0});
  GeodesicOptions options;
  options.starts = 4;
  options.max_length = 0.1;
  Search search(problem, options);
  ASSERT_TRUE(search.run());
  EXPECT_TRUE(search.extremals().empty());
  EXPECT_FALSE(search.extremals(true).empty());
}

TEST(Search, CanBeInterrupted) {
  const BoundaryValueProblem problem = test::sideways();
  GeodesicOptions options;
  options.progress = [](double share) { return share == 0; };
  Search search(problem, options);
  EXPECT_FALSE(search.run());
  EXPECT_EQ(search.starts(), 8) << "the round that had begun";
}

TEST(Search, AGuessIsOneStart) {
  const BoundaryValueProblem problem = test::sideways();
  GeodesicOptions options;
  options.guess = {-5.363131400277701, 16.18437737239682, -9.311614737376091, -4.080757918683527};
  Search good(problem, options);
  good.polish_guess();
  EXPECT_EQ(good.starts(), 1);
  EXPECT_EQ(good.converged(), 1);
  EXPECT_EQ(good.extremals().size(), 1U);
  options.guess = {300, -200, 100, 500};
  Search astray(problem, options);
  astray.polish_guess();
  EXPECT_EQ(astray.converged(), 0);
  EXPECT_TRUE(astray.extremals().empty());
  EXPECT_GE(astray.furthest(), Reason::kNotJoined);
}

}  // namespace
}  // namespace carnot::internal::search_test
