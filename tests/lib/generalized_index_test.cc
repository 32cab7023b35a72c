// Generalized Hamiltonian scenes that are refused, and points where H_y = 0 cannot be solved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carnot/scenes/heisenberg.h"
#include "carnot/system/generalized_hamiltonian.h"
#include "carnot/system/velocity_constraints.h"
#include "testing/distance.h"
#include "testing/generalized_scenes.h"
#include "testing/order.h"

namespace carnot::generalized_index_test {
namespace {

using ::testing::HasSubstr;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class Scene>
std::string reason(const Scene& scene) {
  try {
    const GeneralizedHamiltonian<Scene> system(scene);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

// z = (q, p, y), H = p^2/2 + F(q, y).
struct OneVariable {
  enum class Kind {
    kSquare,      // y^2/2 - q y
    kOtherUnits,  // the same with a y of 1e10 times the size
    kFarAway,     // not a number but for y > 3, where no test point is
    kFold,        // H_y = y^2 - q: two branches for q > 0 that meet at q = 0, none for q < 0
    kFading,      // H_yy = q
    kDriven       // H = q p + y^2/2 - q y instead: q' = q whatever p is
  };
  static constexpr int kSize = 3;
  static constexpr int kDof = 1;

  Kind kind = Kind::kSquare;
  Matrix<double, 3, 3> j = test::canonical(3, 1);

  template <class T>
  [[nodiscard]] T hamiltonian(const Vector<T, 3>& z) const {
    const T driven = z[0] * z[1];
    const T kinetic = constant<T>(0.5) * z[1] * z[1];
    return (kind == Kind::kDriven ? driven : kinetic) + algebraic(z[0], z[2]);
  }
  [[nodiscard]] Matrix<double, 3, 3> structure_matrix() const { return j; }

 private:
  template <class T>
  [[nodiscard]] T algebraic(const T& q, const T& y) const {
    using std::log;
    if (kind == Kind::kOtherUnits) return constant<T>(5e-21) * y * y - constant<T>(1e-10) * q * y;
    if (kind == Kind::kFarAway) return y * log(y - constant<T>(3)) - q * y;
    if (kind == Kind::kFold) return y * y * y / constant<T>(3) - q * y;
    if (kind == Kind::kFading) return constant<T>(0.5) * q * y * y - y;
    return constant<T>(0.5) * y * y - q * y;
  }
};

// z = (q, p, y1, y2), H = p^2/2 + q (y1 - y2) + F(y1, y2).
struct TwoVariables {
  enum class Kind { kSumOnly, kOneOnly, kProduct };
  static constexpr int kSize = 4;
  static constexpr int kDof = 1;

  Kind kind = Kind::kProduct;
  double scale = 1;

  template <class T>
  [[nodiscard]] T hamiltonian(const Vector<T, 4>& z) const {
    const T half = constant<T>(0.5);
    const T sum = z[2] + z[3];
    T kernel = z[2] * z[3];
    if (kind == Kind::kSumOnly) kernel = half * sum * sum;
    if (kind == Kind::kOneOnly) kernel = half * z[2] * z[2];
    return half * z[1] * z[1] + z[0] * (z[2] - z[3]) + kernel;
  }
  [[nodiscard]] Matrix<double, 4, 4> structure_matrix() const { return test::canonical(4, 1); }
  // Right for a scale of 1 only.
  [[nodiscard]] Matrix<double, 4, 4> darboux_basis() const {
    return diagonal<double>(scale, scale, scale, scale);
  }
};

TEST(GeneralizedIndexTest, RefusesStructureMatricesWithAReason) {
  OneVariable scene;
  EXPECT_EQ(reason(scene), "accepted");
  scene.j = filled<3, 3>(0.0);
  EXPECT_THAT(reason(scene), HasSubstr("purely algebraic"));
  scene.j(0, 2) = kNan;
  EXPECT_THAT(reason(scene), HasSubstr("not finite"));
  scene.j = identity<3, double>();
  EXPECT_THAT(reason(scene), HasSubstr("not antisymmetric"));
}

TEST(GeneralizedIndexTest, RefusesWhatTheSceneSaysOfItselfWrongly) {
  EXPECT_EQ(reason(TwoVariables{}), "accepted");
  const TwoVariables wrong_basis{TwoVariables::Kind::kProduct, 2};
  EXPECT_THAT(reason(wrong_basis), HasSubstr("does not bring J to Darboux form"));
  // A singular A: A'J A has lost a pair.
  test::InBasis<test::LambdaH> scene{{}, identity<5, double>()};
  scene.basis(1, 1) = 0;
  EXPECT_THAT(reason(scene), HasSubstr("has rank 2 where the scene declares 4"));
}

// lambda h(q), in its own coordinates and in others, where H_yy = 0 to round-off only.
TEST(GeneralizedIndexTest, RefusesHolonomicConstraintsAsMultipliers) {
  test::InBasis<test::LambdaH> scene{{}, identity<5, double>()};
  EXPECT_THAT(reason(scene), HasSubstr("index higher than 1"));
  for (unsigned seed = 1; seed <= 20; ++seed) {
    scene = test::in_random_basis(test::LambdaH{}, seed);
    EXPECT_THAT(reason(scene), HasSubstr("lambda h(q)")) << seed;
  }
}

TEST(GeneralizedIndexTest, LooksAtTheWholeKernelAtOnce) {
  EXPECT_THAT(reason(TwoVariables{TwoVariables::Kind::kSumOnly}), HasSubstr("index higher than 1"));
  EXPECT_THAT(reason(TwoVariables{TwoVariables::Kind::kOneOnly}), HasSubstr("index higher than 1"));
  // Regular, though linear in each of the two.
  EXPECT_EQ(reason(TwoVariables{TwoVariables::Kind::kProduct}), "accepted");
}

TEST(GeneralizedIndexTest, AcceptsOtherUnitsAndWhatItCannotJudge) {
  EXPECT_EQ(reason(OneVariable{OneVariable::Kind::kOtherUnits}), "accepted");
  EXPECT_EQ(reason(OneVariable{OneVariable::Kind::kFarAway}), "accepted");
}

TEST(GeneralizedIndexTest, BranchesAndTheirEnd) {
  using One = Vector<double, 1>;
  const GeneralizedHamiltonian<OneVariable> system({OneVariable::Kind::kFold});
  Rate<double, 1> rate;
  One y;
  for (const double sign : {1.0, -1.0}) {
    ASSERT_EQ(system.branch(0, One(4), One(0), One(3 * sign), y), RateStatus::kOk);
    EXPECT_NEAR(y[0], 2 * sign, 4 * kEps);
    y[0] *= 1.1;
    ASSERT_EQ(system.rate(0.0, One(4), One(5), y, rate), RateStatus::kOk);
    EXPECT_NEAR(y[0], 2 * sign, 4 * kEps);
    EXPECT_NEAR(rate.q_dot[0], 5, 8 * kEps);
    EXPECT_NEAR(rate.p_dot[0], y[0], 8 * kEps);  // -H_q = y
    EXPECT_NEAR(system.regularity(0, One(4), One(0), y).determinant, 4 * sign, 8 * kEps);
  }
  y[0] = 0.5;
  EXPECT_EQ(system.rate(0.0, One(-1), One(0), y, rate), RateStatus::kNoSolution);
  EXPECT_EQ(y[0], 0.5) << "unchanged";
  EXPECT_EQ(system.rate(0.0, One(kNan), One(0), y, rate), RateStatus::kNotFinite);
  EXPECT_EQ(system.regularity(0, One(0), One(0), One(0)).determinant, 0);
}

// Index 1 at q = 1, not at q = 0.
TEST(GeneralizedIndexTest, RateNamesAHigherIndexAtAPoint) {
  using One = Vector<double, 1>;
  const GeneralizedHamiltonian<OneVariable> system({OneVariable::Kind::kFading});
  Rate<double, 1> rate;
  One y(0);
  EXPECT_EQ(system.rate(0.0, One(1), One(0), y, rate), RateStatus::kOk);
  EXPECT_NEAR(y[0], 1, kEps);
  EXPECT_EQ(system.rate(0.0, One(0), One(0), y, rate), RateStatus::kNotIndexOne);
  y[0] = 0;
  EXPECT_EQ(system.rate(0.0, One(0), One(0), y, rate), RateStatus::kNotIndexOne);
  EXPECT_TRUE(std::isinf(system.regularity(0, One(0), One(0), y).condition));
}

// Why lambda h(q) is refused: the paper's midpoint rule on the unit circle, from q = (1, 0) with
// p = (0, 1), where the exact solution is q = (cos t, sin t) and lambda = 1.
struct CircleRun {
  double q_error = 0;
  double p_error = 0;
  double first_lambda = 0;
  double largest_lambda = 0;
};

CircleRun midpoint_on_the_circle(int steps) {
  const test::LambdaH scene;
  CircleRun run;
  Vector<double, 5> z{{1, 0, 0, 1, 1}};
  for (int i = 0; i < steps; ++i) {
    const test::NaiveMidpoint<test::LambdaH> step(scene, 1.0 / steps, z);
    EXPECT_LE(step.residual, 1e3 * kEps);
    EXPECT_NEAR(std::hypot(step.middle[0], step.middle[1]), 1, 1e3 * kEps)
        << "h = 0 at the midpoint";
    if (i == 0) run.first_lambda = step.middle[4];
    run.largest_lambda = std::max(run.largest_lambda, std::abs(step.middle[4]));
    store(part<0, 4>(step.end), z.data());
    z[4] = step.middle[4];
  }
  const double cosine = std::cos(1);
  const double sine = std::sin(1);
  run.q_error = std::hypot(z[0] - cosine, z[1] - sine);
  run.p_error = std::hypot(z[2] + sine, z[3] - cosine);
  return run;
}

TEST(GeneralizedIndexTest, MidpointRuleDoesNotConvergeAtHigherIndex) {
  std::vector<double> h;
  std::vector<double> p_error;
  std::vector<double> lambda;
  for (const int steps : {20, 40, 80, 160}) {
    const CircleRun run = midpoint_on_the_circle(steps);
    h.push_back(1.0 / steps);
    p_error.push_back(run.p_error);
    lambda.push_back(run.largest_lambda);
    EXPECT_LE(run.q_error, 1.0 / (steps * steps)) << "the configuration converges";
    EXPECT_NEAR(run.first_lambda, 0.5, 1.0 / steps) << "half of what it should be";
    EXPECT_GT(run.p_error, 0.5) << "the momentum does not";
  }
  constexpr double kAll = 1e9;
  EXPECT_NEAR(test::fit_order(h, p_error, 0, kAll).slope, 0, 0.05);
  EXPECT_NEAR(test::fit_order(h, lambda, 0, kAll).slope, -1, 0.05) << "lambda grows like 1/h";
}

// "From all (q, p)": off the circle there is no solution, but there is a step, with a lambda near
// 4 (r - 1) / h^2 that pulls the midpoint on the circle.
TEST(GeneralizedIndexTest, MidpointRuleAtHigherIndexTakesEveryStart) {
  constexpr double kStep = 0.01;
  for (const double radius : {0.9, 1.1, 2.0}) {
    const Vector<double, 5> z{{radius, 0, 0, 1, 1}};
    const test::NaiveMidpoint<test::LambdaH> step(test::LambdaH{}, kStep, z);
    EXPECT_NEAR(std::hypot(step.middle[0], step.middle[1]), 1, 1e3 * kEps);
    EXPECT_NEAR(step.middle[4] * kStep * kStep / (4 * (radius - 1)), 1, 0.01);
  }
}

// p = M v - G'lambda from v and lambda, and |G v| / |v| for a v that the constraints forbid.
TEST(GeneralizedIndexTest, MomentumOfAConstrainedVelocity) {
  const VelocityConstraints<scenes::Heisenberg> reference({});
  const GeneralizedHamiltonian<test::AsGeneralized<scenes::Heisenberg>> system({});
  test::Generator generator(1);
  for (int sample = 0; sample < 20; ++sample) {
    const auto q = test::random_vector<3>(generator);
    const auto lambda = test::random_vector<1>(generator);
    Vector<double, 3> v = product(reference.scene().frame(q), test::random_vector<2>(generator));
    const Vector<double, 3> wanted = v;
    Vector<double, 3> p;
    EXPECT_LE(system.admissible_momentum(0, q, v, lambda, p), 100 * kEps);
    EXPECT_LE(test::distance(v, wanted), 100 * kEps);
    EXPECT_LE(test::distance(p, reference.momentum(q, v, lambda)), 100 * kEps);

    const auto forbidden = test::random_vector<3>(generator);
    v = forbidden;
    const double violated = system.admissible_momentum(0, q, v, lambda, p);
    const double expected = test::norm(reference.constraint(q, forbidden)) / test::norm(forbidden);
    EXPECT_NEAR(violated, expected, 100 * kEps);
    EXPECT_LE(test::norm(reference.constraint(q, v)), 100 * kEps) << "v has become admissible";
  }
}

TEST(GeneralizedIndexTest, VelocityWithoutAMomentum) {
  const GeneralizedHamiltonian<OneVariable> system({OneVariable::Kind::kDriven});
  Vector<double, 1> v(2);
  Vector<double, 1> p;
  const Vector<double, 1> one(1);
  EXPECT_TRUE(std::isnan(system.admissible_momentum(0, one, v, one, p)));
  EXPECT_TRUE(std::isnan(v[0]));
}

}  // namespace
}  // namespace carnot::generalized_index_test
