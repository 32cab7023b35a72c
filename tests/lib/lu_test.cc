// Gaussian elimination of any size, by its residuals.
#include "carnot/numerics/lu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace carnot::lu_test {
namespace {

template <class T>
constexpr T kEps = std::numeric_limits<T>::epsilon();

template <class T>
std::vector<T> random_numbers(int count, std::mt19937& generator) {
  std::normal_distribution<double> normal;
  std::vector<T> numbers(count);
  for (T& x : numbers) x = T(normal(generator));
  return numbers;
}

// The largest entry of b - a x.
template <class T>
T residual(int size,
           const std::vector<T>& a,
           int columns,
           const std::vector<T>& b,
           const std::vector<T>& x) {
  T largest(0);
  for (int i = 0; i < size; ++i) {
    for (int c = 0; c < columns; ++c) {
      T sum = b[i * columns + c];
      for (int j = 0; j < size; ++j) sum -= a[i * size + j] * x[j * columns + c];
      largest = std::max(largest, std::abs(sum));
    }
  }
  return largest;
}

// Random entries need pivots. Residuals of elimination with partial pivoting are round-off of
// entries times solutions, times growth, which is about size^(2/3) on random matrices.
template <class T>
void expect_solved(int size, int columns, std::mt19937& generator) {
  const std::vector<T> a = random_numbers<T>(size * size, generator);
  const std::vector<T> b = random_numbers<T>(size * columns, generator);
  std::vector<T> factors = a;
  std::vector<T> x = b;
  ASSERT_TRUE(lu_solve(size, factors.data(), columns, x.data())) << size;
  T largest(1);
  for (const T& entry : x) largest = std::max(largest, std::abs(entry));
  EXPECT_LE(residual(size, a, columns, b, x), T(4 * size * size) * kEps<T> * largest)
      << size << ' ' << columns;
}

// Sizes below, at and above whole pieces, as many right-hand sides.
TEST(Lu, SolvesSystemsOfAnySize) {
  std::mt19937 generator(1);
  for (int size = 1; size <= 34; ++size) {
    for (const int columns : {1, 3, 8, 11}) {
      expect_solved<double>(size, columns, generator);
      expect_solved<long double>(size, columns, generator);
    }
  }
  for (const int size : {48, 63, 64, 65, 80}) expect_solved<double>(size, 1, generator);
}

// Zeros on the diagonal, in every piece.
TEST(Lu, LooksForPivots) {
  constexpr int kSize = 20;
  std::vector<double> shift(kSize * kSize);
  std::vector<double> x(kSize);
  for (int i = 0; i < kSize; ++i) {
    shift[i * kSize + (i + 7) % kSize] = 1;
    x[i] = (i + 7) % kSize;
  }
  ASSERT_TRUE(lu_solve(kSize, shift.data(), 1, x.data()));
  for (int i = 0; i < kSize; ++i) EXPECT_EQ(x[i], i);
}

TEST(Lu, SaysWhatIsSingular) {
  for (const int size : {3, 8, 21}) {
    std::vector<double> a(size * size);
    std::vector<double> b(size, 1.0);
    for (int i = 0; i + 1 < size; ++i) a[i * size + i] = 1;
    std::vector<double> factors = a;
    EXPECT_FALSE(lu_solve(size, factors.data(), 1, b.data())) << size;
    a[size * size - 1] = std::nan("");
    EXPECT_FALSE(lu_solve(size, a.data(), 1, b.data())) << size;
  }
}

}  // namespace
}  // namespace carnot::lu_test
