// The flag of the admissible directions and its dilations.
#include "carnot/shooting/problem/dilation.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <utility>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/make_dynamics.h"
#include "shooting/problems.h"

namespace carnot::internal::dilation_test {
namespace {

using Eigen::VectorXd;

std::vector<int> weights(const BoundaryValueProblem& problem) {
  const auto dilation = Dilation::at_start(problem);
  return dilation ? dilation->weights() : std::vector<int>{};
}

BoundaryValueProblem from(BoundaryValueProblem problem, std::vector<double> start) {
  problem.from = std::move(start);
  return problem;
}

TEST(Dilation, WeightsAreTheGrowthOfTheFlag) {
  EXPECT_EQ(weights(test::heisenberg_group({0, 0, 1})), (std::vector<int>{1, 1, 2}));
  EXPECT_EQ(weights(test::engel({0, 0, 0, 1})), (std::vector<int>{1, 1, 2, 3}));
  EXPECT_EQ(weights(test::sideways()), (std::vector<int>{1, 1, 2, 3}));
  EXPECT_EQ(weights(test::stiff_vehicle({0, 1, 0, 0})), (std::vector<int>{1, 1, 2, 3}));
  EXPECT_EQ(weights(test::bicycle({0, 1, 0, 0})), (std::vector<int>{1, 1, 2, 3}));
  EXPECT_EQ(weights(test::satellite({1, 0, 0})), (std::vector<int>{1, 1, 2}));
}

// Where brackets vanish longer ones are taken; where the frame loses rank, brackets of what is
// lost.
TEST(Dilation, WeightsGrowWhereBracketsVanish) {
  EXPECT_EQ(weights(test::martinet({0, 0, 1})), (std::vector<int>{1, 1, 3}));
  EXPECT_EQ(weights(from(test::martinet({0, 0, 1}), {0.5, 0.5, 0})), (std::vector<int>{1, 1, 2}));
  EXPECT_EQ(weights(test::grushin({0.5, 0}, {0, 1})), (std::vector<int>{1, 1}));
  EXPECT_EQ(weights(test::grushin({0, 0}, {0, 1})).size(), 2U);
}

// Where the straight line is admissible its coordinates have weight 1 only; sideways is a bracket
// of three.
TEST(Dilation, CoordinatesAreAdaptedToTheFlag) {
  const double course = 0.7;
  const auto dilation = Dilation::at_start(from(test::sideways(), {3, -2, course, course}));
  ASSERT_TRUE(dilation);
  constexpr double kDifferences = 1e-3;  // the brackets are differences
  const VectorXd ahead = dilation->coordinates(
      std::vector<double>{3 + std::cos(course), -2 + std::sin(course), course, course}.data());
  const VectorXd aside = dilation->coordinates(
      std::vector<double>{3 - std::sin(course), -2 + std::cos(course), course, course}.data());
  EXPECT_NEAR(ahead.head(2).norm(), 1, kDifferences);
  EXPECT_NEAR(ahead.tail(2).norm(), 0, kDifferences);
  EXPECT_NEAR(aside.head(2).norm(), 0, kDifferences);
  EXPECT_GT(std::abs(aside[3]), 0.1);
}

TEST(Dilation, ScalesTheGaugeAndComesBack) {
  const auto dilation = Dilation::at_start(from(test::sideways(), {3, -2, 0.7, 0.2}));
  ASSERT_TRUE(dilation);
  constexpr double kRoundOff = 1e-14;
  const std::vector<double> q{3.1, -2.3, 0.8, 0.1};
  const VectorXd y = dilation->coordinates(q.data());
  std::vector<double> back(4);
  dilation->place(y, back.data());
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(back[j], q[j], kRoundOff);
  for (const double factor : {1e-3, 0.5, 7.0}) {
    const VectorXd scaled = dilation->scaled(y, factor);
    EXPECT_NEAR(dilation->gauge(scaled) / (factor * dilation->gauge(y)), 1, kRoundOff);
  }
}

TEST(Dilation, NothingWhereTheFrameIsSingular) {
  const BoundaryValueProblem problem = from(test::bicycle({0, 1, 0, 0}), {0, 0, 0, NAN});
  EXPECT_FALSE(Dilation::at_start(problem));
  EXPECT_EQ(bracket_span(problem).dimension, 4) << "nothing is said";
}

TEST(BracketSpan, IsEverythingWhereTheFlagIsComplete) {
  for (const BoundaryValueProblem& problem :
       {test::sideways(), test::martinet({0, 0, 1}), test::engel({0, 0, 0, 1})}) {
    const BracketSpan span = bracket_span(problem);
    EXPECT_EQ(span.dimension, problem.dynamics.dof);
    EXPECT_FALSE(span.annihilator);
  }
}

// The distance of (x, y) from the origin is kept, and z is free.
TEST(BracketSpan, FindsWhatIsKept) {
  constexpr double kDifferences = 1e-3;
  const Dynamics circles = make_dynamics(scene_from_text(R"(
    coordinates x, y, z
    kinetic = (x'^2 + y'^2 + z'^2) / 2
    0 = x x' + y y'
  )"));
  const BracketSpan span = bracket_span({circles, {0.6, 0.8, 3}, {0.8, 0.6, 2}});
  EXPECT_EQ(span.dimension, 2);
  ASSERT_TRUE(span.annihilator);
  const double sign = (*span.annihilator)[0] > 0 ? 1 : -1;
  EXPECT_NEAR(sign * (*span.annihilator)[0], 0.6, kDifferences);
  EXPECT_NEAR(sign * (*span.annihilator)[1], 0.8, kDifferences);
  EXPECT_NEAR((*span.annihilator)[2], 0, kDifferences);
}

}  // namespace
}  // namespace carnot::internal::dilation_test
