#include "carnot/numerics/balance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "testing/random_points.h"

namespace carnot::balance_test {
namespace {

constexpr int n = 6;
using Square = Matrix<double, n, n>;
using Units = Vector<double, n>;

Square in_units(const Square& a, const Units& d) {
  return d.cwiseInverse().asDiagonal() * a * d.asDiagonal();
}

double off_diagonal(const Units& x, int i) { return x.sum() - x[i]; }

// Rows against columns of the balanced matrix, as powers of two can make them: each to a factor of
// two, and a factor of two more for what the last changes of the others left.
TEST(BalanceTest, RowsAndColumnsAreOfLikeSize) {
  test::Generator generator(1);
  for (int draw = 0; draw < 20; ++draw) {
    const Units d = test::random_vector<n>(generator, 40).array().exp();
    const Square a = in_units(test::random_matrix<n, n>(generator), d).cwiseAbs();
    const Square balanced = in_units(a, balanced_units(a));
    for (int i = 0; i < n; ++i) {
      const double row = off_diagonal(balanced.row(i).transpose(), i);
      const double column = off_diagonal(balanced.col(i), i);
      EXPECT_LT(row, 4 * column) << i;
      EXPECT_LT(column, 4 * row) << i;
    }
  }
}

// Nothing is rounded, and what is balanced is left alone.
TEST(BalanceTest, UnitsArePowersOfTwo) {
  test::Generator generator(2);
  const Square a = test::random_matrix<n, n>(generator).cwiseAbs();
  for (const double x : balanced_units(a)) {
    int exponent = 0;
    EXPECT_EQ(std::frexp(x, &exponent), 0.5);
  }
  Square cycle = Square::Zero();
  for (int i = 0; i < n; ++i) cycle(i, (i + 1) % n) = 1;
  EXPECT_EQ(balanced_units(cycle), Units::Ones());
  EXPECT_EQ(balanced_units(Square(Square::Zero())), Units::Ones());
}

// A row or a column alone, as of a coordinate that nothing depends on, comes to be of size one.
TEST(BalanceTest, ACoordinateThatNothingDependsOnHasAUnit) {
  Square a = Square::Zero();
  a(0, 1) = 1e12;
  a(2, 3) = 1e-12;
  const Square balanced = in_units(a, balanced_units(a));
  EXPECT_GE(balanced(0, 1), 0.5);
  EXPECT_LE(balanced(0, 1), 1);
  EXPECT_GE(balanced(2, 3), 0.5);
  EXPECT_LE(balanced(2, 3), 1);
}

}  // namespace
}  // namespace carnot::balance_test
