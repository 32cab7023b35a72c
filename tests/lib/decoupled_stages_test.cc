// Stage equations with one Jacobian: what the small systems say holds in the large one.
#include "carnot/step/decoupled_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "carnot/tableau/make_tableau.h"
#include "carnot/tableau/methods.h"
#include "testing/distance.h"
#include "testing/random_points.h"

namespace carnot::decoupled_stages_test {
namespace {

constexpr int kSize = 6;

template <class T>
using Decoupled = DecoupledStages<T, kSize, kMostCoupledStages>;

// |X - h J X A' - R| over what rounds there: the condition of the small systems is below 1e3 for
// Jacobians of this size.
template <class T>
void expect_solved(const Tableau<T>& tableau, double scale) {
  constexpr int kAmplified = 1000;
  test::Generator generator(7);
  Decoupled<T> decoupled;
  ASSERT_TRUE(decoupled.set_method(tableau));
  const int s = tableau.stages();
  using Columns = std::vector<Vector<T, kSize>>;
  for (int sample = 0; sample < 20; ++sample) {
    const auto random = test::random_matrix<kSize, kSize>(generator, scale);
    typename Decoupled<T>::Square jacobian;
    std::copy_n(random.data(), kSize * kSize, jacobian.data());
    Columns rhs(s);
    for (auto& column : rhs) {
      const auto numbers = test::random_vector<kSize>(generator);
      std::copy_n(numbers.data(), kSize, column.data());
    }
    ASSERT_TRUE(decoupled.factor(T(1), jacobian));
    Columns x = rhs;
    decoupled.solve(x[0].data());
    Columns f;
    for (const auto& column : x) f.push_back(product(jacobian, column));
    T defect(0), size_of_x(0), size_of_f(0);
    for (int i = 0; i < s; ++i) {
      Vector<T, kSize> rest = x[i];
      subtract_from(rest, rhs[i]);
      for (int j = 0; j < s; ++j) {
        for (int r = 0; r < kSize; ++r) rest[r] -= tableau.mu(i, j) * tableau.b[j] * f[j][r];
      }
      defect = maximum(defect, largest_entry(rest));
      size_of_x = maximum(size_of_x, largest_entry(x[i]));
      size_of_f = maximum(size_of_f, largest_entry(f[i]));
    }
    EXPECT_LE(double(defect / (size_of_x + size_of_f)), kAmplified * double(epsilon<T>()));
  }
}

class DecoupledStagesTest : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(
    Gauss,
    DecoupledStagesTest,
    ::testing::Values("midpoint", "gauss4", "gauss6", "gauss8", "gauss12", "gauss16", "gauss24"),
    [](const auto& method) { return std::string(method.param); });

TEST_P(DecoupledStagesTest, SolveTheWholeSystem) {
  const Tableau<double> tableau = make_tableau(*find_method(GetParam()));
  for (const double scale : {0.01, 1.0, 10.0}) expect_solved(tableau, scale);
}

TEST(DecoupledStagesTest, InLongDouble) { expect_solved(gauss_tableau<long double>(5), 1); }

// h J = 0: X = R, to the last digits of the change of basis.
TEST(DecoupledStagesTest, NothingToSolve) {
  const Tableau<double> tableau = gauss_tableau<double>(8);
  Decoupled<double> decoupled;
  ASSERT_TRUE(decoupled.set_method(tableau));
  ASSERT_TRUE(decoupled.factor(1, filled<kSize, kSize>(0.0)));
  test::Generator generator(8);
  const Matrix<double, kSize, 8> rhs = test::random_matrix<kSize, 8>(generator);
  Matrix<double, kSize, 8> x = rhs;
  decoupled.solve(x.data());
  EXPECT_LE(test::largest_change(x, rhs), 64 * epsilon<double>());
}

// Radau is neither symplectic nor symmetric, the Lobatto pair is partitioned.
TEST(DecoupledStagesTest, NotForEveryMethod) {
  for (const char* name : {"radau5", "lobatto4"}) {
    Decoupled<double> decoupled;
    EXPECT_FALSE(decoupled.set_method(make_tableau(*find_method(name)))) << name;
  }
}

TEST(DecoupledStagesTest, TellsOfSingularSystems) {
  const Tableau<double> tableau = gauss_tableau<double>(1);
  Decoupled<double> decoupled;
  ASSERT_TRUE(decoupled.set_method(tableau));
  // The midpoint rule: I - h J / 2.
  EXPECT_FALSE(decoupled.factor(2, identity<kSize, double>()));
}

}  // namespace
}  // namespace carnot::decoupled_stages_test
