#include "carnot/numerics/pseudo_inverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "testing/random_points.h"

namespace carnot::pseudo_inverse_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Entries up to 1; smallest singular value kept above 1e-2 by dropping worse samples.
constexpr double kRoundOff = 1000 * kEps;
constexpr double kWellConditioned = 1e-2;
constexpr int kSamples = 50;

template <int rows, int cols>
struct Inverse {
  Matrix<double, cols, rows> plus;
  Matrix<double, rows, cols> plus_transposed;
  int rank;

  explicit Inverse(const Matrix<double, rows, cols>& a) {
    const PseudoInverse<double, rows, cols> inverse(a);
    for (int i = 0; i < rows; ++i) {
      plus.col(i) = inverse.solve(Vector<double, rows>(Vector<double, rows>::Unit(i)));
    }
    for (int j = 0; j < cols; ++j) {
      plus_transposed.col(j) =
          inverse.solve_transposed(Vector<double, cols>(Vector<double, cols>::Unit(j)));
    }
    rank = inverse.rank();
  }
};

// The four identities of Penrose determine the pseudo-inverse. False for a sample left out.
template <int rows, int cols>
bool expect_penrose(const Matrix<double, rows, cols>& a, int rank) {
  const Inverse<rows, cols> inverse(a);
  const auto& plus = inverse.plus;
  if (plus.norm() > 1 / kWellConditioned) return false;
  const double tolerance = kRoundOff * std::max(1.0, plus.norm() * plus.norm());
  const Matrix<double, rows, rows> left = a * plus;
  const Matrix<double, cols, cols> right = plus * a;
  EXPECT_LE((left * a - a).norm(), tolerance);
  EXPECT_LE((right * plus - plus).norm(), tolerance);
  EXPECT_LE((left - left.transpose()).norm(), tolerance);
  EXPECT_LE((right - right.transpose()).norm(), tolerance);
  EXPECT_LE((plus.transpose() - inverse.plus_transposed).norm(), tolerance);
  EXPECT_EQ(inverse.rank, rank);
  return true;
}

template <int rows, int cols>
void expect_penrose_at_random(unsigned seed) {
  test::Generator generator(seed);
  int tried = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto full = test::random_matrix<rows, cols>(generator);
    const Vector<double, rows> b = test::random_vector<rows>(generator);
    const Vector<double, cols> c = test::random_vector<cols>(generator);
    tried += expect_penrose<rows, cols>(full, std::min(rows, cols)) ? 1 : 0;
    tried += expect_penrose<rows, cols>(b * c.transpose(), 1) ? 1 : 0;
  }
  EXPECT_GT(tried, kSamples);
}

TEST(PseudoInverseTest, TallMatrix) { expect_penrose_at_random<4, 2>(1); }
TEST(PseudoInverseTest, SquareMatrix) { expect_penrose_at_random<3, 3>(2); }
TEST(PseudoInverseTest, WideMatrix) { expect_penrose_at_random<2, 4>(3); }

TEST(PseudoInverseTest, OfZeroIsZero) {
  EXPECT_TRUE((expect_penrose<4, 2>(Matrix<double, 4, 2>::Zero(), 0)));
}

// diag(1, x): a direction that is small only by its scale is solved for with all digits.
TEST(PseudoInverseTest, SmallColumnsKeepTheirDigits) {
  for (const double x : {1e-3, 1e-8, 1e-14}) {
    Matrix<double, 2, 2> a;
    a << 1, 0, 0, x;
    const PseudoInverse<double, 2, 2> inverse(a);
    EXPECT_EQ(inverse.rank(), 2);
    EXPECT_NEAR(inverse.solve(Vector<double, 2>(3, 2 * x))[1], 2, 8 * kEps);
    EXPECT_NEAR(inverse.solve_transposed(Vector<double, 2>(3, 2))[1] * x, 2, 8 * kEps);
  }
  Matrix<double, 2, 2> a;
  a << 1, 0, 0, 0.1 * kEps;
  EXPECT_EQ((PseudoInverse<double, 2, 2>(a).rank()), 1);
}

TEST(PseudoInverseTest, NotANumberComesOut) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Matrix<double, 4, 2> a = Matrix<double, 4, 2>::Ones();
  a(1, 1) = kNan;
  const PseudoInverse<double, 4, 2> inverse(a);
  EXPECT_FALSE(inverse.solve(Vector<double, 4>(1, 1, 1, 1)).allFinite());
  EXPECT_FALSE(inverse.solve_transposed(Vector<double, 2>(1, 1)).allFinite());
}

TEST(PseudoInverseTest, LongDouble) {
  using T = long double;
  Matrix<T, 3, 2> a;
  a << T(1), T(2), T(3), T(4), T(5), T(7);
  const PseudoInverse<T, 3, 2> inverse(a);
  const Vector<T, 2> x(T(0.25), T(-3));
  const Vector<T, 2> back = inverse.solve(Vector<T, 3>(a * x));
  EXPECT_LE((back - x).norm(), 1000 * epsilon<T>());
}

}  // namespace
}  // namespace carnot::pseudo_inverse_test
