// Steering allocates nothing where the answer is known, and warm starts never do; the counter is
// tested in verification/.
#include <gtest/gtest.h>

#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/steering_function.h"
#include "carnot/shooting/warm_start.h"
#include "shooting/problems.h"
#include "testing/allocation_counter.h"

namespace carnot::steering_allocation_test {
namespace {

#ifdef CARNOT_TEST_COUNTS_MALLOC

TEST(SteeringAllocationTest, KnownAnswersAllocateNothing) {
  const SteeringFunction steer(test::unicycle({0, 0, 0}, {0, 0, 0}).dynamics);
  const std::vector<double> a{0, 0, 0};
  const std::vector<double> b{1, 0.5, 1};
  std::vector<double> q(3);
  double distance = steer.distance(a, b);
  ASSERT_TRUE(steer.interpolate(a, b, 0.5, q));
  const long allocations = test::allocations_in([&] {
    distance = steer.distance(a, b);
    distance += steer.distance(b, a);
    for (const double t : {0.0, 0.3, 0.5, 0.99, 1.0}) (void)steer.interpolate(b, a, t, q);
  });
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(test::allocations_in([&] { distance = steer.steer(a, b).distance(); }), 0);
}

TEST(SteeringAllocationTest, WarmStartsAllocateNothing) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 1});
  const Geodesic near = find_geodesics(problem).geodesics.at(0);
  const WarmStart start(problem, near.p0);
  ASSERT_TRUE(start.ready());
  const std::vector<double> to{1.01, 0.99, 1};
  const std::vector<double> far{-20, 30, 40};
  std::vector<double> p0(3);
  const long allocations = test::allocations_in([&] {
    EXPECT_TRUE(start.solve(to.data(), p0.data()).converged);
    EXPECT_FALSE(start.solve(far.data(), p0.data()).converged);
  });
  EXPECT_EQ(allocations, 0);
}

#endif

}  // namespace
}  // namespace carnot::steering_allocation_test
