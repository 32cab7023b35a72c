#include "carnot/numerics/cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "carnot/numerics/gradient.h"
#include "testing/distance.h"
#include "testing/random_points.h"

namespace carnot::cholesky_test {
namespace {

using test::Generator;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kSamples = 50;

// Eigen's answers, of dynamic size and behind a call so that they are compiled once.
[[gnu::noinline]] void solve_by_eigen(
    int n, const double* a, const double* b, double* by_ldlt, double* by_llt) {
  const Eigen::Map<const Eigen::MatrixXd> matrix(a, n, n);
  const Eigen::Map<const Eigen::VectorXd> rhs(b, n);
  Eigen::Map<Eigen::VectorXd>(by_ldlt, n) = matrix.ldlt().solve(rhs);
  Eigen::Map<Eigen::VectorXd>(by_llt, n) = matrix.llt().solve(rhs);
}
template <int n>
Vector<double, n> eigen_solution(const Matrix<double, n, n>& a, const Vector<double, n>& b) {
  constexpr double kTolerance = 1e4 * kEps;  // both are backward stable, condition below 1e3
  Vector<double, n> by_ldlt;
  Vector<double, n> by_llt;
  solve_by_eigen(n, a.data(), b.data(), by_ldlt.data(), by_llt.data());
  EXPECT_LE(test::largest_change(by_ldlt, by_llt), kTolerance);
  return by_ldlt;
}

template <int n>
Matrix<double, n, n> random_symmetric(Generator& generator) {
  const Matrix<double, n, n> half = test::random_matrix<n, n>(generator);
  Matrix<double, n, n> sum = half;
  add_to(sum, test::transposed(half));
  return sum;
}

template <class Size>
class CholeskyTest : public ::testing::Test {
 protected:
  static constexpr int kRows = Size::value;
  // Condition number at most 2 kRows^2 + 1 and kRows operations per entry, forward and back.
  static constexpr double kTolerance = 16 * kRows * (2 * kRows * kRows + 1) * kEps;
};
template <int n>
using Size = std::integral_constant<int, n>;
struct SizeNames {
  template <class S>
  static std::string GetName(int /*index*/) {
    return "n" + std::to_string(S::value);
  }
};
using Sizes = ::testing::Types<Size<1>, Size<2>, Size<5>>;
TYPED_TEST_SUITE(CholeskyTest, Sizes, SizeNames);

TYPED_TEST(CholeskyTest, SolvesAsEigenDoes) {
  constexpr int n = TypeParam::value;
  Generator generator(1);
  for (int sample = 0; sample < kSamples; ++sample) {
    const Matrix<double, n, n> a = test::random_positive_matrix<n>(generator);
    const Vector<double, n> b = test::random_vector<n>(generator);
    const Cholesky<double, n> factor(a);
    ASSERT_TRUE(factor.positive());
    const Vector<double, n> x = factor.solve(b);
    EXPECT_LE(test::largest_change(x, eigen_solution(a, b)), this->kTolerance);
  }
}

TYPED_TEST(CholeskyTest, FactorsMultiplyToTheMatrix) {
  constexpr int n = TypeParam::value;
  Generator generator(2);
  const Matrix<double, n, n> a = test::random_positive_matrix<n>(generator);
  Matrix<double, n, n> lower = filled<n, n>(0.0);
  Vector<double, n> pivots;
  ASSERT_TRUE(cholesky_factor(a, lower, pivots));
  Matrix<double, n, n> scaled;
  for (int j = 0; j < n; ++j) {
    lower(j, j) = 1;
    for (int i = 0; i < n; ++i) scaled(i, j) = lower(i, j) * pivots[j];
    EXPECT_GT(pivots[j], 0);
  }
  EXPECT_LE(test::largest_change(times_transposed(scaled, lower), a), this->kTolerance);
}

TYPED_TEST(CholeskyTest, ReadsTheLowerTriangleOnly) {
  constexpr int n = TypeParam::value;
  Generator generator(3);
  const Matrix<double, n, n> a = test::random_positive_matrix<n>(generator);
  Matrix<double, n, n> poisoned = a;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < j; ++i) poisoned(i, j) = kNan;
  }
  const Vector<double, n> b = test::random_vector<n>(generator);
  const Vector<double, n> x = Cholesky<double, n>(poisoned).solve(b);
  EXPECT_EQ(test::largest_change(x, Cholesky<double, n>(a).solve(b)), 0);
}

// dx = A^-1 (db - dA x), here with A^-1 by another solver. Values 0 in b are the hard case: a
// solver that skips them loses their derivatives.
TYPED_TEST(CholeskyTest, DerivativesObeyTheImplicitFunctionTheorem) {
  constexpr int n = TypeParam::value;
  constexpr int N = 3;
  using J = Jet<double, N>;
  Generator generator(4);
  for (int sample = 0; sample < kSamples; ++sample) {
    const Matrix<double, n, n> a = test::random_positive_matrix<n>(generator);
    Vector<double, n> b = test::random_vector<n>(generator);
    if (sample % 2 == 0) b[0] = 0;
    if (sample % 4 == 0) b = filled<n>(0.0);
    Matrix<J, n, n> aj;
    Vector<J, n> bj;
    std::array<Matrix<double, n, n>, N> da;
    std::array<Vector<double, n>, N> db;
    for (int d = 0; d < N; ++d) {
      da[d] = random_symmetric<n>(generator);
      db[d] = test::random_vector<n>(generator);
    }
    for (int i = 0; i < n; ++i) {
      bj[i].a = b[i];
      for (int d = 0; d < N; ++d) bj[i].v[d] = db[d][i];
      for (int j = 0; j < n; ++j) {
        aj(i, j).a = a(i, j);
        for (int d = 0; d < N; ++d) aj(i, j).v[d] = da[d](i, j);
      }
    }
    const Cholesky<J, n> factor(aj);
    ASSERT_TRUE(factor.positive());
    const Vector<J, n> x = factor.solve(bj);
    const Vector<double, n> value = eigen_solution(a, b);
    for (int d = 0; d < N; ++d) {
      Vector<double, n> rest = db[d];
      subtract_from(rest, product(da[d], value));
      const Vector<double, n> exact = eigen_solution<n>(a, rest);
      // |dx| can be larger than |x| by |dA| |A^-1|, at most 4 n.
      for (int i = 0; i < n; ++i) {
        EXPECT_NEAR(x[i].v[d], exact[i], 4 * n * this->kTolerance);
        EXPECT_NEAR(x[i].a, value[i], this->kTolerance);
      }
    }
  }
}

// The straight-line factor on Jets against the implicit route: |D^(1/2) L' v|^2 = v'A v, so the
// derivatives of both sides agree.
TYPED_TEST(CholeskyTest, FactorIsDifferentiable) {
  constexpr int n = TypeParam::value;
  using J = Jet<double, 1>;
  Generator generator(5);
  const Matrix<double, n, n> a = test::random_positive_matrix<n>(generator);
  const Matrix<double, n, n> da = random_symmetric<n>(generator);
  const Vector<double, n> v = test::random_vector<n>(generator);
  Matrix<J, n, n> aj;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) aj(i, j) = J(a(i, j), Vector<double, 1>(da(i, j)));
  }
  Matrix<J, n, n> lower;
  Vector<J, n> pivots;
  ASSERT_TRUE(cholesky_factor(aj, lower, pivots));
  J square(0);
  for (int i = 0; i < n; ++i) {
    J sum(v[i]);
    for (int j = i + 1; j < n; ++j) sum += lower(j, i) * v[j];
    square += pivots[i] * sum * sum;
  }
  EXPECT_NEAR(square.a, dot(v, product(a, v)), n * this->kTolerance);
  EXPECT_NEAR(square.v[0], dot(v, product(da, v)), n * this->kTolerance);
}

// x = b / a on nested Jets: the second derivatives are known.
TEST(CholeskyNestedJets, SecondDerivatives) {
  using Inner = Jet<double, 2>;
  using Outer = Jet<Inner, 2>;
  constexpr double kA = 1.7;
  for (const double b : {0.0, 1e-8, -2.5}) {
    const Vector<Inner, 2> inner = seeded(Vector<double, 2>(kA, b));
    const Vector<Outer, 2> outer = seeded(inner);
    const Matrix<Outer, 1, 1> a(outer[0]);
    const Cholesky<Outer, 1> factor(a);
    ASSERT_TRUE(factor.positive());
    const Outer x = factor.solve(Vector<Outer, 1>(outer[1]))[0];
    constexpr double kTolerance = 8 * kEps;  // a handful of operations on numbers below 4
    EXPECT_NEAR(x.a.a, b / kA, kTolerance);
    EXPECT_NEAR(x.v[0].v[0], 2 * b / (kA * kA * kA), kTolerance);
    EXPECT_NEAR(x.v[0].v[1], -1 / (kA * kA), kTolerance);
    EXPECT_NEAR(x.v[1].v[0], -1 / (kA * kA), kTolerance);
    EXPECT_NEAR(x.v[1].v[1], 0, kTolerance);
  }
}

TEST(CholeskyRefuses, IndefiniteSingularAndNotFinite) {
  Generator generator(6);
  const Matrix<double, 3, 3> good = test::random_positive_matrix<3>(generator);
  ASSERT_TRUE((Cholesky<double, 3>(good).positive()));
  const auto refused = [](const Matrix<double, 3, 3>& a) {
    return !Cholesky<double, 3>(a).positive();
  };
  Matrix<double, 3, 3> negative = filled<3, 3>(0.0);
  subtract_from(negative, good);
  EXPECT_TRUE(refused(negative));
  EXPECT_TRUE(refused(filled<3, 3>(0.0)));
  EXPECT_TRUE(refused(filled<3, 3>(1.0)));  // rank 1: the pivots are round-off
  EXPECT_TRUE(refused(diagonal<double>(1, -1, 1)));
  EXPECT_TRUE(refused(diagonal<double>(1, 1, 0)));
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        Matrix<double, 3, 3> a = good;
        a(i, j) = bad;
        EXPECT_TRUE(refused(a)) << bad << " at " << i << ", " << j;
      }
    }
  }
}

// Rank loss hidden by rounding: u u' with u not representable.
TEST(CholeskyRefuses, RankOneUpToRoundOff) {
  Generator generator(7);
  for (int sample = 0; sample < kSamples; ++sample) {
    const Vector<double, 3> u = test::random_vector<3>(generator);
    EXPECT_FALSE((Cholesky<double, 3>(times_transposed(u, u)).positive()));
  }
}

// The verdict does not depend on the units.
TEST(CholeskyAccepts, AnyScale) {
  Generator generator(8);
  const Matrix<double, 3, 3> good = test::random_positive_matrix<3>(generator);
  for (const double scale : {1e-150, 1e-8, 1.0, 1e8, 1e150}) {
    const Vector<double, 3> units(1, std::sqrt(scale), 1);
    Matrix<double, 3, 3> scaled, own_units;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        scaled(i, j) = scale * good(i, j);
        own_units(i, j) = units[i] * good(i, j) * units[j];
      }
    }
    EXPECT_TRUE((Cholesky<double, 3>(scaled).positive())) << scale;
    EXPECT_TRUE((Cholesky<double, 3>(own_units).positive())) << scale;
  }
}

}  // namespace
}  // namespace carnot::cholesky_test
