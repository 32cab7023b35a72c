#include "carnot/shooting/field/packed_tangents.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "carnot/shooting/field/field_newton.h"
#include "shooting/problems.h"

namespace carnot::internal::packed_tangents_test {
namespace {

// Two extremals side by side, each against the tangent flow of Gauss.
TEST(PackedTangents, AgreeWithTangentFlows) {
  constexpr double kCoarse = 1e-4;  // of the largest entry
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0.3}, {0, 0, 0});
  ASSERT_EQ(packed_extremals(problem.dynamics), 2);
  const std::vector<SmallVector> p0{Eigen::Vector3d(1, 2, -0.5), Eigen::Vector3d(-3, 0.5, 2)};
  std::array<PackedTangent, 2> tangents;
  packed_tangents(problem, p0, tangents);
  for (std::size_t i = 0; i < p0.size(); ++i) {
    std::vector<double> z{0, 0, 0.3, p0[i][0], p0[i][1], p0[i][2]};
    std::vector<double> m(36);
    ASSERT_TRUE(
        problem.dynamics.tangent_flow(StepPlan::equal(0, problem.time, 16), z, m).completed());
    ASSERT_TRUE(tangents[i].known);
    const double size = tangents[i].j.cwiseAbs().maxCoeff();
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(tangents[i].q1[r], z[r], kCoarse);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(tangents[i].j(r, c), m[r * 6 + 3 + c], kCoarse * size);
        EXPECT_NEAR(tangents[i].k(r, c), m[(r + 3) * 6 + 3 + c], kCoarse * size);
      }
    }
  }
}

// The same extremals with and without packs.
TEST(FieldNewton, FindsTheSameByPacksAndByTangentFlows) {
  constexpr double kSame = 1e-10;
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 0, 0});
  BoundaryValueProblem plain = problem;
  plain.dynamics.kernel.fills_packs = false;
  ASSERT_EQ(packed_extremals(plain.dynamics), 0);
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
