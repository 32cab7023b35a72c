// The equations of multiple shooting, and the two minimisers against each other.
#include "carnot/shooting/shoot/multiple_shooting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carnot/shooting/shoot/shooting_equations.h"
#include "shooting/problems.h"

namespace carnot::internal::multiple_shooting_test {
namespace {

// The extremal of the general problem of the parking reference, to a few digits.
const std::vector<double> kRoughP0{2.12, -0.274, 1.167, 1.378};

TEST(ShootingEquations, JacobianIsThatOfTheResidual) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  const Knots knots = knots_of(problem, kRoughP0, 2, 16);
  const ShootingEquations equations(problem, knots, {.steps = 16});
  constexpr int kSize = 8;
  constexpr double kStep = 1e-5;  // central differences: error kStep^2 times third derivatives
  constexpr double kTolerance = 1e-7;
  for (int i = 0; i < 2; ++i) {
    std::vector<double> z(knots.at(i), knots.at(i) + kSize);
    std::vector<double> plus(kSize), minus(kSize), residual(kSize), jacobian(kSize * kSize);
    const double* next = knots.at(i + 1);
    ASSERT_TRUE(equations.evaluate(i, z.data(), next, residual.data(), jacobian.data()));
    for (int j = 0; j < kSize; ++j) {
      std::vector<double> moved = z;
      moved[j] += kStep;
      ASSERT_TRUE(equations.evaluate(i, moved.data(), next, plus.data(), nullptr));
      moved[j] -= 2 * kStep;
      ASSERT_TRUE(equations.evaluate(i, moved.data(), next, minus.data(), nullptr));
      for (int row = 0; row < equations.residuals(i); ++row) {
        const double difference = (plus[row] - minus[row]) / (2 * kStep);
        EXPECT_NEAR(jacobian[row * kSize + j], difference, kTolerance);
      }
    }
  }
}

// Where momenta have scales of their own, one that is small everywhere has a small one, and one
// that vanishes has a hundredth of the largest. Elsewhere the largest is that of all.
TEST(ShootingEquations, MomentaHaveScalesOfTheirOwn) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  Knots knots = knots_of(problem, kRoughP0, 2, 16);
  const std::vector<double> largest{5, -0.25, 1, 0};
  for (int i = 0; i <= 2; ++i) {
    for (int j = 0; j < 4; ++j) knots.at(i)[4 + j] = largest[j] / (1 << i);
  }
  const ShootingEquations common(problem, knots, {.steps = 16});
  const ShootingEquations equations(problem, knots, {.steps = 16, .own_scales = true});
  const std::vector<double> scales{5, 0.25, 1, 0.05};
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(equations.scale(4 + j), scales[j]);
    EXPECT_EQ(common.scale(4 + j), 5);
    EXPECT_EQ(equations.scale(j), equations.scale(0));
  }
}

TEST(MultipleShooting, SegmentsAndMinimisersAgree) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  std::vector<std::vector<double>> found;
  for (const std::string& minimiser : names_of_minimisers()) {
    for (const int segments : {1, 2, 8}) {
      SCOPED_TRACE(minimiser + ", " + std::to_string(segments) + " segments");
      Knots knots = knots_of(problem, kRoughP0, segments, 32);
      ShootingOptions options;
      options.minimiser = minimiser;
      const Shooting result = shoot(problem, options, knots);
      EXPECT_TRUE(result.converged);
      EXPECT_LE(result.residual, options.tolerance);
      found.push_back(knots.p0());
    }
  }
  // The residual's tolerance, divided by the smallest singular value of dq/dp0, about 1e-2.
  constexpr double kTolerance = 1e-6;
  for (const auto& p0 : found) {
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(p0[j], found[0][j], kTolerance);
  }
}

TEST(MultipleShooting, EndsWithTheFlowOfTheLastKnot) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  Knots knots = knots_of(problem, kRoughP0, 4, 32);
  ASSERT_TRUE(shoot(problem, {}, knots).converged);
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(knots.at(4)[j], problem.to[j], 1e-8);
}

TEST(MultipleShooting, GivesUpWhereThereIsNothingNear) {
  const BoundaryValueProblem problem = test::sideways();
  for (const std::string& minimiser : names_of_minimisers()) {
    Knots knots = knots_of(problem, {1e3, -1e3, 1e3, 1e3}, 1, 32);
    ShootingOptions options;
    options.minimiser = minimiser;
    options.max_iterations = 3;
    EXPECT_FALSE(shoot(problem, options, knots).converged) << minimiser;
  }
}

// Every way joins the knots of an extremal that is known to a few digits.
// The first tangents of a flow are computed, all others fail.
struct FirstTangents {
  static inline decltype(FlowCalls::tangent_flow) call = nullptr;
  static inline int left = 0;

  template <class... A>
  static FlowReport flow(A... arguments) {
    FlowReport report = call(arguments...);
    if (left-- <= 0) report.status = FlowStatus::kStepFailed;
    return report;
  }
};

// Ceres would print an error there. What is joined by then is joined.
TEST(MultipleShooting, SaysNothingWhereDerivativesFailOnTheWay) {
  BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  FirstTangents::call = problem.dynamics.kernel.calls.tangent_flow;
  problem.dynamics.kernel.calls.tangent_flow = FirstTangents::flow;
  for (const int computed : {0, 2, 3, 5}) {
    SCOPED_TRACE(computed);
    const bool enough = computed == 5;  // two steps from a few digits
    Knots knots = knots_of(problem, kRoughP0, 2, 32);
    FirstTangents::left = computed;
    ShootingOptions options;
    options.minimiser = "ceres";
    testing::internal::CaptureStderr();
    const Shooting result = shoot(problem, options, knots);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(result.converged, enough);
    if (computed == 0) continue;
    EXPECT_EQ(result.residual <= options.tolerance, enough) << "it is not that of zeros";
  }
}

TEST(Shooting, EveryMinimiserArrives) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  for (const std::string& name : names_of_minimisers()) {
    Knots knots = knots_of(problem, kRoughP0, 4, 16);
    ShootingOptions options;
    options.minimiser = name;
    const Shooting shooting = shoot(problem, options, knots);
    EXPECT_TRUE(shooting.converged) << name << ' ' << shooting.residual;
    EXPECT_NEAR(knots.p0()[0], 2.1206609, 1e-6) << name;
  }
}

}  // namespace
}  // namespace carnot::internal::multiple_shooting_test
