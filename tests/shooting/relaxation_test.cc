// Relaxation and Newton's method on the midpoint transcription: the result is the midpoint rule.
#include "carnot/shooting/path/relaxation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/search/starts.h"
#include "shooting/problems.h"

namespace carnot::internal::relaxation_test {
namespace {

// First start of the sequence that Newton's method tightens.
Path tightened(const BoundaryValueProblem& problem) {
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    Start start = make_start(problem, 0, i);
    relax(problem, start.relaxation, start.path);
    if (tighten(problem, {}, start.path).converged) return start.path;
  }
  ADD_FAILURE() << "no start of " << kTries << " could be tightened";
  return {};
}

TEST(Relaxation, BringsAPathOntoTheConstraints) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  Start start = make_start(problem, 0, 0);
  RelaxationOptions options = start.relaxation;
  options.outer_iterations = 30;
  const Relaxation result = relax(problem, options, start.path);
  EXPECT_TRUE(result.feasible);
  EXPECT_LT(result.violation, options.feasibility);
  EXPECT_GT(result.iterations, 0);
}

TEST(Relaxation, KeepsTheEnds) {
  const BoundaryValueProblem problem = test::sideways();
  Start start = make_start(problem, 3, 2);
  relax(problem, start.relaxation, start.path);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(start.path.configuration(0)[j], problem.from[j]);
    EXPECT_EQ(start.path.configuration(start.path.intervals)[j], problem.to[j]);
  }
}

// The law that the whole shooting layer rests on: nodes and momenta of a discrete extremal are
// those of the midpoint rule started at (q0, p0).
TEST(DiscreteNewton, SatisfiesTheMidpointRule) {
  BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  const Path path = tightened(problem);
  const Dynamics midpoint = test::vehicle_midpoint();
  std::vector<double> z(path.configuration(0), path.configuration(0) + 4);
  z.insert(z.end(), path.momentum(0), path.momentum(0) + 4);
  // Newton stopped at 1e-9 of the momenta; the flow magnifies that by |dz(1)/dz(0)|, about 1e2.
  constexpr double kTolerance = 1e-7;
  for (int i = 0; i < path.intervals; ++i) {
    const double h = problem.time / path.intervals;
    ASSERT_TRUE(midpoint.flow(StepPlan::equal(i * h, h, 1), z).completed());
    for (int j = 0; j < 4; ++j) {
      EXPECT_NEAR(z[j], path.configuration(i + 1)[j], kTolerance) << "q, node " << i + 1;
      EXPECT_NEAR(z[4 + j], path.momentum(i + 1)[j], kTolerance) << "p, node " << i + 1;
    }
  }
}

TEST(DiscreteNewton, IsExactAtOnceOnTheStraightLine) {
  const BoundaryValueProblem problem = test::straight_ahead();
  const Path path = tightened(problem);
  for (int i = 0; i <= path.intervals; ++i) {
    EXPECT_NEAR(path.momentum(i)[0], 1, 1e-9);  // p_x = 1, Newton's tolerance
    EXPECT_NEAR(path.configuration(i)[1], 0, 1e-9);
  }
}

TEST(DiscreteNewton, HandlesAPotential) {
  const BoundaryValueProblem problem = test::oscillator({1, 0}, {0, 1}, 1);
  const Path path = tightened(problem);
  // q'' = -q with these ends, second order on 32 intervals: errors of about h^2 = 1e-3.
  const double expected = (0 - std::cos(1.0)) / std::sin(1.0);
  EXPECT_NEAR(path.momentum(0)[0], expected, 1e-3);
  EXPECT_NEAR(path.momentum(0)[1], 1 / std::sin(1.0), 1e-3);
}

TEST(DiscreteNewton, ReportsFailureWithoutNaN) {
  const BoundaryValueProblem problem = test::sideways();
  Start start = make_start(problem, 0, 1);
  start.path.lambda.assign(start.path.intervals * 2, 0.0);
  DiscreteNewtonOptions options;
  options.max_iterations = 1;
  const DiscreteNewton result = tighten(problem, options, start.path);
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(std::isfinite(result.residual));
  for (const double x : start.path.q) EXPECT_TRUE(std::isfinite(x));
}

}  // namespace
}  // namespace carnot::internal::relaxation_test
