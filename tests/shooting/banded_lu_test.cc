#include "carnot/shooting/linear/banded_lu.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <random>

namespace carnot::internal::banded_lu_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

TEST(BandedLu, AgreesWithADenseSolver) {
  constexpr int kSize = 30;
  // One to five blocks of eight beside the pivot.
  for (const int below : {1, 4, 9, 15, 20}) {
    for (const int above : {2, 9, 15}) {
      std::mt19937 random(7);
      std::uniform_real_distribution<double> uniform(-1, 1);
      BandedLu banded(kSize, below, above);
      Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kSize, kSize);
      Eigen::VectorXd rhs(kSize);
      for (int i = 0; i < kSize; ++i) {
        rhs[i] = uniform(random);
        for (int j = std::max(0, i - below); j <= std::min(kSize - 1, i + above); ++j) {
          // Zeros on the diagonal: pivoting is needed.
          dense(i, j) = i == j ? 0.0 : uniform(random);
          banded(i, j) = dense(i, j);
        }
      }
      std::vector<double> x(rhs.data(), rhs.data() + kSize);
      ASSERT_TRUE(banded.solve(x));
      const Eigen::VectorXd expected = dense.fullPivLu().solve(rhs);
      const double condition = dense.norm() * dense.inverse().norm();
      for (int i = 0; i < kSize; ++i) {
        EXPECT_NEAR(x[i], expected[i], 10 * kEpsilon * condition * expected.norm());
      }
    }
  }
}

TEST(BandedLu, RefusesASingularMatrix) {
  BandedLu banded(3, 1, 1);
  banded(0, 0) = banded(0, 1) = banded(1, 0) = banded(1, 1) = 1;
  std::vector<double> x{1, 2, 3};
  EXPECT_FALSE(banded.solve(x));
}

TEST(BandedLu, RefusesWhatIsNotANumber) {
  BandedLu banded(1, 0, 0);
  banded(0, 0) = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> x{1};
  EXPECT_FALSE(banded.solve(x));
}

}  // namespace
}  // namespace carnot::internal::banded_lu_test
