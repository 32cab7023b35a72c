// What is asked of the ends of an extremal.
#include "carnot/shooting/problem/ends.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "carnot/shooting/shoot/end_point.h"
#include "shooting/problems.h"

namespace carnot::internal::ends_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

BoundaryValueProblem half_free() {
  BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {1, 2, 0.5, 0});
  problem.free_to = {false, false, true, true};
  return problem;
}

TEST(Ends, ErrorsAreTheLargestOfTheirNumbers) {
  const BoundaryValueProblem problem = half_free();
  const std::vector<double> z{1.1, 1.7, 9, 9, 7, 7, -0.2, 0.1};
  EXPECT_NEAR(endpoint_error(problem, z.data()), 0.3, 1e-15);
  EXPECT_NEAR(transversality_error(problem, z.data()), 0.2, 1e-15);
  EXPECT_NEAR(miss(problem, z.data(), 10), 2, 1e-14);
  EXPECT_EQ(distance_between_ends(problem), 2);
}

// One number that is none makes the error none, wherever it stands: an extremal with such an end
// has not arrived.
TEST(Ends, ANumberThatIsNoneHasNotArrived) {
  const BoundaryValueProblem problem = half_free();
  for (const int j : {0, 1, 6, 7}) {
    std::vector<double> z{1, 2, 0, 0, 0, 0, 0, 0};
    ASSERT_EQ(miss(problem, z.data(), 1), 0);
    z[j] = kNan;
    EXPECT_TRUE(std::isnan(miss(problem, z.data(), 1))) << j;
  }
  const std::vector<double> a{1, 2, 3};
  for (int j = 0; j < 3; ++j) {
    std::vector<double> b = a;
    b[j] = kNan;
    EXPECT_TRUE(std::isnan(largest_difference(a.data(), b.data(), 3))) << j;
  }
}

}  // namespace
}  // namespace carnot::internal::ends_test
