// Discrete extremals on finer grids: order of the extrapolation, artefacts.
#include "carnot/shooting/path/refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "carnot/shooting/path/discrete_newton.h"
#include "shooting/problems.h"
#include "shooting/tight_path.h"

namespace carnot::internal::refinement_test {
namespace {

TEST(Refinement, HalvingKeepsCubics) {
  Path path;
  path.intervals = 8;
  path.dof = 1;
  const auto cubic = [](double s) { return 1 + s * (2 - s * (3 - 4 * s)); };
  for (int i = 0; i <= 8; ++i) path.q.push_back(cubic(i / 8.0));
  for (int i = 0; i < 8; ++i) path.lambda.push_back(1 + 2 * (i + 0.5) / 8);
  const Path fine = halved(path);
  ASSERT_EQ(fine.intervals, 16);
  constexpr double kRoundOff = 1e-14;
  for (int i = 0; i <= 16; ++i) EXPECT_NEAR(fine.q[i], cubic(i / 16.0), kRoundOff);
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(fine.lambda[i], 1 + 2 * (i + 0.5) / 16, kRoundOff);
}

// A car whose body and steering are light turns in layers that a grid of 128 intervals hardly
// resolves. From there Newton's method alone does not lead to an extremal on 256, and relaxing
// would be dear.
TEST(Refinement, GoesOnStepByStepWhereNewtonDoesNot) {
  const BoundaryValueProblem problem = test::light_car({1.07889, 2.94436, 0.06954, 0.24125});
  const Path path = test::tight_path(problem, 112, 64);
  RefinementOptions options;
  options.enough = 0;  // to the end
  options.max_intervals = 256;
  const Refinement refined = refine(MassLadder(problem), options, path);
  ASSERT_TRUE(refined.found);
  ASSERT_EQ(refined.intervals, 256);
  ASSERT_EQ(refined.finer.size(), 2u);
  Path alone = halved(refined.finer.front());
  DiscreteNewtonOptions newton;
  newton.max_iterations = 40;
  EXPECT_FALSE(tighten(problem, newton, alone).converged);
  Path last = refined.finer.back();
  const Path found = last;
  ASSERT_TRUE(tighten(problem, {}, last).converged);
  constexpr double kTightened = 1e-6;  // it was an extremal, and Newton's method stays
  for (std::size_t i = 0; i < last.q.size(); ++i) EXPECT_NEAR(last.q[i], found.q[i], kTightened);
}

// The last iteration counts as the others do.
TEST(DiscreteNewton, SaysSoWhereItConvergesWithTheLastIteration) {
  const BoundaryValueProblem problem = test::sideways();
  const Path start = halved(test::tight_path(problem));
  Path whole = start;
  const DiscreteNewton all = tighten(problem, {}, whole);
  ASSERT_TRUE(all.converged);
  ASSERT_GT(all.iterations, 1);
  for (int most = 1; most <= all.iterations; ++most) {
    DiscreteNewtonOptions options;
    options.max_iterations = most;
    Path path = start;
    const DiscreteNewton some = tighten(problem, options, path);
    EXPECT_EQ(some.iterations, most);
    EXPECT_EQ(some.converged, most == all.iterations);
  }
}

TEST(Refinement, ChangesFallByFour) {
  const BoundaryValueProblem problem = test::sideways();
  const Path coarse = test::tight_path(problem);
  double last = 0;
  for (const int intervals : {128, 256, 512}) {
    RefinementOptions options;
    options.enough = 0;
    options.max_intervals = intervals;
    const Refinement refined = refine(MassLadder(problem), options, coarse);
    ASSERT_TRUE(refined.found);
    EXPECT_EQ(refined.intervals, intervals);
    EXPECT_EQ(refined.path.intervals, intervals / 2);
    if (last > 0) {
      EXPECT_NEAR(last / refined.change, 4, 0.2);  // 4 + O(h^2)
    }
    last = refined.change;
  }
}

// What the doubling of the grid changes of extrapolated nodes and momenta falls by sixteen.
TEST(Refinement, ExtrapolatedPathsConvergeWithTheFourthOrder) {
  constexpr double kSecondOrder = 4;
  const BoundaryValueProblem problem = test::sideways();
  const Path coarse = test::tight_path(problem);
  std::vector<Path> paths;
  for (const int intervals : {128, 256, 512}) {
    RefinementOptions options;
    options.enough = 0;
    options.max_intervals = intervals;
    paths.push_back(refine(MassLadder(problem), options, coarse).path);
    ASSERT_EQ(paths.back().intervals, intervals / 2);
  }
  const auto change = [&](std::vector<double> Path::*numbers, int finer) {
    double largest = 0;
    for (int i = 0; i <= paths[0].intervals; ++i) {
      for (int j = 0; j < coarse.dof; ++j) {
        const auto at = [&](int k) { return ((i << k) * coarse.dof) + j; };
        const double before = (paths[finer - 1].*numbers)[at(finer - 1)];
        largest = std::max(largest, std::abs((paths[finer].*numbers)[at(finer)] - before));
      }
    }
    return largest;
  };
  for (const auto numbers : {&Path::q, &Path::p}) {
    EXPECT_GT(change(numbers, 1) / change(numbers, 2), 2 * kSecondOrder);
  }
}

// p(0) of the extrapolated path is that of the extremal, to the fourth order.
TEST(Refinement, ExtrapolationIsOfFourthOrder) {
  const BoundaryValueProblem problem = test::straight_ahead();
  RefinementOptions options;
  options.enough = 1e-2;
  const Refinement refined = refine(MassLadder(problem), options, test::tight_path(problem));
  ASSERT_TRUE(refined.settled);
  EXPECT_NEAR(refined.path.momentum(0)[0], 1, 1e-9);
}

}  // namespace
}  // namespace carnot::internal::refinement_test
