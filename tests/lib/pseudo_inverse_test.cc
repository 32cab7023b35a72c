#include "carnot/numerics/pseudo_inverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "testing/distance.h"
#include "testing/random_points.h"

namespace carnot::pseudo_inverse_test {
namespace {

using test::distance;
using test::norm;
using test::transposed;

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
      Vector<double, rows> unit = filled<rows>(0.0);
      unit[i] = 1;
      store(inverse.solve(unit), plus.data() + i * cols);
    }
    for (int j = 0; j < cols; ++j) {
      Vector<double, cols> unit = filled<cols>(0.0);
      unit[j] = 1;
      store(inverse.solve_transposed(unit), plus_transposed.data() + j * rows);
    }
    rank = inverse.rank();
  }
};

// The four identities of Penrose determine the pseudo-inverse. False for a sample left out.
template <int rows, int cols>
bool expect_penrose(const Matrix<double, rows, cols>& a, int rank) {
  const Inverse<rows, cols> inverse(a);
  const auto& plus = inverse.plus;
  const double size = norm(plus);
  if (size > 1 / kWellConditioned) return false;
  const double tolerance = kRoundOff * std::max(1.0, size * size);
  const Matrix<double, rows, rows> left = product(a, plus);
  const Matrix<double, cols, cols> right = product(plus, a);
  EXPECT_LE(distance(product(left, a), a), tolerance);
  EXPECT_LE(distance(product(right, plus), plus), tolerance);
  EXPECT_LE(distance(left, transposed(left)), tolerance);
  EXPECT_LE(distance(right, transposed(right)), tolerance);
  EXPECT_LE(distance(transposed(plus), inverse.plus_transposed), tolerance);
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
    tried += expect_penrose<rows, cols>(times_transposed(b, c), 1) ? 1 : 0;
  }
  EXPECT_GT(tried, kSamples);
}

TEST(PseudoInverseTest, TallMatrix) { expect_penrose_at_random<4, 2>(1); }
TEST(PseudoInverseTest, SquareMatrix) { expect_penrose_at_random<3, 3>(2); }
TEST(PseudoInverseTest, WideMatrix) { expect_penrose_at_random<2, 4>(3); }

TEST(PseudoInverseTest, OfZeroIsZero) { EXPECT_TRUE((expect_penrose<4, 2>(filled<4, 2>(0.0), 0))); }

// diag(1, x): a direction that is small only by its scale is solved for with all digits.
TEST(PseudoInverseTest, SmallColumnsKeepTheirDigits) {
  for (const double x : {1e-3, 1e-8, 1e-14}) {
    const Matrix<double, 2, 2> a = diagonal<double>(1, x);
    const PseudoInverse<double, 2, 2> inverse(a);
    EXPECT_EQ(inverse.rank(), 2);
    EXPECT_NEAR(inverse.solve(Vector<double, 2>(3, 2 * x))[1], 2, 8 * kEps);
    EXPECT_NEAR(inverse.solve_transposed(Vector<double, 2>(3, 2))[1] * x, 2, 8 * kEps);
  }
  const Matrix<double, 2, 2> a = diagonal<double>(1, 0.1 * kEps);
  EXPECT_EQ((PseudoInverse<double, 2, 2>(a).rank()), 1);
}

TEST(PseudoInverseTest, NotANumberComesOut) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Matrix<double, 4, 2> a = filled<4, 2>(1.0);
  a(1, 1) = kNan;
  const PseudoInverse<double, 4, 2> inverse(a);
  EXPECT_FALSE(all_finite(inverse.solve(Vector<double, 4>(1, 1, 1, 1))));
  EXPECT_FALSE(all_finite(inverse.solve_transposed(Vector<double, 2>(1, 1))));
}

TEST(PseudoInverseTest, LongDouble) {
  using T = long double;
  const Matrix<T, 3, 2> a{{T(1), T(2)}, {T(3), T(4)}, {T(5), T(7)}};
  const PseudoInverse<T, 3, 2> inverse(a);
  const Vector<T, 2> x(T(0.25), T(-3));
  const Vector<T, 2> back = inverse.solve(product(a, x));
  EXPECT_LE(distance(back, x), 1000 * epsilon<T>());
}

}  // namespace
}  // namespace carnot::pseudo_inverse_test
