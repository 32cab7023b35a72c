// The metric of the equations of a discrete extremal: in closed form, and by every way to it.
#include "carnot/shooting/path/discrete_equations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "carnot/shooting/search/starts.h"
#include "shooting/problems.h"

namespace carnot::internal::discrete_equations_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Sums of some ten products of numbers of like size, in another order.
constexpr double kTolerance = 1e3 * kEps;

// Intervals fill the lanes, leave some empty, or are fewer than them.
constexpr int kCounts[] = {3, 8, 13, 32};

BoundaryValueProblem problem_with_free_ends() {
  BoundaryValueProblem problem = test::sideways();
  problem.free_from = {false, true, false, false};
  problem.free_to = {false, false, true, true};
  return problem;
}

Path wiggle(const BoundaryValueProblem& problem, int intervals) {
  Path path = make_start(problem, 0, 1, intervals).path;
  path.lambda.assign(static_cast<std::size_t>(intervals) * problem.dynamics.transcribed, 0.5);
  return path;
}

std::vector<double> random_vector(int size) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> x(size);
  for (double& number : x) number = normal(random);
  return x;
}

int band_of(const BoundaryValueProblem& problem) {
  return 2 * problem.dynamics.dof + problem.dynamics.transcribed - 1;
}

double largest_difference(BandedLu& a, BandedLu& b, int size, int band) {
  double largest = 0;
  for (int i = 0; i < size; ++i) {
    for (int j = std::max(0, i - band); j <= std::min(size - 1, i + band); ++j) {
      largest = std::max(largest, std::abs(a(i, j) - b(i, j)));
    }
  }
  return largest;
}

// Without constraints and with a mass of one x'B x = sum |x_{i+1} - x_i|^2 / h.
TEST(DiscreteEquations, HaveTheMetricOfTheKineticEnergy) {
  BoundaryValueProblem problem = test::oscillator({1, 0}, {0, 1}, 1);
  problem.free_from = {false, true};
  problem.free_to = {true, false};
  const int n = problem.dynamics.dof;
  for (const int intervals : kCounts) {
    DiscreteEquations equations(problem, intervals);
    const std::vector<double> x = random_vector(equations.size());
    std::vector<double> product;
    equations.metric_product(wiggle(problem, intervals), x, product);
    double form = 0;
    for (int i = 0; i < equations.size(); ++i) form += x[i] * product[i];
    const auto at = [&](int node, int j) {
      const int unknown = equations.of_node(node, j);
      return unknown < 0 ? 0 : x[unknown];
    };
    double expected = 0;
    for (int i = 0; i < intervals; ++i) {
      for (int j = 0; j < n; ++j) {
        const double change = at(i + 1, j) - at(i, j);
        expected += change * change * intervals / problem.time;
      }
    }
    EXPECT_NEAR(form, expected, kTolerance * expected) << intervals;
  }
}

TEST(DiscreteEquations, AddTheMetricThatTheyMultiplyBy) {
  constexpr double kShare = 0.3;
  for (const BoundaryValueProblem& problem :
       {problem_with_free_ends(), test::falling_cat({0.3, 0.2, 0.1})}) {
    for (const int intervals : kCounts) {
      const Path path = wiggle(problem, intervals);
      DiscreteEquations equations(problem, intervals);
      const int size = equations.size();
      const int band = band_of(problem);
      BandedLu metric = equations.matrix();
      equations.add_metric(path, kShare, metric);
      const std::vector<double> x = random_vector(size);
      std::vector<double> product;
      equations.metric_product(path, x, product);
      for (int i = 0; i < size; ++i) {
        double sum = 0;
        double scale = 0;
        for (int j = std::max(0, i - band); j <= std::min(size - 1, i + band); ++j) {
          sum += metric(i, j) * x[j];
          scale += std::abs(metric(i, j) * x[j]);
          EXPECT_EQ(metric(i, j), metric(j, i));
        }
        EXPECT_NEAR(sum, kShare * product[i], kTolerance * scale) << intervals;
      }
    }
  }
}

TEST(DiscreteEquations, WeighHessianAndMetric) {
  constexpr double kWeight = 0.7;
  constexpr int kIntervals = 13;
  const BoundaryValueProblem problem = problem_with_free_ends();
  const Path path = wiggle(problem, kIntervals);
  DiscreteEquations equations(problem, kIntervals);
  std::vector<double> residual;
  BandedLu plain = equations.matrix();
  BandedLu weighed = equations.matrix();
  equations.evaluate(path, residual, &plain);
  equations.evaluate(path, residual, &weighed, {1, kWeight});
  equations.add_metric(path, kWeight, plain);
  const double scale = std::abs(plain(0, 0));
  EXPECT_LE(largest_difference(weighed, plain, equations.size(), band_of(problem)),
            kTolerance * scale);
}

}  // namespace
}  // namespace carnot::internal::discrete_equations_test
