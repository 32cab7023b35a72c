#include "carnot/shooting/extremal/conjugate_times.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shooting/problems.h"
#include "testing/reference.h"

namespace carnot::internal::conjugate_times_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 1e-12;  // the bisection stops at 1e-13 of t

ConjugateTimes times_of(const BoundaryValueProblem& problem,
                        const std::vector<double>& p0,
                        int segments) {
  constexpr long kSteps = 32;
  return conjugate_times(problem, knots_of(problem, p0, segments, kSteps), kSteps);
}

// Arcs of circles: conjugate after each full turn and, in between, where tan(w t/2) = w t/2.
TEST(ConjugateTimes, HeisenbergGroupInClosedForm) {
  const double w = 15;
  const BoundaryValueProblem problem = test::heisenberg_group({1, 0, 1});
  const double tangent_root = 4.493409457909064;  // tan x = x
  for (const int segments : {1, 4}) {
    const ConjugateTimes result = times_of(problem, {1, 0.5, w}, segments);
    ASSERT_TRUE(result.known);
    ASSERT_EQ(result.times.size(), 3U);
    EXPECT_NEAR(result.times[0], 2 * kPi / w, kTolerance);
    EXPECT_NEAR(result.times[1], 2 * tangent_root / w, kTolerance);
    EXPECT_NEAR(result.times[2], 4 * kPi / w, kTolerance);
  }
}

// The same for many turns, some with a conjugate time just where the planes are balanced: none is
// lost, and none is unknown.
TEST(ConjugateTimes, NoneIsLostWhateverTheWinding) {
  const BoundaryValueProblem problem = test::heisenberg_group({1, 0, 1});
  for (double w = 6.4; w < 80; w *= 1.013) {
    std::vector<double> expected;
    for (int k = 1; 2 * kPi * k / w <= 1; ++k) {
      expected.push_back(2 * kPi * k / w);
      double root = (k + 0.5) * kPi;  // of tan x = x
      for (int i = 0; i < 20; ++i) root = k * kPi + std::atan(root);
      if (2 * root / w <= 1) expected.push_back(2 * root / w);
    }
    const std::vector<double> p0{1.3, -0.4, w};
    const long steps = 48;
    const ConjugateTimes result = conjugate_times(problem, knots_of(problem, p0, 1, steps), steps);
    ASSERT_TRUE(result.known) << w;
    ASSERT_EQ(result.times.size(), expected.size()) << w;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(result.times[i], expected[i], kTolerance) << w;
    }
  }
}

TEST(ConjugateTimes, NoneOnAShortArc) {
  const ConjugateTimes result = times_of(test::heisenberg_group({1, 0, 1}), {1, 0.5, 5}, 1);
  EXPECT_TRUE(result.known);
  EXPECT_TRUE(result.times.empty());
}

// From y = 0 with speed 1, p_x = 1 - 2 k^2 and p_z = lambda, the first one at sqrt(lambda) t of the
// reference, which has 20 digits.
TEST(ConjugateTimes, MartinetOfTheReference) {
  constexpr double kBeyond = 1.2;  // the end is that much later
  const test::Json data = test::own_reference("martinet.json");
  ASSERT_FALSE(data.is_null());
  for (const auto& row : data["conjugate"]) {
    const double k = std::stod(row["k"].get<std::string>());
    const double scaled = std::stod(row["conj_sqrt_lambda_t"].get<std::string>());
    const double root = kBeyond * scaled;
    const double p_x = 1 - 2 * k * k;
    const ConjugateTimes result =
        times_of(test::martinet({0, 0, 1}), {p_x, std::sqrt(1 - p_x * p_x), root * root}, 1);
    ASSERT_TRUE(result.known) << k;
    ASSERT_GE(result.times.size(), 1U) << k;
    EXPECT_NEAR(result.times[0], scaled / root, kTolerance) << k;
  }
}

// Even multiplicity, which the sign of det dq/dp0 does not see.
TEST(ConjugateTimes, CountsMultiplicity) {
  const ConjugateTimes result = times_of(test::oscillator({0, 0}, {1, 0}, 4), {1, 0.3}, 1);
  ASSERT_TRUE(result.known);
  ASSERT_EQ(result.times.size(), 2U);
  EXPECT_NEAR(result.times[0], kPi, 10 * kTolerance);
  EXPECT_NEAR(result.times[1], kPi, 10 * kTolerance);
}

// Checked with the determinant of the tangent flow, which changes its sign at 0.970521975.
TEST(ConjugateTimes, MirrorPartnerOfSidewaysParking) {
  const ConjugateTimes result = times_of(
      test::sideways(), {-6.64993536442, 16.06197576467, -3.05437477859, -1.25855757328}, 1);
  ASSERT_TRUE(result.known);
  ASSERT_EQ(result.times.size(), 1U);
  EXPECT_NEAR(result.times[0], 0.970521975, 1e-8);  // p0 has eleven digits
}

// Full circles: T itself is conjugate, and nothing before.
TEST(ConjugateTimes, CountsTheEnd) {
  const double w = 2 * kPi;
  const ConjugateTimes result = times_of(test::heisenberg_group({0, 0, 1}), {1, 0.5, w}, 1);
  ASSERT_TRUE(result.known);
  ASSERT_EQ(result.times.size(), 1U);
  EXPECT_EQ(result.times[0], 1);
  EXPECT_EQ(result.at_end, 1);
}

// Steering in place is abnormal: dq/dp0 is singular at all times. Steering costs the same as going
// straight on in the angle, so the other directions are never conjugate.
TEST(ConjugateTimes, LeaveTheCorankOfAnAbnormalExtremalOut) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {0, 0, 0, kPi / 2});
  const ConjugateTimes result = times_of(problem, {0, 0, 0, kPi / 2}, 1);
  EXPECT_TRUE(result.known);
  EXPECT_EQ(result.corank, 1);
  EXPECT_TRUE(result.times.empty());
}

// The directions that a short path hardly moves in look like those that an abnormal one does not,
// but for the units: steering in place is abnormal however little it is, and straight ahead is not.
TEST(ConjugateTimes, ShortPathsTellTheirKernels) {
  for (const double size : {1e-1, 1e-3, 1e-5}) {
    const BoundaryValueProblem steer = test::vehicle({0, 0, 0, 0}, {0, 0, 0, size});
    const ConjugateTimes in_place = times_of(steer, {0, 0, 0, size}, 1);
    EXPECT_TRUE(in_place.known) << size;
    EXPECT_EQ(in_place.corank, 1) << size;
    EXPECT_TRUE(in_place.times.empty()) << size;
    const BoundaryValueProblem roll = test::vehicle({0, 0, 0, 0}, {size, 0, 0, 0});
    const ConjugateTimes ahead = times_of(roll, {size, 0, 0, 0}, 1);
    EXPECT_TRUE(ahead.known) << size;
    EXPECT_EQ(ahead.corank, 0) << size;
    EXPECT_TRUE(ahead.times.empty()) << size;
  }
}

// Dilations of the Engel group change nothing but the scale.
TEST(ConjugateTimes, DilationsKeepThem) {
  const std::vector<double> p{0.3, 0.8, 9, 11};
  const ConjugateTimes whole = times_of(test::engel({0, 0, 0, 0}), p, 1);
  ASSERT_TRUE(whole.known);
  ASSERT_FALSE(whole.times.empty());
  constexpr double kMagnified = 1e-9;
  for (const double d : {1e-2, 1e-3, 1e-4}) {
    const std::vector<double> small{d * p[0], d * p[1], p[2], p[3] / d};
    const ConjugateTimes times = times_of(test::engel({0, 0, 0, 0}), small, 1);
    ASSERT_TRUE(times.known) << d;
    ASSERT_EQ(times.times.size(), whole.times.size()) << d;
    for (std::size_t i = 0; i < times.times.size(); ++i) {
      EXPECT_NEAR(times.times[i], whole.times[i], kMagnified) << d;
    }
  }
}

// Growth of the tangent flow (here 1e9) makes dq(T)/dp0 look singular; its plane does not.
TEST(ConjugateTimes, StraightAheadHasNone) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {20, 0, 0, 0});
  const ConjugateTimes result = times_of(problem, {20, 0, 0, 0}, 1);
  EXPECT_TRUE(result.known);
  EXPECT_EQ(result.corank, 0);
  EXPECT_TRUE(result.times.empty());
}

}  // namespace
}  // namespace carnot::internal::conjugate_times_test
