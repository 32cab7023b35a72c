// Lines of momenta on a circle, beside umbilics at known places.
#include "carnot/shooting/front/cusp_ends.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace carnot::internal::cusp_ends_test {
namespace {

UnitMomentum at(double angle, double height = 0) {
  return {{std::cos(angle), std::sin(angle), 0}, {height, 0}};
}

CuspLine line(const std::vector<double>& angles) {
  CuspLine line;
  for (const double angle : angles) line.points.push_back({at(angle), angle});
  return line;
}

Umbilic umbilic(double angle, bool hyperbolic = true) { return {at(angle), angle, hyperbolic, 0}; }

std::vector<double> angles_of(const CuspLine& line) {
  std::vector<double> angles;
  for (const CausticPoint& point : line.points) angles.push_back(point.t);
  return angles;
}

TEST(CuspEnds, ReachUmbilicsThatTheyStopShortOf) {
  std::vector<CuspLine> lines{line({0.2, 0.3, 0.4, 0.5})};
  lead_to_umbilics({umbilic(0.7), umbilic(0), umbilic(2)}, lines);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(angles_of(lines[0]), (std::vector<double>{0, 0.2, 0.3, 0.4, 0.5, 0.7}));
  EXPECT_EQ(lines[0].first_umbilic, 1);
  EXPECT_EQ(lines[0].last_umbilic, 0);
}

TEST(CuspEnds, StayWhereNoUmbilicIsNear) {
  CuspLine closed = line({0.1, 0.2, 0.3});
  closed.closed = true;
  std::vector<CuspLine> lines{closed, line({1, 1.1, 1.2})};
  lead_to_umbilics({umbilic(0), umbilic(2)}, lines);
  EXPECT_EQ(lines[0].points.size(), 3U);
  EXPECT_EQ(lines[1].points.size(), 3U);
  for (const CuspLine& one : lines) {
    EXPECT_EQ(one.first_umbilic, -1);
    EXPECT_EQ(one.last_umbilic, -1);
  }
}

// Whichever way round, and in whichever order they were found.
TEST(CuspEnds, PiecesBesideAHyperbolicUmbilicBecomeAPart) {
  const CuspLine main = line({0, 0.1, 0.2, 0.3, 0.4, 0.5});
  const CuspLine backwards = line({0.5, 0.4, 0.3, 0.2, 0.1, 0});
  const CuspLine piece = line({0.56, 0.6});
  const CuspLine turned = line({0.6, 0.56});
  for (const std::vector<CuspLine>& found :
       {std::vector{main, piece}, {turned, main}, {backwards, piece}, {turned, backwards}}) {
    std::vector<CuspLine> lines = found;
    lead_to_umbilics({umbilic(0.65)}, lines);
    ASSERT_EQ(lines.size(), 1U);
    std::vector<double> expected{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.56, 0.6, 0.65};
    if (lines[0].first_umbilic == 0) {
      std::reverse(expected.begin(), expected.end());
    } else {
      EXPECT_EQ(lines[0].last_umbilic, 0);
    }
    EXPECT_EQ(angles_of(lines[0]), expected);
  }
}

TEST(CuspEnds, ThreeLinesEndAtAnEllipticUmbilic) {
  std::vector<CuspLine> lines{
      line({0.1, 0.2, 0.3}), line({-0.3, -0.2, -0.1}), line({0.15, 0.3}), line({0.29, 0.39})};
  lead_to_umbilics({umbilic(0, false)}, lines);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0].first_umbilic, 0);
  EXPECT_EQ(lines[1].last_umbilic, 0);
  EXPECT_EQ(lines[2].first_umbilic, 0);
  EXPECT_EQ(lines[3].first_umbilic, -1);  // as near, but the fourth
  EXPECT_EQ(angles_of(lines[0]), (std::vector<double>{0, 0.1, 0.2, 0.3}));
  EXPECT_EQ(angles_of(lines[1]), (std::vector<double>{-0.3, -0.2, -0.1, 0}));
}

TEST(CuspEnds, DistancesAreOfDirectionsAndOfHeights) {
  EXPECT_NEAR(distance_of(at(0), at(0.01)), 0.01, 1e-6);
  EXPECT_EQ(distance_of(at(1, 0), at(1, 0.5)), 0.5);
  EXPECT_EQ(distance_of(at(1, 9), at(1, 10)), 0.1);  // far out on the line, less is the same
}

}  // namespace
}  // namespace carnot::internal::cusp_ends_test
