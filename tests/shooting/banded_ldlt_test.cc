// Factors of banded symmetric matrices against dense ones, and their inertia.
#include "carnot/shooting/linear/banded_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace carnot::internal::banded_ldlt_test {
namespace {

constexpr int kSize = 12;
constexpr int kBand = 3;

// Quasi-definite: entries with an odd index have a negative diagonal.
Eigen::MatrixXd dense(double shift = 0) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    a(i, i) = (i % 2 == 0 ? 2.0 : -2.0) + shift;
    for (int j = i + 1; j <= std::min(i + kBand, kSize - 1); ++j) {
      a(i, j) = a(j, i) = 0.6 * std::sin(1 + 3 * i + 7 * j);
    }
  }
  return a;
}

BandedLdlt banded(const Eigen::MatrixXd& a) {
  BandedLdlt b(kSize, kBand);
  for (int i = 0; i < kSize; ++i) {
    for (int j = i; j <= std::min(i + kBand, kSize - 1); ++j) b(i, j) = a(i, j);
  }
  return b;
}

TEST(BandedLdlt, SolvesAsADenseMatrixDoes) {
  const Eigen::MatrixXd a = dense();
  BandedLdlt b = banded(a);
  ASSERT_TRUE(b.factor());
  Eigen::VectorXd right(kSize);
  for (int i = 0; i < kSize; ++i) right[i] = std::cos(i);
  std::vector<double> x(right.data(), right.data() + kSize);
  b.substitute(x);
  const Eigen::VectorXd expected = a.partialPivLu().solve(right);
  constexpr double kRoundOff = 1e3 * std::numeric_limits<double>::epsilon();
  for (int i = 0; i < kSize; ++i) EXPECT_NEAR(x[i], expected[i], kRoundOff);
}

TEST(BandedLdlt, CountsNegativeEigenvalues) {
  for (const double shift : {-4.0, -1.0, 0.0, 0.7, 1.9, 4.0}) {
    const Eigen::MatrixXd a = dense(shift);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues();
    const auto negative = banded(a).factor();
    ASSERT_TRUE(negative) << shift;
    EXPECT_EQ(*negative, (values.array() < 0).count()) << shift;
  }
}

TEST(BandedLdlt, RefusesAVanishingPivotAndNaN) {
  Eigen::MatrixXd a = dense();
  a(0, 0) = 0;
  EXPECT_FALSE(banded(a).factor());
  a(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(banded(a).factor());
}

}  // namespace
}  // namespace carnot::internal::banded_ldlt_test
