// Strictly abnormal curves: known ones, laws along them, and what a search says of them.
#include "carnot/shooting/extremal/abnormal_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "carnot/load_scene.h"
#include "carnot/shooting/continuation.h"
#include "carnot/shooting/extremal/singular_field.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/steering_function.h"
#include "shooting/problems.h"

namespace carnot::internal::abnormal_curve_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-10;

Dynamics scene(const std::string& text) { return make_dynamics(scene_from_text(text)); }

// On y = 0 the metric changes across the line, and nothing can make up for that: the constraint
// acts like a magnetic field that vanishes there.
Dynamics martinet(const std::string& unit = "1") {
  return scene(
      "coordinates x, y, z [length]\n"
      "kinetic = " +
      unit +
      "^2 ((1 + 0.3 y)^2 x'^2 + (1 + 0.2 x)^2 y'^2) / 2\n"
      "0 = y^2 x' / 2 - z'\n");
}
// Liu & Sussmann, Memoirs of the AMS 564 (1995), sec. 2.3: the line x = z = 0 is the shortest path
// between its points that are no further apart than 2/3, and no normal extremal.
Dynamics liu_sussmann() {
  return scene(
      "coordinates x, y, z [length]\n"
      "controls u, w\n"
      "x' = u\n"
      "y' = (1 - x) w\n"
      "z' = x^2 w\n"
      "cost = (u^2 + w^2) / 2\n");
}
// The Engel group with another metric. Along its abnormal line x1 = 0 the covector lets a momentum
// make up for a bend that is the same all along, and for no other.
Dynamics engel(const std::string& bend) {
  return scene(
      "coordinates x1, x2 [length], x3 [length^2], x4 [length^3]\n"
      "kinetic = (x1'^2 + (1 + " +
      bend +
      ")^2 x2'^2) / 2\n"
      "x3' = (x1 x2' - x2 x1') / 2\n"
      "x4' = (x1^2 + x2^2) x2' / 2\n");
}
// The flag of a car with two trailers: all but one of its covectors share one curve.
Dynamics chain() {
  return scene(
      "coordinates a, b, c, d, e [length]\n"
      "kinetic = (a'^2 + (1 + 0.3 a b)^2 b'^2) / 2\n"
      "c' = b a'\n"
      "d' = c a'\n"
      "e' = d a'\n");
}

VectorXd vector_of(const std::vector<double>& x) {
  return Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

// How much of p is beside the span of the columns, relative.
double beside(const MatrixXd& columns, const VectorXd& p) {
  const MatrixXd basis = orthonormal(columns);
  return (p - basis * (basis.transpose() * p)).norm() / p.norm();
}

TEST(SingularField, OfMartinetIsOnItsSurfaceOnly) {
  const Dynamics dynamics = martinet();
  SingularField field(dynamics);
  const VectorXd on = vector_of({0.5, 0, 2});
  EXPECT_EQ(field.covectors(vector_of({0.5, 0.1, 2})).cols(), 0);
  const MatrixXd covectors = field.covectors(on);
  ASSERT_EQ(covectors.cols(), 1);
  EXPECT_NEAR(std::abs(covectors(2, 0)), 1, 1e-15);
  const auto rate = field.rate(on, covectors.col(0));
  ASSERT_TRUE(rate);
  EXPECT_NEAR(std::abs(rate->velocity[0]), 1, 1e-14);
  EXPECT_NEAR(rate->velocity.tail(2).norm(), 0, 1e-14);
  EXPECT_NEAR(rate->force.norm(), 0, 1e-14);
}

// X1 = d/dx1, X2 with p.[X1, X2] = 0: the covector is (x2/2 p3, -x1/2 p3 - .. p4, p3, p4) with
// p3 = -x1 p4, and p.[X2, [X1, X2]] = 0, so the velocity is that of X2 through every point.
TEST(SingularField, OfTheEngelGroupIsOneThroughEveryPoint) {
  const BoundaryValueProblem problem = test::engel({0, 1, 0, 1});
  SingularField field(problem.dynamics);
  for (const std::vector<double>& q :
       {std::vector<double>{0, 0, 0, 0}, {1, -0.5, 0.2, 3}, {-2, 1, 0, 0}}) {
    const MatrixXd covectors = field.covectors(vector_of(q));
    ASSERT_EQ(covectors.cols(), 1);
    const VectorXd p = covectors.col(0);
    EXPECT_NEAR(p[2] + q[0] * p[3], 0, 1e-14);
    const auto rate = field.rate(vector_of(q), p);
    ASSERT_TRUE(rate);
    const VectorXd x2 = vector_of({0, 1, q[0] / 2, (q[0] * q[0] + q[1] * q[1]) / 2});
    EXPECT_NEAR(std::abs(rate->velocity[1]), 1, 1e-14);
    EXPECT_NEAR((rate->velocity[1] * rate->velocity - x2).norm(), 0, 1e-13);
  }
}

// Fields with a vanishing bracket coefficient everywhere, points where they do not, other ranks.
TEST(SingularField, IsNowhereElse) {
  EXPECT_FALSE(may_have_abnormal_curves(test::heisenberg_group({1, 0, 0.2})));  // contact
  EXPECT_FALSE(may_have_abnormal_curves(test::grushin({0, 0}, {1, 1})));        // two dimensions
  EXPECT_FALSE(may_have_abnormal_curves(test::satellite({0.1, 0.2, 0.3})));
  EXPECT_FALSE(may_have_abnormal_curves(test::pendulum(0, 1, 1)));
  BoundaryValueProblem problem(martinet(), {0, 0, 0}, {-1, 0, 0});
  EXPECT_TRUE(may_have_abnormal_curves(problem));
  problem.free_to = {false, true, false};
  EXPECT_FALSE(may_have_abnormal_curves(problem));
  problem.free_to.clear();
  problem.from = {0, 1e-6, 0};
  EXPECT_FALSE(may_have_abnormal_curves(problem));
  const Dynamics heavy = scene(
      "coordinates x, y, z [length]\n"
      "kinetic = (x'^2 + y'^2) / 2\n"
      "potential = x\n"
      "0 = y^2 x' / 2 - z'\n");
  EXPECT_FALSE(may_have_abnormal_curves({heavy, {0, 0, 0}, {-1, 0, 0}}));
}

// Wherever a curve is, its covector annihilates the admissible directions and p.[X1, X2] = 0.
TEST(AbnormalCurve, CarriesItsCovectorWithIt) {
  const std::vector<BoundaryValueProblem> problems{
      {martinet(), {0, 0, 0}, {-1, 0, 0}},
      {liu_sussmann(), {0, 0, 0}, {0, 0.5, 0}},
      {engel("0.3 x1 x2"), {0.2, 0.1, 0, 0}, {0.2, 1, 0.09, 0}},
      test::vehicle({0, 0, 0.3, 0.4}, {0, 0, 0.3, 1.4})};
  for (const BoundaryValueProblem& problem : problems) {
    SingularField field(problem.dynamics);
    VectorXd q = vector_of(problem.from);
    VectorXd p = field.covectors(q).col(0);
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i) {  // Heun's rule, which errs by h^2
      const double h = 1.0 / kSteps;
      const auto a = field.rate(q, p);
      ASSERT_TRUE(a);
      const auto b = field.rate(q + h * a->velocity, p + h * a->force);
      ASSERT_TRUE(b);
      q += 0.5 * h * (a->velocity + b->velocity);
      p += 0.5 * h * (a->force + b->force);
    }
    EXPECT_LT(beside(field.annihilator(q), p), 1e-5) << problem.dynamics.info.name;
    const MatrixXd covectors = field.covectors(q);
    if (covectors.cols() > 0) {
      EXPECT_LT(beside(covectors, p), 1e-5) << problem.dynamics.info.name;
    }
  }
}

TEST(AbnormalCurve, ArrivesWithTheLengthOfTheLine) {
  for (const double x : {-1.0, 1.0, -3.0, 0.25}) {
    const BoundaryValueProblem problem(martinet(), {0, 0, 0}, {x, 0, 0});
    const auto curve = abnormal_curve(problem, kEndless, kTolerance);
    ASSERT_TRUE(curve) << x;
    EXPECT_NEAR(curve->length, std::abs(x), 1e-13 * std::abs(x));
    EXPECT_LE(curve->endpoint_error, 1e-13);
    EXPECT_FALSE(normal_momentum(problem, *curve));
    EXPECT_FALSE(abnormal_curve(problem, 0.99 * std::abs(x), kTolerance));
  }
  for (const std::vector<double>& beside :
       {std::vector<double>{-1, 0, 1e-8}, {-1, 1e-8, 0}, {1, 1, 0}}) {
    EXPECT_FALSE(abnormal_curve({martinet(), {0, 0, 0}, beside}, kEndless, kTolerance));
  }
}

// int_0^1 (1 + 0.3 s / 2) ds on the line x1 = 1/2.
TEST(AbnormalCurve, IsAsLongAsTheMetricSays) {
  const BoundaryValueProblem problem(
      engel("0.3 x1 x2"), {0.5, 0, 0, 0}, {0.5, 1, 0.25, 0.125 + 1.0 / 6});
  const auto curve = abnormal_curve(problem, kEndless, kTolerance);
  ASSERT_TRUE(curve);
  EXPECT_NEAR(curve->length, 1.075, 1e-13);
}

// Steering in place, and the line of the flat Engel group: each is an extremal with a momentum,
// too.
TEST(AbnormalCurve, MayHaveAMomentumAfterAll) {
  const BoundaryValueProblem bent(engel("0.3 x1"), {0, 0, 0, 0}, {0, 1, 0, 1.0 / 6}, 2);
  for (const BoundaryValueProblem& problem :
       {test::engel({0, 1, 0, 1.0 / 6}), test::martinet({-1, 0, 0}), bent}) {
    const auto curve = abnormal_curve(problem, kEndless, kTolerance);
    ASSERT_TRUE(curve);
    const auto p0 = normal_momentum(problem, *curve);
    ASSERT_TRUE(p0);
    std::vector<double> z = problem.from;
    z.insert(z.end(), p0->begin(), p0->end());
    ASSERT_TRUE(problem.dynamics.flow(StepPlan::equal(0, problem.time, 64), z).completed());
    for (std::size_t j = 0; j < problem.to.size(); ++j) EXPECT_NEAR(z[j], problem.to[j], 1e-9);
  }
}

void expect_strict(const GeodesicReport& report, double length) {
  EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_EQ(report.reason, Reason::kNone);
  EXPECT_NE(report.message.find("strictly abnormal"), std::string::npos);
  EXPECT_EQ(report.message.find("--starts"), std::string::npos);
  EXPECT_FALSE(report.missed_estimate);
  ASSERT_EQ(report.geodesics.size(), 1U);
  const Geodesic& line = report.geodesics[0];
  EXPECT_EQ(line.label, Label::kAbnormal);
  EXPECT_EQ(line.abnormal, true);
  EXPECT_NEAR(line.length.value(), length, 1e-12 * length);
  EXPECT_NEAR(line.action, 0.5 * length * length, 1e-12 * length * length);
  EXPECT_LE(line.endpoint_error, 1e-10);
  EXPECT_LE(line.constraint_error, 1e-13);
  EXPECT_FALSE(line.conjugate_times || line.morse_index || line.family_dimension);
  EXPECT_TRUE(std::all_of(line.p0.begin(), line.p0.end(), [](double p) { return std::isnan(p); }));
}

TEST(StrictlyAbnormal, LineOfMartinetForEverySeed) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    GeodesicOptions options;
    options.seed = seed;
    options.samples = 5;
    const GeodesicReport report = find_geodesics({martinet(), {0, 0, 0}, {-1, 0, 0}}, options);
    expect_strict(report, 1);
    const Trajectory& path = report.geodesics[0].trajectory;
    ASSERT_EQ(path.t.size(), 5U);
    for (int i = 0; i < 5; ++i) {
      EXPECT_NEAR(path.q[i][0], -0.25 * i, 1e-13);
      EXPECT_NEAR(path.q[i][1], 0, 1e-13);
      EXPECT_EQ(path.p[i].size(), 3U);
      EXPECT_EQ(path.lambda[i].size(), 1U);
    }
  }
}

TEST(StrictlyAbnormal, OtherScenes) {
  expect_strict(find_geodesics({liu_sussmann(), {0, 0, 0}, {0, 0.5, 0}}), 0.5);
  expect_strict(find_geodesics({engel("0.3 x1 x2"), {0, 0, 0, 0}, {0, 1, 0, 1.0 / 6}}), 1);
  expect_strict(find_geodesics({chain(), {0, 0, 0, 0, 0}, {0, 1, 0, 0, 0}}), 1);
}

// The origin may be anywhere, and units and the time any.
TEST(StrictlyAbnormal, InOtherUnits) {
  GeodesicReport report = find_geodesics({martinet("1000"), {0, 0, 5}, {-1, 0, 5}, 4});
  ASSERT_EQ(report.geodesics.size(), 1U);
  EXPECT_EQ(report.geodesics[0].label, Label::kAbnormal);
  EXPECT_NEAR(report.geodesics[0].length.value(), 1000, 1e-9);
  EXPECT_NEAR(report.geodesics[0].action, 125000, 1e-6);
  EXPECT_EQ(report.geodesics[0].from, (std::vector<double>{0, 0, 5}));
  EXPECT_EQ(report.geodesics[0].trajectory.t.back(), 4);
  EXPECT_NEAR(report.geodesics[0].trajectory.q.back()[2], 5, 1e-12);
}

// On one side of the line there are normal extremals. They keep to y < 0, where the metric is less,
// by sqrt(-2 z) and so their lengths go to that of the line from below, like sqrt(-z).
TEST(StrictlyAbnormal, IsTheLimitOfNormalGeodesics) {
  double last = 1e-2;
  for (const double z : {-1e-4, -1e-5}) {
    const GeodesicReport report = find_geodesics({martinet(), {0, 0, 0}, {-1, 0, z}});
    ASSERT_FALSE(report.geodesics.empty()) << z;
    EXPECT_EQ(report.geodesics[0].label, Label::kLocallyMinimal);
    const double shorter = 1 - report.geodesics[0].length.value();
    EXPECT_GT(shorter, 0);
    EXPECT_LT(shorter, last / 2);
    last = shorter;
  }
}

TEST(StrictlyAbnormal, IsLeftOutWhereAMomentumIsWanted) {
  GeodesicOptions options;
  options.abnormal = false;
  const GeodesicReport report = find_geodesics({martinet(), {0, 0, 0}, {-1, 0, 0}}, options);
  EXPECT_EQ(report.status, GeodesicStatus::kNotConverged);
  EXPECT_EQ(report.reason, Reason::kOnlyAbnormal);
  EXPECT_NE(report.message.find("length 1,"), std::string::npos) << report.message;
  const SteeringFunction steering(martinet());
  const std::vector<double> from{0, 0, 0};
  const std::vector<double> to{-1, 0, 0};
  EXPECT_EQ(steering.steer(from, to).reason(), Reason::kOnlyAbnormal);
}

TEST(StrictlyAbnormal, IsNotLongerThanAsked) {
  GeodesicOptions options;
  options.max_length = 0.9;
  EXPECT_TRUE(find_geodesics({martinet(), {0, 0, 0}, {-1, 0, 0}}, options).geodesics.empty());
}

TEST(StrictlyAbnormal, IsNotContinued) {
  const Dynamics dynamics = martinet();
  const GeodesicReport report = find_geodesics({dynamics, {0, 0, 0}, {-1, 0, 0}});
  ASSERT_EQ(report.geodesics.size(), 1U);
  const ProblemLine line{[&](double s) {
                           return BoundaryValueProblem(dynamics, {0, 0, 0}, {-1 - s, 0, 0});
                         },
                         true};
  const ContinuationReport followed = continue_geodesic(line, report.geodesics[0], {});
  EXPECT_EQ(followed.status, ContinuationStatus::kSingular);
  EXPECT_TRUE(followed.points.empty());
}

// A momentum leads along these lines, so they are what they were.
TEST(StrictlyAbnormal, IsNotWhatIsNormalToo) {
  for (const BoundaryValueProblem& problem :
       {test::martinet({-1, 0, 0}),
        BoundaryValueProblem(engel("0.3 x1"), {0, 0, 0, 0}, {0, 1, 0, 1.0 / 6})}) {
    const GeodesicReport report = find_geodesics(problem);
    ASSERT_EQ(report.geodesics.size(), 1U);
    EXPECT_EQ(report.geodesics[0].label, Label::kLocallyMinimal);
    EXPECT_EQ(report.geodesics[0].abnormal, true);
    EXPECT_NEAR(report.geodesics[0].action, 0.5, 1e-12);
    EXPECT_TRUE(report.message.empty());
  }
}

}  // namespace
}  // namespace carnot::internal::abnormal_curve_test
