// How far angles turn along a path.
#include "carnot/shooting/problem/turn_rates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/problem/windings.h"
#include "shooting/problems.h"

namespace carnot::internal::turn_rates_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(TurnRates, OfAUnicycleAreKnown) {
  // The rate is found with a margin of one per cent.
  const std::vector<double> rates = turn_rates(test::unicycle({1, 2, 3}, {0, 0, 0}));
  EXPECT_EQ(rates[0], kInfinity);
  EXPECT_EQ(rates[1], kInfinity);
  EXPECT_NEAR(rates[2], 1.01, 1e-12);
  EXPECT_EQ(least_length(test::unicycle({0, 0, 0}, {9, 9, 2.02}), rates), 2.02 / rates[2]);
}

// Along random extremals no angle turns faster.
TEST(TurnRates, AreKeptToByExtremals) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const BoundaryValueProblem& problem : {test::sideways(),
                                              test::stiff_vehicle({1, 1, 0, 0}),
                                              test::unicycle({0, 0, 0}, {1, 1, 1})}) {
    const std::vector<double> rates = turn_rates(problem);
    const int n = problem.dynamics.dof;
    double closest = 0;
    for (int i = 0; i < 200; ++i) {
      BoundaryValueProblem to_end = problem;
      std::vector<double> z(2 * n), velocity(n), lambda(problem.dynamics.multipliers);
      for (int j = 0; j < n; ++j) z[n + j] = normal(random);
      const std::vector<double> p(z.begin() + n, z.end());
      const double h = problem.dynamics.evaluate(0, to_end.from, p, velocity, lambda).hamiltonian;
      const double length = std::sqrt(2 * h) * problem.time;
      ASSERT_TRUE(problem.dynamics.flow(StepPlan::equal(0, problem.time, 64), z).completed());
      to_end.to.assign(z.begin(), z.begin() + n);
      const double least = least_length(to_end, rates);
      EXPECT_LE(least, length);
      closest = std::max(closest, least / length);
    }
    EXPECT_GT(closest, 0.8);  // the bound is of some use
  }
}

TEST(TurnRates, AreNotKnownWithAPotential) {
  const BoundaryValueProblem problem = test::vehicle_cosine({0, 0, 0, 0}, {1, 1, 0, 0}, 1);
  for (const double rate : turn_rates(problem)) EXPECT_EQ(rate, kInfinity);
}

// How fast a bicycle turns depends on its steering angle, which has no period here.
TEST(TurnRates, AreNotKnownWhereMoreThanAnglesCounts) {
  for (const double rate : turn_rates(test::bicycle({1, 1, 0, 0}))) EXPECT_EQ(rate, kInfinity);
}

// What is left out could not have been the answer.
TEST(TurnRates, LoseNoGeodesic) {
  constexpr double kSame = 1e-9;
  GeodesicOptions options;
  options.samples = 0;
  for (const std::vector<double>& to : {std::vector<double>{0, 0.5, 0, 0},
                                        {0.3, 0, 3.1, 0.26},
                                        {1, 1, 1.5, -3},
                                        {-0.2, 0.4, -2.9, 2.9}}) {
    BoundaryValueProblem problem = test::sideways();
    problem.to = to;
    double least = kInfinity;
    for (const Image& image : images_of_target(problem, kInfinity)) {
      BoundaryValueProblem of_image = problem;
      of_image.to = image.to;
      const GeodesicReport report = find_geodesics(of_image, options);
      if (!report.geodesics.empty()) least = std::min(least, report.geodesics[0].action);
    }
    GeodesicOptions around = options;
    around.mod_angles = true;
    EXPECT_NEAR(find_geodesics(problem, around).geodesics.at(0).action, least, kSame * least);
  }
}

}  // namespace
}  // namespace carnot::internal::turn_rates_test
