#include "carnot/shooting/linear/banded_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <random>

namespace carnot::internal::banded_cholesky_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

TEST(BandedCholesky, AgreesWithADenseSolver) {
  constexpr int kSize = 30;
  for (const int above : {0, 1, 7, 29}) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    BandedCholesky banded(kSize, above);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kSize, kSize);
    Eigen::VectorXd rhs(kSize);
    for (int i = 0; i < kSize; ++i) {
      rhs[i] = uniform(random);
      for (int j = i; j <= std::min(kSize - 1, i + above); ++j) {
        dense(i, j) = dense(j, i) = i == j ? above + 1.0 : 0.5 * uniform(random);  // dominant
        banded(i, j) = dense(i, j);
      }
    }
    std::vector<double> x(rhs.data(), rhs.data() + kSize);
    ASSERT_TRUE(banded.factor());
    banded.substitute(x);
    const Eigen::VectorXd expected = dense.fullPivLu().solve(rhs);
    const double condition = dense.norm() * dense.inverse().norm();
    for (int i = 0; i < kSize; ++i) {
      EXPECT_NEAR(x[i], expected[i], 10 * kEpsilon * condition * expected.norm());
    }
  }
}

TEST(BandedCholesky, RefusesWhatIsNotPositiveDefinite) {
  BandedCholesky singular(2, 1);
  singular(0, 0) = singular(0, 1) = singular(1, 1) = 1;
  EXPECT_FALSE(singular.factor());
  BandedCholesky indefinite(2, 1);
  indefinite(0, 0) = indefinite(1, 1) = 1;
  indefinite(0, 1) = 2;
  EXPECT_FALSE(indefinite.factor());
  BandedCholesky nothing(1, 0);
  nothing(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(nothing.factor());
}

}  // namespace
}  // namespace carnot::internal::banded_cholesky_test
