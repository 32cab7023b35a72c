#include "carnot/shooting/problem/manifold.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carnot/shooting/linear/norm.h"
#include "shooting/problems.h"

namespace carnot::internal::manifold_test {
namespace {

constexpr double kRounded = 1e-13;

TEST(Manifold, WithoutConstraintsNothingMoves) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 0});
  std::vector<double> q{3, 4, 5};
  EXPECT_TRUE(bring_to_manifold(problem.dynamics, q.data()));
  EXPECT_EQ(q, (std::vector<double>{3, 4, 5}));
  std::vector<double> p{1, 2, 3};
  EXPECT_TRUE(bring_to_manifold(problem, p));
  EXPECT_EQ(p, (std::vector<double>{1, 2, 3}));
}

TEST(Manifold, QuaternionsAreBroughtToLengthOne) {
  const Dynamics dynamics = test::satellite_quaternion({0, 1, 0, 0}).dynamics;
  std::vector<double> q{1, 2, -2, 4};
  ASSERT_TRUE(bring_to_manifold(dynamics, q.data()));
  EXPECT_NEAR(norm(q), 1, kRounded);
  const std::vector<double> there = q;
  ASSERT_TRUE(bring_to_manifold(dynamics, q.data()));
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(q[j], there[j], kRounded);
}

TEST(Manifold, WhereThereIsNoPointQStays) {
  const Dynamics dynamics = test::satellite_quaternion({0, 1, 0, 0}).dynamics;
  std::vector<double> q{0, 0, 0, 0};  // equally far from all of them, and Dh = 0
  EXPECT_FALSE(bring_to_manifold(dynamics, q.data()));
  EXPECT_EQ(q, (std::vector<double>{0, 0, 0, 0}));
}

TEST(Manifold, VelocitiesOfMomentaAreTangent) {
  const BoundaryValueProblem problem = test::satellite_quaternion({0, 1, 0, 0});
  std::vector<double> p{5, 0.3, -0.2, 0.1};
  ASSERT_TRUE(bring_to_manifold(problem, p));
  std::vector<double> velocity(4), lambda(problem.dynamics.multipliers);
  problem.dynamics.evaluate(0, problem.from, p, velocity, lambda);
  EXPECT_NEAR(velocity[0], 0, kRounded);  // Dh = (1, 0, 0, 0) at the attitude 1
  EXPECT_GT(norm(velocity), 0.01);
  const std::vector<double> there = p;
  ASSERT_TRUE(bring_to_manifold(problem, p));
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(p[j], there[j], kRounded);
}

}  // namespace
}  // namespace carnot::internal::manifold_test
