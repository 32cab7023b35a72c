#include "carnot/shooting/linear/banded_lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace carnot::internal::banded_lanes_test {
namespace {

// Of a solution, relative to the largest multiplier: elimination without exchanges.
constexpr double kSolved = 1e-12;

// A banded symmetric matrix for each lane, with a large diagonal: of one sign, or of both.
BandedLanes random_matrices(int size, int width, bool definite, std::mt19937& random) {
  std::normal_distribution<double> normal;
  BandedLanes a(size, width);
  for (int i = 0; i < size; ++i) {
    for (int j = i; j < std::min(size, i + width); ++j) {
      for (double& entry : a(i, j).at) {
        entry = normal(random);
        if (i == j) entry = 2 * width + std::abs(entry);
        if (i == j && !definite && i % 2 == 0) entry = -entry;
      }
    }
  }
  return a;
}

double entry(const BandedLanes& a, int width, int lane, int i, int j) {
  if (std::abs(i - j) >= width) return 0;
  return a(std::min(i, j), std::max(i, j)).at[lane];
}

// All widths that the compiler knows, and others; chains shorter than the band too.
TEST(BandedLanes, SolvesDefiniteAndIndefiniteSystems) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const bool definite : {true, false}) {
    for (const int width : {2, 3, 4, 6, 8, 10, 12, 14, 16, 18}) {
      for (const int size : {1, 5, 40}) {
        const BandedLanes a = random_matrices(size, width, definite, random);
        std::vector<Lanes> more(size);
        std::vector<Lanes> b(size);
        for (Lanes& x : more) x.at.fill(definite ? 0.5 : 0);
        for (Lanes& x : b) {
          for (double& value : x.at) value = normal(random);
        }
        BandedLanes factors(size, width);
        const Lanes positive(factors.factor(a, more));
        const Lanes largest(factors.largest_multiplier());
        std::vector<Lanes> x = b;
        factors.substitute(x);
        for (int l = 0; l < kLanes; ++l) {
          EXPECT_EQ(positive.at[l], definite ? 1 : 0);
          EXPECT_LT(largest.at[l], 1);  // the diagonal dominates
          for (int i = 0; i < size; ++i) {
            double sum = more[i].at[l] * x[i].at[l];
            for (int j = 0; j < size; ++j) sum += entry(a, width, l, i, j) * x[j].at[l];
            EXPECT_NEAR(sum, b[i].at[l], kSolved) << width << " " << size << " " << l;
          }
        }
      }
    }
  }
}

// A pivot that vanishes, or a number that is none, spoils its own lane only.
TEST(BandedLanes, KeepsToItsLane) {
  constexpr int kSize = 20;
  constexpr int kWidth = 6;
  std::mt19937 random(2);
  BandedLanes a = random_matrices(kSize, kWidth, true, random);
  const std::vector<Lanes> nothing(kSize);
  std::vector<Lanes> b(kSize);
  for (Lanes& x : b) x.at.fill(1);
  BandedLanes factors(kSize, kWidth);
  (void)factors.factor(a, nothing);
  std::vector<Lanes> before = b;
  factors.substitute(before);
  for (int j = 0; j < kWidth; ++j) a(0, j).at[2] = 0;
  a(7, 8).at[5] = std::nan("");
  const Lanes positive(factors.factor(a, nothing));
  const Lanes largest(factors.largest_multiplier());
  std::vector<Lanes> after = b;
  factors.substitute(after);
  for (int l = 0; l < kLanes; ++l) {
    const bool spoilt = l == 2 || l == 5;
    EXPECT_EQ(positive.at[l] > 0, !spoilt);
    EXPECT_EQ(largest.at[l] < 1, !spoilt);
    for (int i = 0; i < kSize && !spoilt; ++i) EXPECT_EQ(after[i].at[l], before[i].at[l]);
  }
}

TEST(BandedLanes, TakesTheChosenLanes) {
  std::mt19937 random(3);
  BandedLanes a = random_matrices(4, 2, true, random);
  const BandedLanes before = a;
  const BandedLanes other = random_matrices(4, 2, false, random);
  ChosenLanes chosen;
  chosen[1] = chosen[6] = true;
  a.take(chosen.mask(), other);
  for (int l = 0; l < kLanes; ++l) {
    const BandedLanes& expected = l == 1 || l == 6 ? other : before;
    for (int i = 0; i < 4; ++i) EXPECT_EQ(a(i, i).at[l], expected(i, i).at[l]);
  }
}

}  // namespace
}  // namespace carnot::internal::banded_lanes_test
