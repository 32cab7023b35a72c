#include "carnot/shooting/steer/end_point_model.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/shoot/end_point.h"
#include "shooting/problems.h"

namespace carnot::internal::end_point_model_test {
namespace {

using Vector = EndPointModel::Vector;

constexpr long kSteps = 64;

// A geodesic of `problem`, the model of its end, and that end.
struct Modelled {
  explicit Modelled(BoundaryValueProblem given) : problem(std::move(given)) {
    GeodesicOptions options;
    options.samples = 0;
    const std::vector<double> found = find_geodesics(problem, options).geodesics.at(0).p0;
    p0 = Eigen::Map<const Vector>(found.data(), problem.dynamics.dof);
  }

  Vector end(const Vector& change, Eigen::MatrixXd& jacobian) const {
    const Vector p = p0 + change;
    std::vector<double> z;
    const auto tangent =
        end_point_tangent(problem, {p.data(), p.data() + p.size()}, problem.time, kSteps, z);
    EXPECT_TRUE(tangent);
    jacobian = tangent->topRows(p.size());
    return Eigen::Map<const Vector>(z.data(), p.size());
  }

  BoundaryValueProblem problem;
  Vector p0;
};

class EndPointModelTest : public ::testing::TestWithParam<BoundaryValueProblem> {};

TEST_P(EndPointModelTest, IsOfThirdOrder) {
  const Modelled known(GetParam());
  const EndPointModel model(known.problem, known.p0);
  ASSERT_TRUE(model.invertible());
  Eigen::MatrixXd jacobian;
  const Vector end = known.end(Vector::Zero(known.p0.size()), jacobian);
  // A change of p0 that moves the end in every direction alike.
  const Vector direction = jacobian.inverse() * Vector::Ones(known.p0.size()).normalized();
  constexpr std::array<double, 2> kSizes{8e-3, 4e-3};
  std::array<double, 2> misses{};
  std::array<double, 2> slopes{};
  for (std::size_t k = 0; k < kSizes.size(); ++k) {
    const Vector change = kSizes[k] * (jacobian * direction);
    const EndPointModel::Prediction predicted = model.move_end(change);
    Eigen::MatrixXd there;
    const Vector reached = known.end(predicted.change, there);
    misses[k] = (reached - end - change).cwiseAbs().maxCoeff();
    slopes[k] =
        (predicted.inverse * there - Eigen::MatrixXd::Identity(change.size(), change.size()))
            .norm();
    // An estimate, good to a factor.
    EXPECT_LE(misses[k], 30 * predicted.error);
  }
  // Halves that are far from round-off fall by 2^4 and 2^3, but for the next term.
  EXPECT_NEAR(std::log2(misses[0] / misses[1]), 4, 0.5);
  EXPECT_NEAR(std::log2(slopes[0] / slopes[1]), 3, 0.5);
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         EndPointModelTest,
                         ::testing::Values(test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5}),
                                           test::unicycle({0, 0, 0}, {1, 1, 1}),
                                           test::heisenberg_group({1, 0, 0.2})));

TEST(EndPointModel, LeadsAsFarAsItCan) {
  const Modelled known(test::unicycle({0, 0, 0}, {1, 1, 1}));
  const EndPointModel model(known.problem, known.p0);
  const Vector far{{-20.0, 30.0, 40.0}};
  const EndPointModel::Prediction predicted = model.move_end(far);
  EXPECT_TRUE(predicted.change.allFinite());
  EXPECT_TRUE(predicted.inverse.allFinite());
  EXPECT_GT(predicted.error, 1);
}

TEST(EndPointModel, HasNoInverseAtAConjugatePoint) {
  const double pi = std::acos(-1.0);
  const Vector conjugate{{2 * std::sqrt(pi), 0.0, 2 * pi}};
  EXPECT_FALSE(EndPointModel(test::heisenberg_group({0, 0, 1}), conjugate).invertible());
}

}  // namespace
}  // namespace carnot::internal::end_point_model_test
