// Steering allocates nothing where the answer is known; the counter is tested in verification/.
#include <gtest/gtest.h>

#include <vector>

#include "carnot/shooting/steering_function.h"
#include "shooting/problems.h"
#include "testing/allocation_counter.h"

namespace carnot {
namespace {

#ifdef CARNOT_TEST_COUNTS_MALLOC

TEST(SteeringAllocationTest, KnownAnswersAllocateNothing) {
  const SteeringFunction steer(test::unicycle({0, 0, 0}, {0, 0, 0}).segment);
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

#endif

}  // namespace
}  // namespace carnot
