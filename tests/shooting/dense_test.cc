// Decompositions by what they promise, on matrices whose decompositions are known.
#include "carnot/shooting/linear/dense.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace carnot::internal::dense_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRounded = 1e-13;  // of matrices of six rows with entries of size one

MatrixXd random_matrix(int rows, int columns, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

void expect_equal(const MatrixXd& a, const MatrixXd& b, double tolerance = kRounded) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), tolerance) << a << "\n\n" << b;
}

// Diagonals of 4 keep them far from singular.
MatrixXd regular(int n) { return random_matrix(n, n, 1) + 4 * MatrixXd::Identity(n, n); }

TEST(Dense, LuSolvesAndInverts) {
  const MatrixXd a = regular(6);
  const VectorXd x = random_matrix(6, 1, 2);
  expect_equal(lu_solve(a, a * x), x);
  expect_equal(lu_inverse(a) * a, MatrixXd::Identity(6, 6));
  const SmallMatrix small = a;
  expect_equal(small_lu_solve(small, a * x), x);
  expect_equal(small_lu_inverse(small) * small, MatrixXd::Identity(6, 6));
}

TEST(Dense, Products) {
  const MatrixXd a = random_matrix(2, 3, 9);
  const MatrixXd b = random_matrix(3, 2, 10);
  MatrixXd expected = MatrixXd::Zero(2, 2);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      for (int k = 0; k < 3; ++k) expected(i, j) += a(i, k) * b(k, j);
    }
  }
  expect_equal(product(a, b), expected);
  expect_equal(transposed_product(a.transpose(), b), expected);
}

TEST(Dense, InverseOnlyWhereRegular) {
  const SmallMatrix a = regular(5);
  const auto inverse = inverse_if_regular(a, 1e-11);
  ASSERT_TRUE(inverse);
  expect_equal(*inverse * a, MatrixXd::Identity(5, 5));
  MatrixXd singular = a;
  singular.col(3) = singular.col(1);
  EXPECT_FALSE(inverse_if_regular(singular, 1e-11));
  // Just above and just below the threshold.
  MatrixXd nearly = MatrixXd::Identity(2, 2);
  nearly(1, 1) = 1.01e-6;
  EXPECT_TRUE(inverse_if_regular(nearly, 1e-6));
  nearly(1, 1) = 0.99e-6;
  EXPECT_FALSE(inverse_if_regular(nearly, 1e-6));
}

TEST(Dense, DeterminantBySignAndSize) {
  MatrixXd a(3, 3);
  a << 0, 2, 0, 3, 0, 0, 0, 0, 5;  // one exchange of rows: -30
  EXPECT_EQ(determinant_of(a).sign, -1);
  EXPECT_NEAR(determinant_of(a).log_size, std::log(30), kRounded);
  a.row(2) *= -1;
  EXPECT_EQ(determinant_of(a).sign, 1);
  // Far beyond what a double holds.
  const MatrixXd large = 1e200 * MatrixXd::Identity(4, 4);
  EXPECT_NEAR(determinant_of(large).log_size, 800 * std::log(10), 1e-9);
}

TEST(Dense, QrFactorsAndTheirBasis) {
  const MatrixXd columns = random_matrix(6, 3, 3);
  const QrFactors factors = qr_factors(columns);
  expect_equal(factors.q.transpose() * factors.q, MatrixXd::Identity(3, 3));
  expect_equal(factors.q * factors.r, columns);
  EXPECT_TRUE(factors.r.isUpperTriangular(0));
  const MatrixXd right = random_matrix(3, 2, 4);
  expect_equal(factors.r * lu_solve(factors.r, right), right);
}

// Of every shape, of columns of any length, and of columns that repeat each other: the basis is
// orthonormal in any case, and spans what the columns do.
TEST(Dense, OrthonormalBasesSpanTheColumns) {
  constexpr double kFar = 1e8;
  for (int n = 1; n <= 8; ++n) {
    for (const int rows : {n, 2 * n, 2 * n + 1}) {
      MatrixXd columns = random_matrix(rows, n, 20 + n);
      columns.col(0) *= kFar;
      columns.col(n - 1) /= kFar;
      if (n > 3) columns.col(2) = columns.col(1);
      const MatrixXd basis = orthonormal(columns);
      expect_equal(basis.transpose() * basis, MatrixXd::Identity(n, n));
      for (int j = 0; j < n; ++j) {
        const VectorXd column = columns.col(j).normalized();
        expect_equal(basis * (basis.transpose() * column), column);
      }
      if (n > 3) continue;  // round-off decides where the third column goes
      expect_equal(orthonormal(columns), qr_factors(columns).q);
    }
  }
  expect_equal(orthonormal(MatrixXd::Zero(4, 2)), MatrixXd::Identity(4, 2));
}

TEST(Dense, KernelOfOneRowTooFew) {
  MatrixXd rows = random_matrix(4, 5, 5);
  const auto kernel = kernel_line(rows, 1e-11);
  ASSERT_TRUE(kernel);
  EXPECT_NEAR(kernel->norm(), 1, kRounded);
  expect_equal(rows * *kernel, VectorXd::Zero(4));
  rows.row(3) = rows.row(0) - 2 * rows.row(1);  // the kernel is a plane
  EXPECT_FALSE(kernel_line(rows, 1e-11));
}

TEST(Dense, SymmetricEigenvaluesAscend) {
  for (int n = 1; n <= 8; ++n) {
    const MatrixXd basis = orthonormal(random_matrix(n, n, 6));
    const VectorXd values = VectorXd::LinSpaced(n, -3, 7).array().floor();
    const MatrixXd a = basis * values.asDiagonal() * basis.transpose();
    const SymmetricEigen eigen = symmetric_eigen(a);
    expect_equal(eigen.values, values);
    expect_equal(eigen.vectors.transpose() * eigen.vectors, MatrixXd::Identity(n, n));
    expect_equal(eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose(), a);
  }
}

// As many as the eigenvalues tell, for bounds between them, and close to one of them.
TEST(Dense, CountsEigenvaluesBelowABound) {
  constexpr double kClose = 1e-12;
  std::mt19937 generator(11);
  std::normal_distribution<double> normal;
  for (int sample = 0; sample < 200; ++sample) {
    const int n = 1 + sample % 6;
    const MatrixXd some = MatrixXd::NullaryExpr(n, n, [&] { return normal(generator); });
    const MatrixXd a = some + some.transpose();
    const VectorXd values = symmetric_eigen(a).values;
    EXPECT_EQ(count_below(a, values[0] - 1), 0);
    EXPECT_EQ(count_below(a, values[n - 1] + 1), n);
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(count_below(a, values[i] - kClose), i);
      EXPECT_EQ(count_below(a, values[i] + kClose), i + 1);
    }
  }
  // Without a pivot to begin with.
  SmallMatrix saddle(2, 2);
  saddle << 0, 1, 1, 0;
  EXPECT_EQ(count_below(saddle, 0), 1);
  EXPECT_EQ(count_below(SmallMatrix::Zero(3, 3), 0), 0);
}

TEST(Dense, SpectralRadiusInAnyUnits) {
  // Eigenvalues 2 exp(+-i angle) and 0.5, of a matrix that is no normal one.
  constexpr double kUnits = 1e-9;  // round-off of traces in which terms cancel
  EXPECT_EQ(spectral_radius(MatrixXd::Zero(3, 3)), 0);
  for (const double angle : {0.0, 0.1, 0.2, 0.4, 0.8, 1.6, 3.1}) {
    MatrixXd a(3, 3);
    a << 2 * std::cos(angle), -2 * std::sin(angle), 1,  //
        2 * std::sin(angle), 2 * std::cos(angle), 1,    //
        0, 0, 0.5;
    const double radius = spectral_radius(a);
    EXPECT_GT(radius, 2 * 0.95 * std::pow(3, -1.0 / 16)) << angle;
    EXPECT_LT(radius, 2) << angle;
    const Eigen::Vector3d d(1, 1e6, 1e-6);
    const MatrixXd other = d.asDiagonal() * a * d.cwiseInverse().asDiagonal();
    EXPECT_NEAR(spectral_radius(other), radius, kUnits) << angle;
  }
}

TEST(Dense, SingularValuesDescend) {
  const MatrixXd left = orthonormal(random_matrix(6, 3, 7));
  const MatrixXd right = orthonormal(random_matrix(3, 3, 8));
  const VectorXd values = Eigen::Vector3d(5, 0.5, 0);
  const MatrixXd a = left * values.asDiagonal() * right.transpose();
  expect_equal(singular_values(a), values);
  const RightSingular found = right_singular(a);
  expect_equal(found.values, values);
  expect_equal(a * found.vectors.col(2), VectorXd::Zero(6));
  EXPECT_NEAR((a * found.vectors.col(0)).norm(), 5, kRounded);
}

TEST(Dense, LeastSquaresHaveTheLeastNorm) {
  MatrixXd a(2, 3);
  a << 1, 0, 0, 0, 2, 0;  // the third unknown is free
  expect_equal(least_squares(a, Eigen::Vector2d(3, 4), 1e-13), Eigen::Vector3d(3, 2, 0));
  // Without a solution, the nearest.
  expect_equal(least_squares(a.transpose(), Eigen::Vector3d(1, 2, 9), 1e-13),
               Eigen::Vector2d(1, 1));
  // The second row counts as zero under a generous threshold.
  a(1, 1) = 1e-6;
  expect_equal(least_squares(a, Eigen::Vector2d(3, 4), 1e-4), Eigen::Vector3d(3, 0, 0));
}

}  // namespace
}  // namespace carnot::internal::dense_test
