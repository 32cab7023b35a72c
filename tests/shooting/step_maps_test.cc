#include "carnot/shooting/extremal/step_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "catalogue/scene_choice.h"
#include "shooting/problems.h"
#include "testing/distance.h"

namespace carnot::internal::step_maps_test {
namespace {

using test::largest_change;

// Of some hundred steps, which enlarge rounding errors by ten or so.
constexpr double kRoundOff = 4000 * std::numeric_limits<double>::epsilon();

const std::vector<double> kMomentum{1, 0.7, 0.5, 0.2};

// An extremal of the vehicle in one segment, or in several.
struct Extremal {
  explicit Extremal(int segments = 1, std::vector<double> p0 = kMomentum)
      : problem(test::vehicle({0, 0, 0.3, 0.8}, {2, 1, 0.5, 0.5}, 2)),
        units(problem, p0),
        knots(knots_of(problem, p0, segments, 64)) {}

  BoundaryValueProblem problem;
  Units units;
  Knots knots;
};

// More steps than are kept at a time, read in order, from the beginning again and from far away.
TEST(StepMaps, AreThoseOfSingleSteps) {
  constexpr long kSteps = 600;
  const Extremal extremal;
  StepMaps maps(extremal.problem, extremal.units, extremal.knots, kSteps);
  ASSERT_EQ(maps.count(), kSteps);
  std::vector<StepMap> read(kSteps);
  for (long i = 0; i < kSteps; ++i) ASSERT_TRUE(maps.read(i, read[i])) << i;
  const double h = extremal.problem.time / kSteps;
  StepMap single{{extremal.knots.at(0), extremal.knots.at(0) + 8}, {}};
  for (long i = 0; i < kSteps; ++i) {
    const double t = i == 0 ? 0 : maps.end(i - 1);
    ASSERT_TRUE(take_step(extremal.problem.dynamics, extremal.units, t, h, single));
    EXPECT_LE(largest_change(read[i].map, single.map), kRoundOff) << i;
    if (i + 1 < kSteps) {
      EXPECT_LE(largest_change(read[i].z, single.z), kRoundOff) << i;
    }
  }
  for (const long i : {0L, 599L, 300L, 1L}) {
    StepMap again;
    ASSERT_TRUE(maps.read(i, again));
    EXPECT_EQ(again.z, read[i].z) << i;
    EXPECT_EQ(largest_change(again.map, read[i].map), 0) << i;
  }
}

// A segment begins at its knot, wherever the one before ends.
TEST(StepMaps, BeginAtKnots) {
  constexpr int kSegments = 4;
  constexpr long kSteps = 8;  // of each
  Extremal extremal(kSegments);
  for (int i = 1; i <= kSegments; ++i) extremal.knots.at(i)[1] += 0.01 * i;
  StepMaps maps(extremal.problem, extremal.units, extremal.knots, kSteps);
  StepMap step;
  for (int i = 0; i < kSegments; ++i) {
    const double t = i * extremal.problem.time / kSegments;
    StepMap first{{extremal.knots.at(i), extremal.knots.at(i) + 8}, {}};
    ASSERT_TRUE(take_step(extremal.problem.dynamics,
                          extremal.units,
                          t,
                          extremal.problem.time / (kSegments * kSteps),
                          first));
    ASSERT_TRUE(maps.read(i * kSteps, step));
    EXPECT_LE(largest_change(step.z, first.z), kRoundOff);
    EXPECT_LE(largest_change(step.map, first.map), kRoundOff);
    ASSERT_TRUE(maps.read((i + 1) * kSteps - 1, step));
    const double* knot = extremal.knots.at(i + 1);
    EXPECT_EQ(step.z, std::vector<double>(knot, knot + 8));
    EXPECT_DOUBLE_EQ(maps.end((i + 1) * kSteps - 1), (i + 1) * extremal.problem.time / kSegments);
  }
}

TEST(StepMaps, AreJoined) {
  const Extremal extremal(2);
  StepMaps maps(extremal.problem, extremal.units, extremal.knots, 8);
  const JoinedSteps joined(maps, 2);
  ASSERT_EQ(joined.count(), 8);
  for (long i = 0; i < joined.count(); ++i) {
    StepMap both;
    StepMap first;
    StepMap second;
    ASSERT_TRUE(joined.read(i, both));
    ASSERT_TRUE(maps.read(2 * i, first));
    ASSERT_TRUE(maps.read(2 * i + 1, second));
    EXPECT_EQ(both.z, second.z);
    EXPECT_EQ(joined.end(i), maps.end(2 * i + 1));
    const Eigen::MatrixXd expected = second.map.lazyProduct(first.map);
    EXPECT_LE(largest_change(both.map, expected), kRoundOff);
  }
}

// What fails stays so, and what comes after it fails, too.
TEST(StepMaps, SaysWhichStepFails) {
  const Extremal extremal(1, {1, std::nan(""), 0.5, 0.2});
  StepMaps maps(extremal.problem, extremal.units, extremal.knots, 300);
  StepMap step;
  for (const long i : {0L, 1L, 299L}) EXPECT_FALSE(maps.read(i, step)) << i;
  EXPECT_FALSE(JoinedSteps(maps, 2).read(3, step));
}

// The momenta along the normal of the unit quaternions move nothing, and are led to those at the
// end of the step.
TEST(StepMaps, LeadNormalsToNormals) {
  const BoundaryValueProblem problem{
      apps::find_scene("satellite-quaternion").make({}, "rattle6"), {1, 0, 0, 0}, {0, 1, 0, 0}};
  const std::vector<double> p0{0, 1, 0.5, 0.7};
  const Units units(problem, p0);
  const Knots knots = knots_of(problem, p0, 1, 32);
  constexpr int n = 4;
  StepMaps maps(problem, units, knots, 32);
  std::vector<double> before(knots.at(0), knots.at(0) + n);
  StepMap step;
  for (long i = 0; i < maps.count(); ++i) {
    ASSERT_TRUE(maps.read(i, step));
    for (int r = 0; r < n; ++r) {
      double moved = 0;
      double normal = 0;
      for (int j = 0; j < n; ++j) {
        moved += step.map(r, n + j) * before[j];
        normal += step.map(n + r, n + j) * before[j];
      }
      EXPECT_NEAR(moved, 0, kRoundOff);
      EXPECT_NEAR(std::abs(normal), std::abs(step.z[r]), kRoundOff);
    }
    before.assign(step.z.begin(), step.z.begin() + n);
  }
}

}  // namespace
}  // namespace carnot::internal::step_maps_test
