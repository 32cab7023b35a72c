#include "carnot/numerics/linear_algebra.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "testing/distance.h"
#include "testing/random_points.h"

namespace carnot::linear_algebra_test {
namespace {

using test::Generator;
using test::largest_change;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kProduct = 4 * kEps;  // sums of three products of numbers below one

// Loops against Eigen's expressions.
TEST(LinearAlgebra, ProductsAreThoseOfEigen) {
  Generator random(1);
  const auto a = test::random_matrix<2, 3>(random);
  const auto b = test::random_matrix<3, 4>(random);
  const auto c = test::random_matrix<2, 4>(random);
  const Vector<double, 2> x(0.5, -2);
  EXPECT_LE(largest_change(product(a, b), (a * b).eval()), kProduct);
  EXPECT_LE(largest_change(transposed_times(a, c), (a.transpose() * c).eval()), kProduct);
  EXPECT_LE(largest_change(times_transposed(b, c), (b * c.transpose()).eval()), kProduct);
  EXPECT_LE(largest_change(transposed_times(a, x), (a.transpose() * x).eval()), kProduct);
}

TEST(LinearAlgebra, EntriesAreThoseOfEigen) {
  Generator random(2);
  const auto a = test::random_matrix<3, 2>(random);
  const auto b = test::random_matrix<3, 2>(random);
  auto sum = a;
  add_to(sum, b);
  EXPECT_EQ(largest_change(sum, (a + b).eval()), 0);
  subtract_from(sum, b);
  EXPECT_EQ(largest_change(sum, ((a + b) - b).eval()), 0);
  EXPECT_EQ(largest_change(absolute(a), a.cwiseAbs().eval()), 0);
  EXPECT_EQ(largest_entry(a), a.cwiseAbs().maxCoeff());
  EXPECT_EQ(largest_change(filled<3>(2.5), Vector<double, 3>(2.5, 2.5, 2.5)), 0);
  EXPECT_EQ(largest_change(filled<3, 2>(2.5), Matrix<double, 3, 2>::Constant(2.5).eval()), 0);
  EXPECT_EQ(largest_change(identity<3, double>(), diagonal<double>(1, 1, 1)), 0);
  const Vector<double, 4> x(1, 2, 3, 4);
  EXPECT_EQ(largest_change(part<1, 2>(x), Vector<double, 2>(2, 3)), 0);
  EXPECT_EQ((part<3, 1>(x))[0], 4);
}

TEST(LinearAlgebra, ANumberThatIsNoneIsTheLargestEntry) {
  for (int i = 0; i < 3; ++i) {
    Vector<double, 3> x(1, -5, 2);
    x[i] = kNan;
    EXPECT_TRUE(std::isnan(largest_entry(x))) << i;
  }
  EXPECT_EQ(largest_entry(Vector<double, 0>()), 0);
}

}  // namespace
}  // namespace carnot::linear_algebra_test
