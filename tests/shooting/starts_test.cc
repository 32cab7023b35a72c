#include "carnot/shooting/search/starts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shooting/problems.h"

namespace carnot::internal::starts_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

TEST(Starts, AreTheSameForTheSameSeedAndIndex) {
  const BoundaryValueProblem problem = test::sideways();
  for (const int i : {0, 3, 10}) {
    EXPECT_EQ(make_start(problem, 5, i).path.q, make_start(problem, 5, i).path.q);
  }
  EXPECT_NE(make_start(problem, 5, 1).path.q, make_start(problem, 6, 1).path.q);
  EXPECT_NE(make_start(problem, 5, 2).path.q, make_start(problem, 5, 1).path.q);
}

TEST(Starts, JoinTheEnds) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  for (int i = 0; i < 12; ++i) {
    const Path path = make_start(problem, 0, i).path;
    for (int j = 0; j < 4; ++j) {
      EXPECT_EQ(path.configuration(0)[j], problem.from[j]);
      EXPECT_EQ(path.configuration(path.intervals)[j], problem.to[j]);
    }
  }
}

TEST(Starts, DoNotDependOnTheOrigin) {
  const double far = 1 << 20;  // exact in floating point
  const BoundaryValueProblem here = test::vehicle({0, 0, 0, 0}, {0, 1, 0, 0});
  const BoundaryValueProblem there = test::vehicle({far, -far, 0, 0}, {far, 1 - far, 0, 0});
  for (int i = 0; i < 8; ++i) {
    const Start a = make_start(here, 0, i);
    const Start b = make_start(there, 0, i);
    EXPECT_DOUBLE_EQ(a.relaxation.penalty, b.relaxation.penalty);
    for (int node = 0; node <= a.path.intervals; ++node) {
      const double moved = b.path.configuration(node)[0] - far;
      EXPECT_NEAR(a.path.configuration(node)[0], moved, 4 * kEpsilon * far);
    }
  }
}

TEST(Starts, BeginWithTheStraightLine) {
  const Path path = make_start(test::vehicle({0, 0, 0, 0}, {2, 1, 0, 0}), 0, 0).path;
  for (int i = 0; i <= path.intervals; ++i) {
    EXPECT_EQ(path.configuration(i)[0], 2.0 * i / path.intervals);
    EXPECT_EQ(path.configuration(i)[2], 0);
  }
}

TEST(Starts, GrowWithTheTarget) {
  const auto extent = [](double y) {
    const Path path = make_start(test::vehicle({0, 0, 0, 0}, {0, y, 0, 0}), 0, 6).path;
    double largest = 0;
    for (int i = 0; i <= path.intervals; ++i) {
      largest = std::max(largest, std::abs(path.configuration(i)[0]));
    }
    return largest;
  };
  // e = 1/3 for start 6: a thousandth of the displacement, a tenth of the wiggle.
  EXPECT_NEAR(extent(1e-3) / extent(1), 0.1, 1e-3);
}

// How far from the straight line a start goes in one coordinate.
double wiggle(const BoundaryValueProblem& problem, int start, int coordinate) {
  const Path path = make_start(problem, 0, start).path;
  const double from = problem.from[coordinate];
  const double to = problem.to[coordinate];
  double largest = 0;
  for (int i = 0; i <= path.intervals; ++i) {
    const double line = from + i * (to - from) / path.intervals;
    largest = std::max(largest, std::abs(path.configuration(i)[coordinate] - line));
  }
  return largest;
}

// The wiggle of start 2 grows with the distance, and that of the second cat is nearly twice as
// long. Both wiggles of cats are between 1 rad and a full turn.
TEST(Starts, TurnFarWhereEveryCoordinateIsAnAngle) {
  const double cat = wiggle(test::falling_cat({0.8, 0.8, 0.8}), 2, 1);
  EXPECT_NEAR(wiggle(test::falling_cat({1.6, 1.6, 1.6}), 2, 1) / cat, 2, 0.01);
  const double vehicle = wiggle(test::vehicle({0, 0, 0, 0}, {40, 30, 0, 0}), 2, 2);
  EXPECT_NEAR(wiggle(test::vehicle({0, 0, 0, 0}, {80, 60, 0, 0}), 2, 2), vehicle, 100 * kEpsilon);
}

}  // namespace
}  // namespace carnot::internal::starts_test
