#include "carnot/shooting/search/crossing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace carnot::internal::crossing_test {
namespace {

constexpr std::uint64_t kSeed = 3;

// From (0, 0) to (1, 2), and aside by `size` in the second coordinate.
Path bow(double size, int intervals) {
  Path path;
  path.intervals = intervals;
  path.dof = 2;
  for (int i = 0; i <= intervals; ++i) {
    const double s = static_cast<double>(i) / intervals;
    path.q.push_back(s);
    path.q.push_back(2 * s + (i < intervals ? size * std::sin(std::numbers::pi * s) : 0));
  }
  return path;
}

// How far a crossing is from its first parent to its second one at node i, if it is of these two.
double share(const Path& crossed, int i) {
  return (crossed.configuration(i)[1] - 2 * crossed.configuration(i)[0]) /
         std::sin(std::numbers::pi * i / crossed.intervals);
}

TEST(Crossing, JoinsTheEndsOfItsParents) {
  const Path up = bow(1, 16);
  const Path down = bow(-1, 32);
  for (int i = 0; i < 20; ++i) {
    const Path crossed = crossing({&up, &down}, kSeed, i, 24);
    ASSERT_EQ(crossed.intervals, 24);
    ASSERT_EQ(crossed.q.size(), 25U * 2);
    EXPECT_THAT(std::vector<double>(crossed.q.begin(), crossed.q.begin() + 2),
                testing::ElementsAre(0, 0));
    EXPECT_THAT(std::vector<double>(crossed.q.end() - 2, crossed.q.end()),
                testing::ElementsAre(1, 2));
    EXPECT_TRUE(crossed.lambda.empty());
  }
}

TEST(Crossing, BeginsAsOneParentAndEndsAsTheOther) {
  constexpr double kNearly = 0.05;  // it passes over within a twentieth of the time
  const Path flat = bow(0, 32);
  const Path high = bow(1, 32);
  int first_flat = 0;
  for (int i = 0; i < 20; ++i) {
    const Path crossed = crossing({&flat, &high}, kSeed, i, 32);
    const double begins = share(crossed, 1);
    const double ends = share(crossed, 31);
    EXPECT_NEAR(std::min(begins, ends), 0, kNearly);
    EXPECT_NEAR(std::max(begins, ends), 1, kNearly);
    first_flat += begins < ends ? 1 : 0;
  }
  EXPECT_GT(first_flat, 0);
  EXPECT_LT(first_flat, 20);
}

TEST(Crossing, IsOfTwoDifferentParentsTheLeastMoreOften) {
  std::vector<Path> bows;
  for (int size = 0; size < 10; ++size) bows.push_back(bow(size, 16));
  std::vector<const Path*> parents;
  for (const Path& each : bows) parents.push_back(&each);
  int of_first = 0;
  int of_last = 0;
  for (int i = 0; i < 300; ++i) {
    const Path crossed = crossing(parents, kSeed, i, 32);
    const long begins = std::lround(share(crossed, 1));
    const long ends = std::lround(share(crossed, 31));
    EXPECT_NE(begins, ends);
    of_first += begins == 0 || ends == 0 ? 1 : 0;
    of_last += begins == 9 || ends == 9 ? 1 : 0;
  }
  EXPECT_GT(of_first, 2 * of_last);
  EXPECT_GT(of_last, 0);
}

TEST(Crossing, IsTheSameForTheSameNumber) {
  const Path up = bow(1, 16);
  const Path down = bow(-1, 16);
  EXPECT_EQ(crossing({&up, &down}, kSeed, 5, 16).q, crossing({&up, &down}, kSeed, 5, 16).q);
  EXPECT_NE(crossing({&up, &down}, kSeed, 5, 16).q, crossing({&up, &down}, kSeed, 6, 16).q);
  EXPECT_NE(crossing({&up, &down}, kSeed, 5, 16).q, crossing({&up, &down}, kSeed + 1, 5, 16).q);
}

}  // namespace
}  // namespace carnot::internal::crossing_test
