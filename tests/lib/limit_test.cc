// Limits: from C++ and from text, their derivatives, what is refused, and flows that keep to them.
#include "carnot/scene/limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/make_limit.h"
#include "carnot/scenes/vehicle.h"

namespace carnot::limit_test {
namespace {

using ::testing::HasSubstr;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kRounded = 1e-13;  // of sums and products of numbers of about one

const std::string kCar =
    "coordinates x, y [length], theta, phi [angle]\n"
    "parameters long = 1 [length] > 0\n"
    "kinetic = (x'^2 + y'^2 + theta'^2 + phi'^2) / 2\n"
    "0 = x' sin(phi) - y' cos(phi)\n"
    "0 = x' sin(theta) - y' cos(theta) + long theta'\n";

std::vector<Limit> limits_of(const std::string& lines) {
  return scene_from_text(kCar + lines).info().limits;
}

// Value, gradient and second derivatives of both are the same.
void expect_equal(const Limit& a, const Limit& b, const std::vector<double>& q) {
  const std::size_t n = q.size();
  std::vector<double> slope_a(n), slope_b(n), bend_a(n * n), bend_b(n * n);
  EXPECT_NEAR(a.value(q.data(), slope_a.data(), bend_a.data()),
              b.value(q.data(), slope_b.data(), bend_b.data()),
              kRounded);
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(slope_a[i], slope_b[i], kRounded) << i;
  for (std::size_t i = 0; i < n * n; ++i) EXPECT_NEAR(bend_a[i], bend_b[i], kRounded) << i;
}

const std::vector<double> kSomewhere{0.3, -0.7, 0.9, 1.4};

TEST(Limit, HasTheDerivativesOfItsFormula) {
  const Limit limit = make_limit<4>(
      "wave", [](const auto& q) { return q[0] * q[0] * q[1] + q[2] * q[3]; }, -1, 2);
  std::vector<double> slope(4), bend(16);
  const auto& q = kSomewhere;
  EXPECT_NEAR(
      limit.value(q.data(), slope.data(), bend.data()), q[0] * q[0] * q[1] + q[2] * q[3], kRounded);
  const std::vector<double> slopes{2 * q[0] * q[1], q[0] * q[0], q[3], q[2]};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(slope[i], slopes[i], kRounded);
  EXPECT_NEAR(bend[0], 2 * q[1], kRounded);
  EXPECT_NEAR(bend[1], 2 * q[0], kRounded);
  EXPECT_NEAR(bend[4], 2 * q[0], kRounded);
  EXPECT_NEAR(bend[11], 1, kRounded);
  EXPECT_EQ(bend[15], 0);
  EXPECT_EQ(limit.value(q.data(), nullptr, nullptr), limit.value(q.data(), slope.data(), nullptr));
  EXPECT_EQ(limit.slack(0.5), 1.5);
  EXPECT_EQ(limit.slack(1.5), 0.5);
  EXPECT_EQ(limit.slack(3), -1);
}

TEST(Limit, FromTextIsThatOfCpp) {
  const auto limits = limits_of(
      "limit -0.6 < phi - theta < 0.5 \"steering\"\n"
      "limit sin(x) y^2 >= -3\n"
      "limit 2 long > x\n"
      "limit x < y + 1\n");
  ASSERT_EQ(limits.size(), 4U);
  EXPECT_EQ(limits[0].name, "steering");
  EXPECT_EQ(limits[0].lower, -0.6);
  EXPECT_EQ(limits[0].upper, 0.5);
  EXPECT_EQ(limits[1].name, "limit 2");
  EXPECT_EQ(limits[1].lower, -3);
  EXPECT_EQ(limits[1].upper, kInf);
  EXPECT_EQ(limits[2].lower, -kInf);
  EXPECT_EQ(limits[2].upper, 2);
  EXPECT_EQ(limits[3].upper, 0);  // x - y - 1 <= 0, by its constant part or not
  EXPECT_NEAR(limits[3].value(kSomewhere.data(), nullptr, nullptr) - limits[3].upper,
              kSomewhere[0] - kSomewhere[1] - 1,
              kRounded);
  expect_equal(limits[0],
               make_limit<4>(
                   "", [](const auto& q) { return q[3] - q[2]; }, 0),
               kSomewhere);
  expect_equal(limits[1],
               make_limit<4>(
                   "",
                   [](const auto& q) {
                     using std::sin;
                     return sin(q[0]) * q[1] * q[1];
                   },
                   0),
               kSomewhere);
}

TEST(Limit, OfADiscInCppIsThatOfTheText) {
  const auto points = limits_of("point front = (x, y)\ndisc (1, 2), 0.5\n");
  ASSERT_EQ(points.size(), 1U);
  const Limit disc = make_disc(
      scenes::Vehicle{},
      "pillar",
      [](const auto& q) {
        return std::array{q[0], q[1]};
      },
      {1, 2},
      0.5);
  expect_equal(points[0], disc, kSomewhere);
  EXPECT_EQ(points[0].lower, disc.lower);
  EXPECT_EQ(points[0].outline, disc.outline);
  EXPECT_TRUE(disc.held);
}

// Near the circle the value grows like the distance from it.
TEST(Limit, OfADiscIsADistanceAtItsBorder) {
  const auto points = limits_of(
      "point nose = (x + cos(theta), y + sin(theta))\npoint tail = (x, y)\ndisc (1, 2), 0.5\n");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].name, "disc 1, nose");
  EXPECT_EQ(points[1].name, "disc 1, tail");
  for (const double beyond : {-1e-5, 0.0, 1e-5}) {
    const double r = 0.5 + beyond;
    const std::vector<double> q{1 + r * std::cos(0.3), 2 + r * std::sin(0.3), 0.9, 0};
    EXPECT_NEAR(points[1].slack(points[1].value(q.data(), nullptr, nullptr)), beyond, 1e-9);
  }
  // What it says of a path is the distance itself, far away and at the centre, too.
  for (const double r : {0.0, 0.2, 0.5, 3.0}) {
    const std::vector<double> q{1 + r, 2, 0, 0};
    EXPECT_NEAR(points[1].slack(points[1].value(q.data(), nullptr, nullptr)), r - 0.5, 1e-15);
  }
  // Without points it is (x, y) that keeps away.
  EXPECT_EQ(limits_of("disc (1, 2), 0.5\n").at(0).name, "disc 1, (x, y)");
}

TEST(Limit, IsRefusedWhereItIsNone) {
  const auto refusal = [](const std::string& line) -> std::string {
    try {
      (void)limits_of(line);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("limit x\n"),
              HasSubstr("text:6:8: the line ends here; accepted: '<' or '>'"));
  EXPECT_THAT(refusal("limit 1 < 2\n"), HasSubstr("depends on no coordinate"));
  EXPECT_THAT(refusal("limit 2 < x < 1\n"), HasSubstr("not below the upper one"));
  EXPECT_THAT(refusal("limit 1 < x > 2\n"), HasSubstr("both bounds are on one side"));
  EXPECT_THAT(refusal("limit y < x < 2\n"), HasSubstr("a bound is a constant"));
  EXPECT_THAT(refusal("limit 1 < x < 2 < 3\n"), HasSubstr("at most two bounds"));
  EXPECT_THAT(refusal("limit x' < 2\n"), HasSubstr("may depend on the coordinates only"));
  EXPECT_THAT(refusal("limit t < 2\n"), HasSubstr("may depend on the coordinates only"));
  EXPECT_THAT(refusal("disc (x, 0), 1\n"), HasSubstr("a disc is (a, b), r"));
  EXPECT_THAT(refusal("disc (1, 0), -1\n"), HasSubstr("a disc is (a, b), r"));
  EXPECT_THAT(refusal("point a = (x, y, 0)\n"), HasSubstr("in the plane"));
  EXPECT_THROW((void)scene_from_text("coordinates a\nkinetic = a'^2/2\ndisc (0, 0), 1\n"),
               std::invalid_argument);
  EXPECT_THROW((void)scene_from_text("coordinates a, b\nhamiltonian = (a^2 + b^2) / 2\n"
                                     "structure = [0, -1; 1, 0]\nlimit a < 1\n"),
               std::invalid_argument);
}

// Held on a limit, flows keep its value, for each way in which velocities may be given.
TEST(Limit, KeepsFlowsThatAreHeld) {
  constexpr double kFlow = 1e-12;
  constexpr double kStart = 0.5;
  const std::string bicycle =
      "coordinates x, y, theta, delta\ncontrols u, w\nx' = u cos(theta)\ny' = u sin(theta)\n"
      "theta' = u tan(delta)\ndelta' = w\ncost = (u^2 + w^2) / 2\nlimit delta + y / 3 < 1\n";
  const std::string drift =
      "coordinates x, v, w\ncontrols a, b\nx' = v\nv' = a\nw' = b + v\ncost = (a^2 + b^2) / 2\n"
      "limit v + x^2 / 2 + w < 4\n";
  for (const std::string& text : {kCar + "limit phi - theta + x y / 4 < 1\n", bicycle, drift}) {
    const Limit limit = scene_from_text(text).info().limits.at(0);
    ASSERT_TRUE(limit.held);
    const Dynamics held = limit.held();
    std::vector<double> z;
    for (int j = 0; j < 2 * held.dof; ++j) z.push_back(kStart * std::cos(j + 1.0));
    const double before = limit.value(z.data(), nullptr, nullptr);
    const std::vector<double> start = z;
    ASSERT_TRUE(held.flow(StepPlan::equal(0, 0.5, 32), z).completed());
    EXPECT_NEAR(limit.value(z.data(), nullptr, nullptr), before, kFlow) << text;
    EXPECT_GT(std::abs(z[0] - start[0]), 1e-3);  // and it moves
  }
}

TEST(Limit, CannotBeHeldWhereNoControlMovesIt) {
  const std::string text =
      "coordinates x, v\ncontrols u\nx' = v\nv' = u\ncost = u^2 / 2\nlimit x < 1\n";
  EXPECT_THROW((void)scene_from_text(text).info().limits.at(0).held(), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::limit_test
