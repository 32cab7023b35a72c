#include "carnot/shooting/field/packed_tangents.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "carnot/shooting/field/field_newton.h"
#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::internal::packed_tangents_test {
namespace {

// Two extremals side by side, each against the tangent flow of Gauss.
void expect_tangents_of_flows(const BoundaryValueProblem& problem,
                              const std::array<SmallVector, 2>& p0) {
  constexpr double kCoarse = 1e-4;  // of the largest entry
  const int n = problem.dynamics.dof;
  ASSERT_TRUE(has_packs(problem.dynamics));
  // Any basis gives the same.
  const std::array<SmallMatrix, 2> bases{SmallMatrix::Identity(n, n),
                                         SmallMatrix::Random(n, n) + SmallMatrix::Identity(n, n)};
  const std::vector<PackedTangent> tangents =
      packed_tangents(problem, p0, bases, std::array{kCoarseFlow, kCoarseFlow});
  for (std::size_t i = 0; i < p0.size(); ++i) {
    ASSERT_TRUE(tangents[i].reached);
    const SmallMatrix j = tangents[i].j * small_lu_inverse(tangents[i].d);
    const SmallMatrix k = tangents[i].k * small_lu_inverse(tangents[i].d);
    std::vector<double> z = problem.from;
    z.insert(z.end(), p0[i].data(), p0[i].data() + n);
    std::vector<double> m(4 * n * n);
    ASSERT_TRUE(
        problem.dynamics.tangent_flow(StepPlan::equal(0, problem.time, 16), z, m).completed());
    const auto expected = [&](int r, int c) { return m[r * 2 * n + n + c]; };
    const double size = j.cwiseAbs().maxCoeff();
    for (int r = 0; r < n; ++r) {
      EXPECT_NEAR(tangents[i].q1[r], z[r], kCoarse);
      EXPECT_NEAR(tangents[i].p1[r], z[n + r], kCoarse);
      for (int c = 0; c < n; ++c) {
        EXPECT_NEAR(j(r, c), expected(r, c), kCoarse * size) << r << c;
        EXPECT_NEAR(k(r, c), expected(n + r, c), kCoarse * size) << r << c;
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
  for (int i = 0; i < kCount; ++i) p0.emplace_back(Eigen::Vector3d(i - 3.5, 1, 0.5 * i));
  // Errors of steps add up.
  for (const auto& [tolerance, allowed] : {std::pair{kCoarseFlow, 1e-4}, {kFineFlow, 1e-10}}) {
    const std::vector<PackedEnd> ends = packed_ends(problem, p0, std::vector(p0.size(), tolerance));
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
  const std::vector<double> tolerances(p0.size(), kCoarseFlow);
  const std::vector<PackedEnd> ends = packed_ends(problem, p0, tolerances);
  const std::vector<PackedTangent> tangents = packed_tangents(
      problem, p0, std::vector<SmallMatrix>(p0.size(), SmallMatrix::Identity(3, 3)), tolerances);
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
  packed[1].inverse(0, 0) = -1;  // the basis of the tangents may have any orientation
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

// Where the end moves ten thousand times as far as a momentum: differences of momenta themselves
// would bend, and errors of coarse steps be as large as the target is far.
TEST(FieldNewton, FindsStiffExtremalsByPacks) {
  constexpr double kFar = 1e4;
  constexpr double kAllowed = 1e-8;
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {12, 4, 0.5});
  FieldAttempt attempt;
  const std::vector<double> p0 = find_geodesics(problem).geodesics.at(0).p0;
  attempt.point.p0 = Eigen::Map<const Eigen::VectorXd>(p0.data(), 3);
  long flows = 0;
  ASSERT_TRUE(FieldNewton(problem).solve(problem.to, attempt.point, flows, 4));
  attempt.inverse = attempt.point.inverse;
  ASSERT_GT(small_lu_inverse(attempt.inverse).norm(), kFar);
  const Eigen::Vector3d step(0.1, -0.1, 0.1);
  attempt.target = problem.to;
  for (int j = 0; j < 3; ++j) attempt.target[j] += step[j];
  attempt.point.p0 += attempt.inverse * step;
  std::array<FieldAttempt, 1> packed{attempt};
  FieldNewton(problem).solve(packed, flows);
  ASSERT_TRUE(packed[0].found);
  const std::vector<double> end = FieldNewton(problem).end(packed[0].point.p0, 32);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(end.at(j), attempt.target[j], kAllowed);
}

}  // namespace
}  // namespace carnot::internal::packed_tangents_test
