#include "carnot/shooting/field/packed_tangents.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "carnot/shooting/field/field_newton.h"
#include "shooting/problems.h"

namespace carnot::internal::packed_tangents_test {
namespace {

// Two extremals side by side, each against the tangent flow of Gauss.
void expect_tangents_of_flows(const BoundaryValueProblem& problem,
                              const std::array<SmallVector, 2>& p0) {
  constexpr double kCoarse = 1e-4;  // of the largest entry
  const int n = problem.dynamics.dof;
  ASSERT_TRUE(has_packs(problem.dynamics));
  const std::vector<PackedTangent> tangents = packed_tangents(problem, p0);
  for (std::size_t i = 0; i < p0.size(); ++i) {
    ASSERT_TRUE(tangents[i].reached);
    std::vector<double> z = problem.from;
    z.insert(z.end(), p0[i].data(), p0[i].data() + n);
    std::vector<double> m(4 * n * n);
    ASSERT_TRUE(
        problem.dynamics.tangent_flow(StepPlan::equal(0, problem.time, 16), z, m).completed());
    const auto expected = [&](int r, int c) { return m[r * 2 * n + n + c]; };
    const double size = tangents[i].j.cwiseAbs().maxCoeff();
    for (int r = 0; r < n; ++r) {
      EXPECT_NEAR(tangents[i].q1[r], z[r], kCoarse);
      EXPECT_NEAR(tangents[i].p1[r], z[n + r], kCoarse);
      for (int c = 0; c < n; ++c) {
        EXPECT_NEAR(tangents[i].j(r, c), expected(r, c), kCoarse * size) << r << c;
        EXPECT_NEAR(tangents[i].k(r, c), expected(n + r, c), kCoarse * size) << r << c;
      }
    }
  }
}

TEST(PackedTangents, AgreeWithTangentFlows) {
  expect_tangents_of_flows(test::unicycle({0, 0, 0.3}, {0, 0, 0}),
                           {Eigen::Vector3d(1, 2, -0.5), Eigen::Vector3d(-3, 0.5, 2)});
  expect_tangents_of_flows(test::vehicle({0, 0, 0.3, 0.5}, {0, 0, 0, 0}),
                           {Eigen::Vector4d(1, 2, -0.5, 0.7), Eigen::Vector4d(-2, 0.5, 2, -2.5)});
}

// More than a pack of them, which is filled in the order of their sizes.
TEST(PackedTangents, EndsAreThoseOfFlows) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0.3}, {0, 0, 0});
  constexpr int kCount = 11;
  std::vector<SmallVector> p0;
  for (int i = 0; i < kCount; ++i) p0.push_back(Eigen::Vector3d(i - 3.5, 1, 0.5 * i));
  // Errors of steps add up.
  for (const auto& [tolerance, allowed] : {std::pair{kCoarseFlow, 1e-4}, {kFineFlow, 1e-10}}) {
    const std::vector<PackedEnd> ends = packed_ends(problem, p0, tolerance);
    ASSERT_EQ(ends.size(), p0.size());
    for (int i = 0; i < kCount; ++i) {
      ASSERT_TRUE(ends[i].reached);
      std::vector<double> z = problem.from;
      z.insert(z.end(), p0[i].data(), p0[i].data() + 3);
      ASSERT_TRUE(problem.dynamics.flow(StepPlan::equal(0, problem.time, 64), z).completed());
      for (int r = 0; r < 3; ++r) EXPECT_NEAR(ends[i].q1[r], z[r], allowed);
      for (int r = 0; r < 3; ++r) EXPECT_NEAR(ends[i].p1[r], z[3 + r], allowed);
    }
  }
}

// Those that share a pack with a momentum that takes too many steps are reached all the same.
TEST(PackedTangents, FailAlone) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0.3}, {0, 0, 0});
  constexpr std::size_t kHopeless = 2;
  std::vector<SmallVector> p0(5, Eigen::Vector3d(1, 2, -0.5));
  p0[kHopeless] = Eigen::Vector3d(1, 2e6, -0.5);
  const std::vector<PackedEnd> ends = packed_ends(problem, p0, kCoarseFlow);
  const std::vector<PackedTangent> tangents = packed_tangents(problem, p0);
  for (std::size_t i = 0; i < p0.size(); ++i) {
    EXPECT_EQ(ends[i].reached, i != kHopeless) << i;
    EXPECT_EQ(tangents[i].reached, i != kHopeless) << i;
  }
}

// The same extremals with and without packs.
TEST(FieldNewton, FindsTheSameByPacksAndByTangentFlows) {
  constexpr double kSame = 1e-10;
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 0, 0});
  BoundaryValueProblem plain = problem;
  plain.dynamics.kernel.fills_packs = false;
  ASSERT_FALSE(has_packs(plain.dynamics));
  FieldAttempt attempt;
  attempt.point.p0 = Eigen::Vector3d(1, 2, -0.5);
  attempt.inverse = SmallMatrix::Identity(3, 3);
  attempt.target = FieldNewton(problem).end(attempt.point.p0, 2);
  attempt.point.p0 += Eigen::Vector3d(0.05, -0.05, 0.1);
  std::array<FieldAttempt, 3> packed{attempt, attempt, attempt};
  std::array<FieldAttempt, 1> alone{attempt};
  long flows = 0;
  FieldNewton(problem).solve(packed, flows);
  FieldNewton(plain).solve(alone, flows);
  ASSERT_TRUE(alone[0].found);
  for (const FieldAttempt& one : packed) {
    ASSERT_TRUE(one.found);
    EXPECT_LT((one.point.p0 - Eigen::Vector3d(1, 2, -0.5)).cwiseAbs().maxCoeff(), kSame);
    EXPECT_NEAR(one.point.action, alone[0].point.action, kSame);
    EXPECT_EQ(one.point.sign, alone[0].point.sign);
    EXPECT_LT((one.point.inverse - alone[0].point.inverse).norm(), 1e-2);
  }
}

}  // namespace
}  // namespace carnot::internal::packed_tangents_test
