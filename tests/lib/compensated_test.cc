#include "carnot/numerics/compensated.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "carnot/numerics/linear_algebra.h"
#include "testing/random_points.h"

namespace carnot::compensated_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// Increments far below the unit of the value add up nevertheless.
TEST(CompensatedTest, KeepsIncrementsBelowTheUnitOfTheValue) {
  constexpr int kCount = 1 << 20;
  const double tiny = std::ldexp(1.0, -60);
  Compensated<double> sum{1.0, 0.0};
  double naive = 1.0;
  for (int i = 0; i < kCount; ++i) {
    sum.add(tiny);
    naive += tiny;
  }
  EXPECT_EQ(naive, 1.0);
  EXPECT_EQ(sum.value, 1.0 + kCount * tiny);  // 2^-40, exact
}

// value + compensation is the sum of all increments, against long double.
TEST(CompensatedTest, ErrorDoesNotGrowWithTheNumberOfTerms) {
  constexpr int kCount = 100000;
  test::Generator generator(1);
  Compensated<double> sum{1.0, 0.0};
  double naive = 1;
  long double exact = 1;
  for (int i = 0; i < kCount; ++i) {
    const double increment = 1e-3 * (1 + test::random_vector<1>(generator)[0]);
    sum.add(increment);
    naive += increment;
    exact += increment;
  }
  const auto value = static_cast<double>(exact);
  // One rounding of the result; long double itself is wrong by kCount * 5e-20 * 50.
  EXPECT_NEAR(sum.value, value, kEps * value);
  // With the compensation, what is lost is one rounding of each increment, a random walk.
  const long double both = static_cast<long double>(sum.value) + sum.compensation;
  EXPECT_NEAR(static_cast<double>(both - exact), 0, 4 * std::sqrt(kCount) * 2e-3 * 0.5 * kEps);
  EXPECT_GT(std::abs(naive - value), 4 * kEps * value);  // and the plain sum is worse
}

// The compensation is the exact remainder: nothing is lost while increments are smaller.
TEST(CompensatedTest, RemainderIsBelowHalfAUnit) {
  test::Generator generator(2);
  Compensated<double> sum{1.0, 0.0};
  for (int i = 0; i < 1000; ++i) {
    sum.add(1e-2 * test::random_vector<1>(generator)[0]);
    EXPECT_LE(std::abs(sum.compensation), 0.5 * kEps * std::max(1.0, std::abs(sum.value)));
  }
}

// Adding increments and then taking them away returns to the start.
TEST(CompensatedTest, ForthAndBackOnVectors) {
  using V = Vector<double, 3>;
  test::Generator generator(3);
  const V start = test::random_vector<3>(generator);
  Compensated<V> sum{start, V::Zero()};
  std::vector<V> increments;
  for (int i = 0; i < 1000; ++i) {
    increments.push_back(test::random_vector<3>(generator, 1e-2));
    sum.add(increments.back());
  }
  for (int i = 999; i >= 0; --i) sum.add(-increments[static_cast<std::size_t>(i)]);
  const V missing = (sum.value - start) + sum.compensation;
  // One rounding of each of the 2000 increments, a random walk.
  EXPECT_LE(missing.cwiseAbs().maxCoeff(), 4 * std::sqrt(2000) * 1e-2 * 0.5 * kEps);
}

}  // namespace
}  // namespace carnot::compensated_test
