// LU of small symmetric indefinite matrices, with rows of any units.
#include "carnot/numerics/scaled_lu.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carnot/numerics/gradient.h"
#include "testing/random_points.h"

namespace carnot::scaled_lu_test {
namespace {

constexpr double kEps = epsilon<double>();
constexpr int kSize = 5;
using Square = Matrix<double, kSize, kSize>;
using Column = Vector<double, kSize>;

// T'D T with T unit lower triangular and signs in D: |det| = 8, and a condition below 1e4.
Square random_indefinite(test::Generator& generator) {
  Square t = Square::Identity();
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < i; ++j) t(i, j) = test::random_vector<1>(generator)[0];
  }
  Column d;
  d << 1, -2, 0.5, -4, 2;
  const Square scaled = product(d.asDiagonal().toDenseMatrix(), t);
  return product(t.transpose(), scaled);
}
constexpr double kTolerance = 1e4 * kEps;

TEST(ScaledLuTest, SolvesIndefiniteSystems) {
  test::Generator generator(1);
  for (int sample = 0; sample < 20; ++sample) {
    const Square a = random_indefinite(generator);
    const Column x = test::random_vector<kSize>(generator);
    const ScaledLu<double, kSize> lu(a);
    ASSERT_TRUE(lu.regular());
    EXPECT_LE((lu.solve(Column(product(a, x))) - x).norm(), kTolerance);
    EXPECT_NEAR(lu.determinant(), 8, kTolerance);
  }
}

// A saddle, zeros on the diagonal: pivots must be looked for.
TEST(ScaledLuTest, SolvesSaddles) {
  Matrix<double, 2, 2> a;
  a << 0, 2, 2, 0;
  const ScaledLu<double, 2> lu(a);
  ASSERT_TRUE(lu.regular());
  EXPECT_NEAR(lu.determinant(), -4, 16 * kEps);
  EXPECT_LE((lu.solve(Vector<double, 2>(6, 4)) - Vector<double, 2>(2, 3)).norm(), 16 * kEps);
}

TEST(ScaledLuTest, UnitsDoNotMatter) {
  test::Generator generator(2);
  const Square a = random_indefinite(generator);
  Column units;
  units << 1e-12, 1, 1e10, 1e-9, 1e7;
  const Square scaled = a.cwiseProduct(product(units, units.transpose()));
  const ScaledLu<double, kSize> lu(scaled);
  ASSERT_TRUE(lu.regular());
  const Column b = test::random_vector<kSize>(generator);
  const Column plain = ScaledLu<double, kSize>(a).solve(b);
  const Column other = units.cwiseProduct(lu.solve(Column(units.cwiseProduct(b))));
  EXPECT_LE((plain - other).norm(), kTolerance * plain.norm());
}

TEST(ScaledLuTest, SingularIsSaid) {
  using Small = Matrix<double, 2, 2>;
  Small a;
  a << 1, 2, 2, 4;
  EXPECT_FALSE((ScaledLu<double, 2>(a).regular()));
  EXPECT_EQ((ScaledLu<double, 2>(a).determinant()), 0);
  a(1, 1) += 8 * kEps;  // in round-off
  EXPECT_FALSE((ScaledLu<double, 2>(a).regular()));
  a(1, 1) = 4 + 1e-10;
  EXPECT_TRUE((ScaledLu<double, 2>(a).regular()));
  EXPECT_FALSE((ScaledLu<double, 2>(Small::Zero()).regular()));
  a(0, 0) = std::nan("");
  EXPECT_FALSE((ScaledLu<double, 2>(a).regular()));
}

// A is a constant: each part of a Jet is solved for.
TEST(ScaledLuTest, JetsPartByPart) {
  using J = Jet<Jet<double, 2>, 1>;
  test::Generator generator(3);
  const Square a = random_indefinite(generator);
  const ScaledLu<double, kSize> lu(a);
  Column parts[4];
  Vector<J, kSize> b = Vector<J, kSize>::Constant(J());
  for (auto& part : parts) part = test::random_vector<kSize>(generator);
  parts[0][1] = 0;  // a value of zero keeps its derivatives
  for (int i = 0; i < kSize; ++i) {
    b[i].a.a = parts[0][i];
    b[i].a.v = {parts[1][i], parts[2][i]};
    b[i].v[0].a = parts[3][i];
  }
  const Vector<J, kSize> x = lu.solve(b);
  for (int i = 0; i < kSize; ++i) {
    EXPECT_EQ(x[i].a.a, lu.solve(parts[0])[i]);
    EXPECT_EQ(x[i].a.v[0], lu.solve(parts[1])[i]);
    EXPECT_EQ(x[i].a.v[1], lu.solve(parts[2])[i]);
    EXPECT_EQ(x[i].v[0].a, lu.solve(parts[3])[i]);
    EXPECT_EQ(x[i].v[0].v[0], 0);
  }
}

}  // namespace
}  // namespace carnot::scaled_lu_test
