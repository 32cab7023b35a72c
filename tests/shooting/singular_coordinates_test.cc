// Scenes whose coordinates end somewhere: grids may not step over it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/search/starts.h"
#include "catalogue/scene_choice.h"
#include "shooting/problems.h"

namespace carnot::internal::singular_coordinates_test {
namespace {

using ::testing::HasSubstr;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

BoundaryValueProblem sideways() { return test::bicycle({0, 1, 0, 0}); }

TEST(SingularCoordinates, TheSegmentTellsWhereTheyAre) {
  const Dynamics bicycle = sideways().dynamics;
  for (const double delta : {-2.0, -0.5, 0.0, 1.5, 3.0}) {
    const std::vector<double> q{1, 2, 3, delta};
    EXPECT_NEAR(bicycle.chart(q), std::cos(delta), 4 * kEpsilon);
  }
  const std::vector<double> anywhere{1, 2, 3, std::numbers::pi / 2};
  EXPECT_EQ(test::sideways().dynamics.chart(anywhere), 1);
}

// A turn about one axis of the body passes the singularity of the angles and is a geodesic. The
// tangent flow says nothing beyond: by 6.5 it has passed a conjugate time at 2 pi, which it
// does not see (Boscain & Rossi, SIAM J. Control Optim. 47, 2008).
TEST(SingularCoordinates, WhereTheStraightLinePassesAPathMay) {
  for (const double angle : {1.5, 2.0, 6.5}) {
    const GeodesicReport report = find_geodesics(test::satellite({0, angle, 0}));
    ASSERT_FALSE(report.geodesics.empty()) << report.message;
    const Geodesic& turn = report.geodesics[0];
    EXPECT_NEAR(turn.action, angle * angle / 2, 4 * kEpsilon * angle * angle);
    const bool passes = angle > std::numbers::pi / 2;
    EXPECT_EQ(turn.label, passes ? Label::kUnknown : Label::kLocallyMinimal);
    EXPECT_EQ(turn.conjugate_times.has_value(), !passes);
  }
}

// Between ends that the singularity parts grids have extremals that nothing comes of. None of them
// counts, not even where another one on its grid has less action.
TEST(SingularCoordinates, NothingConvergesWhereNothingIsFound) {
  GeodesicOptions options;
  options.starts = 64;
  const GeodesicReport report = find_geodesics(
      test::satellite({0.7047151227967, -2.2398046046984, -2.9893508267848}), options);
  EXPECT_TRUE(report.geodesics.empty());
  EXPECT_EQ(report.reason, Reason::kNotJoined);
  EXPECT_EQ(report.converged_starts, 0);
}

// The bicycle has a path of action 15.1 to here, on the way to shorter ones beyond delta = pi/2.
TEST(SingularCoordinates, AnAnswerSaysWhereTheyStoodInTheWayOfOthers) {
  const GeodesicReport report = find_geodesics(sideways());
  ASSERT_FALSE(report.geodesics.empty()) << report.message;
  EXPECT_THAT(report.message, HasSubstr("ran into a singularity of the coordinates"));
  EXPECT_EQ(report.reason, Reason::kNone);
  EXPECT_EQ(find_geodesics(test::sideways()).message, "");
}

// The least action of a longer bicycle turns in a thirtieth of the time, just before the wheel is
// across: 32 intervals step over the end of the coordinates, and lead to a path of action 26.8 only
// that is no minimum. Its limit along the length of the bicycle, from 1 on, has this action.
TEST(SingularCoordinates, PathsThatTurnBesideThemAreFoundOnFinerGrids) {
  constexpr double kKnown = 20.4865269910;
  const Dynamics bicycle = apps::find_scene("bicycle").make({{"length", 2}}, "gauss16");
  const BoundaryValueProblem problem(bicycle, {0, 0, 0, 0}, {0, 1, 0, 0});
  GeodesicOptions options;
  options.samples = 0;
  const Geodesic least = find_geodesics(problem, options).geodesics.at(0);
  EXPECT_NEAR(least.action, kKnown, 1e-9);
  EXPECT_EQ(least.label, Label::kLocallyMinimal);
}

TEST(SingularCoordinates, EndsThatTheyPartAreToldOnFailure) {
  const GeodesicReport report = find_geodesics(test::satellite({0.3, 2, 0.1}));
  EXPECT_TRUE(report.geodesics.empty());
  EXPECT_THAT(report.message, HasSubstr("ends that a singularity of the coordinates parts"));
}

TEST(SingularCoordinates, PathsStayOnTheirSide) {
  const BoundaryValueProblem problem = sideways();
  int blocked = 0;
  for (int i = 0; i < 40; ++i) {
    Start start = make_start(problem, 0, i);
    EXPECT_TRUE(in_one_chart(problem.dynamics, start.path)) << "start " << i;
    relax(problem, start.relaxation, start.path);
    EXPECT_TRUE(in_one_chart(problem.dynamics, start.path)) << "relaxed " << i;
    blocked += tighten(problem, {}, start.path).left_chart ? 1 : 0;
    EXPECT_TRUE(in_one_chart(problem.dynamics, start.path)) << "tightened " << i;
  }
  EXPECT_GT(blocked, 0);  // the wall is needed
}

TEST(SingularCoordinates, SkimmingIsTold) {
  const Dynamics dynamics = sideways().dynamics;
  const auto skims = [&](const std::vector<double>& angles) {
    Path path;
    path.intervals = static_cast<int>(angles.size()) - 1;
    path.dof = 4;
    for (const double delta : angles) path.q.insert(path.q.end(), {0, 0, 0, delta});
    return skims_chart_end(dynamics, path);
  };
  EXPECT_FALSE(skims({0, 0.5, 1, 0.5, 0}));
  EXPECT_TRUE(skims({0, 1, 1.5, 1, 0}));
  EXPECT_FALSE(skims({0, 1, 1.3, 1.4, 1.5}));  // an end may be near
  EXPECT_FALSE(
      skims_chart_end(test::sideways().dynamics, Path{1, 4, {0, 0, 0, 0, 9, 9, 9, 9}, {}, {}}));
}

// Two of length 5.9131..., mirror images, and not those of length 5.9168...
TEST(SingularCoordinates, TheLeastIsFoundWhateverTheSeed) {
  constexpr double kLeast = 5.9131334052082;
  for (const int seed : {0, 3, 4, 5}) {
    GeodesicOptions options;
    options.seed = seed;
    const GeodesicReport report = find_geodesics(sideways(), options);
    ASSERT_FALSE(report.geodesics.empty()) << "seed " << seed;
    EXPECT_NEAR(report.geodesics[0].length.value_or(0), kLeast, 1e-12) << "seed " << seed;
  }
}

}  // namespace
}  // namespace carnot::internal::singular_coordinates_test
