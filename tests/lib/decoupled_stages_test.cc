// Stage equations with one Jacobian: what the small systems say holds in the large one.
#include "carnot/step/decoupled_stages.h"

#include <gtest/gtest.h>

#include <string>

#include "carnot/tableau/make_tableau.h"
#include "carnot/tableau/methods.h"
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
  using Columns = Eigen::Matrix<T, kSize, Eigen::Dynamic>;
  for (int sample = 0; sample < 20; ++sample) {
    const typename Decoupled<T>::Square jacobian =
        test::random_matrix<kSize, kSize>(generator, scale).template cast<T>();
    Columns rhs(kSize, s);
    for (int j = 0; j < s; ++j) rhs.col(j) = test::random_vector<kSize>(generator).cast<T>();
    ASSERT_TRUE(decoupled.factor(T(1), jacobian));
    Columns x = rhs;
    decoupled.solve(x.data());
    const Columns f = jacobian * x;
    Columns defect = x - rhs;
    for (int i = 0; i < s; ++i) {
      for (int j = 0; j < s; ++j) defect.col(i) -= tableau.mu(i, j) * tableau.b[j] * f.col(j);
    }
    const T size = x.cwiseAbs().maxCoeff() + f.cwiseAbs().maxCoeff();
    EXPECT_LE(double(defect.cwiseAbs().maxCoeff() / size), kAmplified * double(epsilon<T>()));
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
  ASSERT_TRUE(decoupled.factor(1, Decoupled<double>::Square::Zero()));
  test::Generator generator(8);
  const Matrix<double, kSize, 8> rhs = test::random_matrix<kSize, 8>(generator);
  Matrix<double, kSize, 8> x = rhs;
  decoupled.solve(x.data());
  EXPECT_LE((x - rhs).cwiseAbs().maxCoeff(), 64 * epsilon<double>());
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
  EXPECT_FALSE(decoupled.factor(2, Decoupled<double>::Square::Identity()));
}

}  // namespace
}  // namespace carnot::decoupled_stages_test
