#include "carnot/shooting/linear/chain_least_squares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <vector>

namespace carnot::internal::chain_least_squares_test {
namespace {

constexpr double kTight = 1e-12;
constexpr double kDamped = 1e-9;  // the damping holds a linear problem back by 1e-12, repeatedly
// A cost that round-off changes by eps says where it is least to sqrt(eps) only; slopes of 100.
constexpr double kFlat = 100 * 1.5e-8;

constexpr double kFree = 1e12;  // radius: hardly damped

// Stops where nothing changes any more.
ChainOptions to_the_end() {
  ChainOptions options;
  options.max_iterations = 200;
  options.function_tolerance = options.gradient_tolerance = 0;
  options.step_tolerance = kTight;
  return options;
}

// Minimises chains whose residuals of one interval are f(i, x, residual, jacobian), as many side by
// side as there are lanes. Returns the iterations of each.
template <class F>
std::vector<int> minimise(const F& f,
                          int residuals,
                          int n,
                          const ChainOptions& options,
                          std::vector<std::vector<double>*> chains) {
  const auto side_by_side = [&](int i, const double* nodes, double* residual, double* jacobian) {
    std::vector<double> x(2 * n);
    std::vector<double> own(residuals);
    std::vector<double> slopes(residuals * 2 * n);
    for (int l = 0; l < kChainLanes; ++l) {
      for (int j = 0; j < 2 * n; ++j) x[j] = nodes[j * kChainLanes + l];
      if (!f(i, x.data(), own.data(), slopes.data())) {
        std::fill(own.begin(), own.end(), std::numeric_limits<double>::quiet_NaN());
      }
      for (int j = 0; j < residuals; ++j) residual[j * kChainLanes + l] = own[j];
      for (int j = 0; j < residuals * 2 * n; ++j) jacobian[j * kChainLanes + l] = slopes[j];
    }
  };
  std::vector<int> iterations(chains.size());
  std::array<int, kChainLanes> at;
  at.fill(-1);
  int waiting = 0;
  const auto next = [&](int lane, int count, std::vector<double>& nodes) -> double {
    if (at[lane] >= 0) {
      *chains[at[lane]] = nodes;
      iterations[at[lane]] = count;
    }
    at[lane] = waiting < std::ssize(chains) ? waiting++ : -1;
    if (at[lane] < 0) return 0;
    nodes = *chains[at[lane]];
    return kFree;
  };
  const int intervals = static_cast<int>(chains.front()->size()) / n - 1;
  minimise_chains(side_by_side, {intervals, n, residuals}, options, next);
  return iterations;
}
// The same for one chain.
template <class F>
int minimise(
    const F& f, int residuals, int n, const ChainOptions& options, std::vector<double>& x) {
  return minimise(f, residuals, n, options, std::vector<std::vector<double>*>{&x})[0];
}

// sum |x_{i+1} - x_i|^2: equidistant points on the line between the ends.
bool stretched(int /*i*/, const double* x, double* residual, double* jacobian) {
  for (int j = 0; j < 2; ++j) residual[j] = x[2 + j] - x[j];
  if (jacobian == nullptr) return true;
  const double derivative[] = {-1, 0, 1, 0, 0, -1, 0, 1};
  std::copy(std::begin(derivative), std::end(derivative), jacobian);
  return true;
}

TEST(ChainLeastSquares, SolvesALinearProblem) {
  std::vector<double> x{1, -2, 7, 7, 0, 3, -5, 1, 9, 2};
  EXPECT_GT(minimise(stretched, 2, 2, to_the_end(), x), 0);
  for (int i = 0; i <= 4; ++i) {
    EXPECT_NEAR(x[2 * i], 1 + 2 * i, kDamped);
    EXPECT_NEAR(x[2 * i + 1], -2 + i, kDamped);
  }
}

// All widths of the band, those that the compiler knows and others.
TEST(ChainLeastSquares, SolvesChainsOfEveryLengthAndWidth) {
  for (const int n : {1, 2, 3, 4, 5, 6, 7}) {
    const auto straight = [n](int, const double* x, double* residual, double* jacobian) {
      for (int j = 0; j < n; ++j) residual[j] = (j + 1) * (x[n + j] - x[j]);
      if (jacobian == nullptr) return true;
      std::fill_n(jacobian, n * 2 * n, 0.0);
      for (int j = 0; j < n; ++j) {
        jacobian[j * 2 * n + j] = -(j + 1);
        jacobian[j * 2 * n + n + j] = j + 1;
      }
      return true;
    };
    for (const int intervals : {2, 7, 8, 9, 16, 21}) {
      std::vector<double> x(static_cast<std::size_t>((intervals + 1) * n), 0.5);
      for (int j = 0; j < n; ++j) {
        x[j] = j;
        x[intervals * n + j] = j - intervals;
      }
      EXPECT_GT(minimise(straight, n, n, to_the_end(), x), 0);
      for (int i = 0; i <= intervals; ++i) {
        for (int j = 0; j < n; ++j) EXPECT_NEAR(x[i * n + j], j - i, intervals * kDamped);
      }
    }
  }
}

// A free number of an end follows its neighbours: all points are at the height of the other end, or
// where the residual r = x - 3 of the last interval pulls them.
TEST(ChainLeastSquares, MovesWhatIsFreeOfTheEnds) {
  std::vector<double> x{1, -2, 7, 7, 0, 3, -5, 1, 9, 2};
  ChainOptions options = to_the_end();
  options.free_first = {false, true};
  EXPECT_GT(minimise(stretched, 2, 2, options, x), 0);
  for (int i = 0; i <= 4; ++i) {
    EXPECT_NEAR(x[2 * i], 1 + 2 * i, kDamped);
    EXPECT_NEAR(x[2 * i + 1], 2, kDamped);
  }
  const auto pulled = [](int i, const double* at, double* residual, double* jacobian) {
    residual[0] = at[1] - at[0];
    residual[1] = i == 2 ? at[1] - 3 : 0;
    if (jacobian == nullptr) return true;
    const double derivative[] = {-1, 1, 0, i == 2 ? 1.0 : 0.0};
    std::copy(std::begin(derivative), std::end(derivative), jacobian);
    return true;
  };
  std::vector<double> line{0, 5, 5, 5};
  options.free_first = {};
  options.free_last = {true};
  EXPECT_GT(minimise(pulled, 2, 1, options, line), 0);
  // Three springs from 0 to x and one from x to 3: x / 3 = 3 - x.
  for (int i = 0; i <= 3; ++i) EXPECT_NEAR(line[i], 0.75 * i, kDamped);
}

// Residuals x_{i+1} - x_i and c (x_i^2 - 1), which are not linear.
double cost_of(const std::vector<double>& x, std::vector<double>* slope) {
  double sum = 0;
  if (slope != nullptr) slope->assign(x.size(), 0.0);
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double rise = x[i + 1] - x[i];
    const double bent = 2 * (x[i] * x[i] - 1);
    sum += 0.5 * (rise * rise + bent * bent);
    if (slope == nullptr) continue;
    (*slope)[i] += -rise + bent * 4 * x[i];
    (*slope)[i + 1] += rise;
  }
  return sum;
}

bool bent(int /*i*/, const double* x, double* residual, double* jacobian) {
  residual[0] = x[1] - x[0];
  residual[1] = 2 * (x[0] * x[0] - 1);
  if (jacobian == nullptr) return true;
  jacobian[0] = -1;
  jacobian[1] = 1;
  jacobian[2] = 4 * x[0];
  jacobian[3] = 0;
  return true;
}

TEST(ChainLeastSquares, EndsWhereTheGradientVanishesAndNeverRises) {
  ChainOptions one = to_the_end();
  one.max_iterations = 1;
  std::vector<double> x{-2, 0.3, 5, -4, 0.1, 2};
  double cost = cost_of(x, nullptr);
  constexpr int kIterations = 100;
  for (int i = 0; i < kIterations; ++i) {
    minimise(bent, 2, 1, one, x);
    const double next = cost_of(x, nullptr);
    EXPECT_LE(next, cost);
    cost = next;
  }
  minimise(bent, 2, 1, to_the_end(), x);
  std::vector<double> slope;
  cost_of(x, &slope);
  for (std::size_t i = 1; i + 1 < x.size(); ++i) EXPECT_NEAR(slope[i], 0, kFlat);
  EXPECT_EQ(x.front(), -2);
  EXPECT_EQ(x.back(), 2);
}

// More chains than lanes, which take different numbers of iterations: each becomes what it becomes
// alone, to the last bit. One of them has no residuals.
TEST(ChainLeastSquares, MinimisesEachChainAsIfItWereAlone) {
  constexpr int kChains = 2 * kChainLanes + 3;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> together(kChains, std::vector<double>(6));
  for (std::vector<double>& x : together) {
    for (double& value : x) value = 3 * normal(random);
  }
  together[4][2] = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::vector<double>> alone = together;
  std::vector<std::vector<double>*> all;
  for (std::vector<double>& x : together) all.push_back(&x);
  const std::vector<int> iterations = minimise(bent, 2, 1, to_the_end(), all);
  for (int c = 0; c < kChains; ++c) {
    EXPECT_EQ(minimise(bent, 2, 1, to_the_end(), alone[c]), iterations[c]);
    EXPECT_EQ(iterations[c] > 0, c != 4);
    if (c != 4) {
      EXPECT_EQ(together[c], alone[c]);
    }
  }
}

TEST(ChainLeastSquares, DoesNothingWhereThereIsNothingToDo) {
  std::vector<double> ends{1, 2, 3, 4};
  EXPECT_EQ(minimise(stretched, 2, 2, {}, ends), 0);
  std::vector<double> tight{0, 0, 1, 1, 2, 2};
  EXPECT_EQ(minimise(stretched, 2, 2, {}, tight), 0);
}

// Residuals that do not exist everywhere: the path stays where they do.
TEST(ChainLeastSquares, KeepsWithinWhereTheResidualsExist) {
  const auto none = [](int, const double*, double*, double*) { return false; };
  std::vector<double> x{0, 1, 2.5};
  EXPECT_EQ(minimise(none, 1, 1, {}, x), 0);
  EXPECT_EQ(x[1], 1);
  const auto logarithms = [](int, const double* at, double* residual, double* jacobian) {
    if (!(at[0] > 0 && at[1] > 0)) return false;
    residual[0] = std::log(at[1] / at[0]);
    if (jacobian != nullptr) jacobian[0] = -1 / at[0], jacobian[1] = 1 / at[1];
    return true;
  };
  std::vector<double> far{1, 1000, 4};
  minimise(logarithms, 1, 1, to_the_end(), far);
  EXPECT_NEAR(far[1], 2, kFlat);  // the geometric mean
}

}  // namespace
}  // namespace carnot::internal::chain_least_squares_test
