#include "carnot/numerics/linear_algebra.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "testing/random_points.h"

namespace carnot::linear_algebra_test {
namespace {

using test::Generator;
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
  EXPECT_LE((product(a, b) - a * b).cwiseAbs().maxCoeff(), kProduct);
  EXPECT_LE((transposed_times(a, c) - a.transpose() * c).cwiseAbs().maxCoeff(), kProduct);
  EXPECT_LE((times_transposed(b, c) - b * c.transpose()).cwiseAbs().maxCoeff(), kProduct);
  const Vector<double, 3> by_vector = transposed_times(a, x);
  EXPECT_LE((by_vector - a.transpose() * x).cwiseAbs().maxCoeff(), kProduct);
}

TEST(LinearAlgebra, EntriesAreThoseOfEigen) {
  Generator random(2);
  const auto a = test::random_matrix<3, 2>(random);
  const auto b = test::random_matrix<3, 2>(random);
  auto sum = a;
  add_to(sum, b);
  EXPECT_EQ(sum, a + b);
  subtract_from(sum, b);
  EXPECT_EQ(sum, (a + b) - b);
  EXPECT_EQ(absolute(a), a.cwiseAbs());
  EXPECT_EQ(largest_entry(a), a.cwiseAbs().maxCoeff());
  EXPECT_EQ(filled<3>(2.5), (Vector<double, 3>::Constant(2.5)));
  EXPECT_EQ((filled<3, 2>(2.5)), (Matrix<double, 3, 2>::Constant(2.5)));
  EXPECT_EQ((identity<3, double>()), (Matrix<double, 3, 3>::Identity()));
  const Vector<double, 4> x(1, 2, 3, 4);
  EXPECT_EQ((part<1, 2>(x)), (Vector<double, 2>(2, 3)));
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
