// Legendre's condition: labels of Lagrangians and costs that are not convex.
#include "carnot/shooting/extremal/legendre.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::legendre_test {
namespace {

Dynamics scene(const std::string& text) { return make_dynamics(scene_from_text(text)); }

// The extremal of this momentum.
Geodesic known(const BoundaryValueProblem& problem, const std::vector<double>& p0) {
  GeodesicOptions options;
  options.guess = p0;
  const GeodesicReport report = find_geodesics(problem, options);
  EXPECT_EQ(report.geodesics.size(), 1U) << report.message;
  return report.geodesics.empty() ? Geodesic{} : report.geodesics[0];
}

void expect_no_minimum(const Geodesic& geodesic) {
  EXPECT_EQ(geodesic.label, Label::kNotMinimal);
  EXPECT_FALSE(geodesic.conjugate_times || geodesic.morse_index);
}

// Straight lines, each a saddle; p = (v + v^3/25, -w) of the velocity (v, w). (A Lagrangian without
// the fourth power is a scene with a mass matrix, which has to be positive.)
TEST(Legendre, FailsForAnIndefiniteLagrangian) {
  const Dynamics dynamics =
      scene("coordinates x, y [length]\nlagrangian = x'^2 / 2 + x'^4 / 100 - y'^2 / 2\n");
  expect_no_minimum(known({dynamics, {0, 0}, {1, 0.5}}, {1.04, -0.5}));
}

TEST(Legendre, FailsForAMaximum) {
  const Dynamics dynamics = scene("coordinates x [length]\nlagrangian = -x'^2 / 2 - x'^4 / 100\n");
  expect_no_minimum(known({dynamics, {0}, {1}}, {-1.04}));
}

// The same, where a constraint admits only velocities along which it is definite.
TEST(Legendre, HoldsWhereTheConstraintMakesItSo) {
  const Dynamics dynamics = scene(
      "coordinates x, y, z [length]\n"
      "lagrangian = (x'^2 - y'^2 + z'^2) / 2 + x'^4 / 100\n"
      "0 = y' - x' / 2 - z x' / 10\n");
  const GeodesicReport report = find_geodesics({dynamics, {0, 0, 0}, {1, 0.55, 0.3}});
  ASSERT_FALSE(report.geodesics.empty()) << report.message;
  EXPECT_EQ(report.geodesics[0].label, Label::kLocallyMinimal);
}

// L = v^4/4 - v^2/2, L_vv = 3 v^2 - 1: convex for fast motions only.
TEST(Legendre, DependsOnTheSpeed) {
  const Dynamics dynamics = scene(
      "coordinates x [length]\n"
      "lagrangian = x'^4 / 4 - x'^2 / 2\n"
      "guess x' = 2 p_x + 1\n");
  EXPECT_EQ(known({dynamics, {0}, {2}}, {6}).label, Label::kLocallyMinimal);
  const Dynamics slow = scene(
      "coordinates x [length]\n"
      "lagrangian = x'^4 / 4 - x'^2 / 2\n"
      "guess x' = -p_x\n");
  expect_no_minimum(known({slow, {0}, {0.2}}, {0.2 * 0.2 * 0.2 - 0.2}));
}

TEST(Legendre, FailsForACostThatIsNotConvex) {
  const Dynamics dynamics = scene(
      "coordinates x, y [length]\n"
      "controls u, w\n"
      "x' = y + u\n"
      "y' = w\n"
      "cost = (u^2 - w^2) / 2 + u^4 / 100\n");
  const BoundaryValueProblem problem(dynamics, {0, 0}, {1, 1});
  // p_x is constant and w = -p_y with p_y' = -p_x: 1 = w(0) + p_x/2 and 1 = w(0)/2 + p_x/6 + u.
  // With p_x = u + u^3/25 near u that is u = 0.55.
  constexpr double kForce = 0.55;
  expect_no_minimum(known(problem, {kForce, kForce / 2 - 1}));
}

TEST(Legendre, HoldsWithoutALookForVelocityConstraints) {
  const BoundaryValueProblem problem = test::sideways();
  EXPECT_TRUE(internal::satisfies_legendre(problem, {}, 0));
}

}  // namespace
}  // namespace carnot::legendre_test
