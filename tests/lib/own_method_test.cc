#include "carnot/tableau/own_method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/laws/laws.h"
#include "carnot/load_scene.h"
#include "carnot/make_dynamics.h"
#include "carnot/make_inlined_dynamics.h"
#include "carnot/make_rattle_dynamics.h"
#include "carnot/scenes/satellite_quaternion.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/tableau/make_tableau.h"
#include "carnot/tableau/order_conditions.h"
#include "carnot/tableau/tableau_laws.h"
#include "testing/distance.h"

namespace carnot::own_method_test {
namespace {

using scenes::Vehicle;
using test::largest_change;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::vector<double>> rows_of(const Tableau<double>& tableau, Part part) {
  const auto a = coefficients_of(tableau, part);
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < tableau.stages(); ++i) {
    std::vector<double> row;
    for (int j = 0; j < tableau.stages(); ++j) row.push_back(static_cast<double>(a(i, j)));
    rows.push_back(row);
  }
  return rows;
}

// What a book prints of a method of the library.
ButcherTableau printed(const Tableau<double>& tableau) {
  ButcherTableau butcher;
  butcher.a = rows_of(tableau, Part::kPosition);
  if (tableau.partitioned) butcher.a_p = rows_of(tableau, Part::kMomentum);
  butcher.b.assign(tableau.b.data(), tableau.b.data() + tableau.stages());
  return butcher;
}

ButcherTableau lobatto_3c() {
  return {.name = "lobattoIIIC4",
          .a = {{1. / 6, -1. / 3, 1. / 6}, {1. / 6, 5. / 12, -1. / 12}, {1. / 6, 2. / 3, 1. / 6}},
          .b = {1. / 6, 2. / 3, 1. / 6}};
}

ButcherTableau kutta() {
  return {.name = "rk4",
          .a = {{0, 0, 0, 0}, {0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 1, 0}},
          .b = {1. / 6, 1. / 3, 1. / 3, 1. / 6}};
}

// The triple jump: three midpoint steps, the middle one backwards. With the stages in the order
// `at` of time.
ButcherTableau triple_jump(const std::vector<std::size_t>& at) {
  const double outer = 1 / (2 - std::cbrt(2.0));
  const std::vector<double> gamma{outer, 1 - 2 * outer, outer};
  ButcherTableau butcher;
  butcher.name = "triple jump";
  for (const std::size_t i : at) {
    butcher.b.push_back(gamma[i]);
    std::vector<double> row;
    for (const std::size_t j : at) row.push_back(j < i ? gamma[j] : j == i ? gamma[i] / 2 : 0);
    butcher.a.push_back(row);
  }
  return butcher;
}

const std::vector<double> kStart{0, 0, 0.3, 0.2, 0.7, 0.7, 0.5, 0.2};

std::vector<double> end_of(const Dynamics& dynamics, double duration, long steps) {
  std::vector<double> z = kStart;
  EXPECT_TRUE(dynamics.flow(StepPlan::equal(0, duration, steps), z).completed());
  return z;
}

class PrintedMethodTest : public ::testing::TestWithParam<Method> {
 protected:
  const Method& method_ = GetParam();
  const Tableau<double> tableau_ = make_tableau(method_);
  const OwnMethod own_ = own_method(printed(tableau_));
};

INSTANTIATE_TEST_SUITE_P(AllMethods,
                         PrintedMethodTest,
                         ::testing::ValuesIn(methods()),
                         [](const auto& method) { return method.param.name; });

// The order of a pair is looked for up to 8, of the others as far as it goes.
TEST_P(PrintedMethodTest, IsRecognized) {
  EXPECT_EQ(own_.method.order, method_.order);
  EXPECT_EQ(own_.method.stages, method_.stages);
  EXPECT_EQ(own_.method.symplectic, method_.symplectic);
  EXPECT_EQ(own_.method.symmetric, method_.symmetric);
  EXPECT_EQ(own_.tableau.partitioned, tableau_.partitioned);
  // One stage depends on itself alone.
  const bool single = method_.stages == 1;
  EXPECT_EQ(own_.tableau.coupling, single ? Coupling::kDiagonal : tableau_.coupling);
}

// To the last bit, though the printed coefficients are rounded.
TEST_P(PrintedMethodTest, IsSymplecticExactly) {
  EXPECT_EQ(is_symplectic(own_.tableau), method_.symplectic);
}

TEST_P(PrintedMethodTest, StepsAsTheMethodDoes) {
  if (method_.family == kRattleFamily) return;
  constexpr double kTolerance = 1e3 * kEps;  // twenty steps, with stages solved to round-off
  const std::vector<double> own = end_of(make_dynamics(Vehicle{}, own_), 2, 20);
  const std::vector<double> known = end_of(make_dynamics(Vehicle{}, method_.name), 2, 20);
  EXPECT_LE(largest_change(own, known), kTolerance);
}

TEST(OwnMethod, OfThePackStepsSideBySide) {
  const OwnMethod own = own_method(printed(make_tableau(*find_method("gauss16"))));
  const Dynamics dynamics = make_dynamics(Vehicle{}, own);
  EXPECT_TRUE(dynamics.kernel.fills_packs);
  EXPECT_TRUE(dynamics.has_automatic_flow());
  std::vector<double> z = kStart;
  std::vector<double> known = kStart;
  const AutomaticFlow result = dynamics.automatic_flow(0, 2, 1e-10, z);
  EXPECT_TRUE(result.report.completed());
  (void)make_dynamics(Vehicle{}).automatic_flow(0, 2, 1e-10, known);
  EXPECT_LE(largest_change(z, known), 1e-12);
}

// The law itself, of methods that the library does not have.
TEST(OwnMethod, HasTheOrderThatIsMeasured) {
  ButcherTableau crouzeix;  // diagonally implicit, of order 3
  crouzeix.name = "crouzeix";
  const double g = (3 + std::sqrt(3.0)) / 6;
  crouzeix.a = {{g, 0}, {1 - 2 * g, g}};
  crouzeix.b = {0.5, 0.5};
  struct Case {
    ButcherTableau butcher;
    int order;
    Coupling coupling;
  };
  for (const Case& c : {Case{lobatto_3c(), 4, Coupling::kFull},
                        Case{kutta(), 4, Coupling::kExplicit},
                        Case{crouzeix, 3, Coupling::kDiagonal},
                        Case{triple_jump({0, 1, 2}), 4, Coupling::kDiagonal},
                        Case{triple_jump({2, 1, 0}), 4, Coupling::kFull}}) {
    SCOPED_TRACE(c.butcher.name);
    const OwnMethod own = own_method(c.butcher);
    EXPECT_EQ(own.method.order, c.order);
    EXPECT_EQ(own.tableau.coupling, c.coupling);
    const ReferenceRun reference = reference_run(make_dynamics(Vehicle{}), {0, kStart}, 2, 1 << 12);
    const Dynamics dynamics = make_dynamics(Vehicle{}, own);
    EXPECT_EQ(dynamics.method, c.butcher.name);
    EXPECT_EQ(dynamics.order, c.order);
    EXPECT_NEAR(measure_order(dynamics, reference).fit.slope, c.order, 0.1);
    const double defect = measure_symplecticity(dynamics, {0, kStart}, 0.1, 20);
    if (own.method.symplectic) {
      EXPECT_LE(defect, 1e3 * kEps);
    } else {
      EXPECT_GT(defect, 1e-9);
    }
  }
}

// A negative weight has no root, by which the decoupled equations of the stages are scaled. Steps
// that long make Newton's method necessary.
TEST(OwnMethod, MayHaveNegativeWeights) {
  const OwnMethod in_time = own_method(triple_jump({0, 1, 2}));
  const OwnMethod backwards = own_method(triple_jump({2, 1, 0}));
  EXPECT_TRUE(backwards.method.symplectic);
  EXPECT_TRUE(backwards.method.symmetric);
  for (const long steps : {5, 20}) {
    const std::vector<double> expected = end_of(make_dynamics(Vehicle{}, in_time), 4, steps);
    const std::vector<double> found = end_of(make_dynamics(Vehicle{}, backwards), 4, steps);
    EXPECT_LE(largest_change(found, expected), 1e4 * kEps) << steps;
  }
  std::vector<double> z = kStart;
  const Dynamics dynamics = make_dynamics(Vehicle{}, backwards);
  EXPECT_GT(dynamics.flow(StepPlan::equal(0, 4, 5), z).newton_steps, 0);
}

// gauss4 with a stage that moves nothing, at the node of another one.
TEST(OwnMethod, MayHaveStagesWithoutWeight) {
  ButcherTableau padded = printed(make_tableau(*find_method("gauss4")));
  padded.a[0].push_back(0);
  padded.a[1].push_back(0);
  padded.a.push_back(padded.a[1]);
  padded.b.push_back(0);
  const OwnMethod own = own_method(padded);
  EXPECT_EQ(own.method.order, 4);
  EXPECT_FALSE(is_symplectic(own.tableau));
  const std::vector<double> found = end_of(make_dynamics(Vehicle{}, own), 2, 20);
  const std::vector<double> expected = end_of(make_dynamics(Vehicle{}, "gauss4"), 2, 20);
  EXPECT_LE(largest_change(found, expected), 1e3 * kEps);
}

// The symplectic Euler rule: q is implicit and p explicit.
TEST(OwnMethod, MayBePartitioned) {
  const OwnMethod euler =
      own_method({.name = "symplectic Euler", .a = {{1}}, .b = {1}, .a_p = {{0}}});
  EXPECT_EQ(euler.method.order, 1);
  EXPECT_TRUE(euler.method.symplectic);
  EXPECT_FALSE(euler.method.symmetric);
  EXPECT_TRUE(is_symplectic(euler.tableau));
  const Dynamics dynamics = make_dynamics(Vehicle{}, euler);
  EXPECT_LE(measure_symplecticity(dynamics, {0, kStart}, 0.1, 20), 1e3 * kEps);
  const ReferenceRun reference = reference_run(make_dynamics(Vehicle{}), {0, kStart}, 1, 1 << 12);
  EXPECT_NEAR(measure_order(dynamics, reference).fit.slope, 1, 0.1);
}

TEST(OwnMethod, IsTakenByEveryMaker) {
  const OwnMethod own = own_method(lobatto_3c());
  const std::vector<double> expected = end_of(make_dynamics(Vehicle{}, own), 2, 20);
  EXPECT_LE(largest_change(end_of(make_inlined_dynamics(Vehicle{}, own), 2, 20), expected),
            1e3 * kEps);

  const TextScene skate = scene_from_text(
      "coordinates x, y, theta [angle]\n0 = x' sin(theta) - y' cos(theta)\n"
      "kinetic = (x'^2 + y'^2 + theta'^2) / 2\n");
  EXPECT_EQ(make_dynamics(skate, own).order, 4);

  // Only symplectic methods keep the unit quaternions.
  const OwnMethod symplectic = own_method(triple_jump({0, 1, 2}));
  EXPECT_EQ(make_rattle_dynamics(scenes::SatelliteQuaternion{}, symplectic).method, "triple jump");
  EXPECT_THROW((void)make_rattle_dynamics(scenes::SatelliteQuaternion{}, own),
               std::invalid_argument);
}

std::string refusal(const ButcherTableau& butcher) {
  try {
    (void)own_method(butcher);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(OwnMethod, RefusesWhatIsNoMethod) {
  EXPECT_EQ(refusal({.a = {{0}}, .b = {}}), "method own: b is empty");
  EXPECT_EQ(refusal({.name = "", .a = {{0}}, .b = {1}}), "method : its name is empty");
  EXPECT_EQ(refusal({.a = {{0}}, .b = {0.9}}),
            "method own: b must sum to 1: the steps go to another time otherwise");
  EXPECT_EQ(refusal({.a = {{0}}, .b = {0.5, 0.5}}),
            "method own: a must have 2 rows of 2, as b has entries");
  EXPECT_EQ(refusal({.a = {{0}, {0}}, .b = {0.5, 0.5}}), "method own: a must have 2 rows of 2");
  EXPECT_EQ(refusal({.a = {{kNaN}}, .b = {1}}), "method own: a has an entry that is not finite");
  EXPECT_EQ(refusal({.a = {{0}}, .b = {kNaN}}), "method own: b has an entry that is not finite");
  EXPECT_EQ(refusal({.a = {{0}}, .b = {1}, .a_p = {{0, 0}}}),
            "method own: a_p must have 1 rows of 1");
  const std::vector<double> b(13, 1. / 13);
  EXPECT_EQ(refusal({.a = std::vector(13, b), .b = b}),
            "method own: more than 12 stages that depend on each other");
}

}  // namespace
}  // namespace carnot::own_method_test
