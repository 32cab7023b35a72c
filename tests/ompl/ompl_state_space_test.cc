#include "carnot/shooting/ompl_state_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ompl/base/ScopedState.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "carnot/make_dynamics.h"
#include "carnot/scenes/unicycle.h"

namespace carnot {
namespace {

namespace ob = ompl::base;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

constexpr double kTolerance = 1e-10;  // of an end point

ob::RealVectorBounds box(unsigned dimensions) {
  ob::RealVectorBounds bounds(dimensions);
  bounds.setLow(-4);
  bounds.setHigh(4);
  return bounds;
}

SteeringFunction unicycle(bool mod_angles = true) {
  SteeringOptions options;
  options.mod_angles = mod_angles;
  return SteeringFunction(make_dynamics(scenes::Unicycle{}), options);
}

class OmplStateSpaceTest : public ::testing::Test {
 protected:
  OmplStateSpaceTest()
      : space_(std::make_shared<SteeringStateSpace>(unicycle(), box(2), 0.5)),
        si_(std::make_shared<ob::SpaceInformation>(space_)) {
    si_->setStateValidityChecker(
        [this](const ob::State* state) { return space_->configuration(state)[1] < wall_; });
    si_->setMotionValidator(std::make_shared<SteeringMotionValidator>(si_));
    si_->setup();
  }

  [[nodiscard]] ob::ScopedState<> state(const std::vector<double>& q) const {
    ob::ScopedState<> made(space_);
    space_->set(made.get(), q);
    return made;
  }

  std::shared_ptr<SteeringStateSpace> space_;
  ob::SpaceInformationPtr si_;
  double wall_ = 10;
};

TEST_F(OmplStateSpaceTest, PassesTheSanityChecksOfOmpl) {
  EXPECT_EQ(space_->getDimension(), 3);
  // What needs no geodesic, since OMPL asks a thousand times.
  EXPECT_NO_THROW(space_->sanityChecks(1e-9,
                                       1e-9,
                                       ob::StateSpace::STATESPACE_DISTANCE_SYMMETRIC |
                                           ob::StateSpace::STATESPACE_DISTANCE_DIFFERENT_STATES |
                                           ob::StateSpace::STATESPACE_DISTANCE_BOUND |
                                           ob::StateSpace::STATESPACE_RESPECT_BOUNDS |
                                           ob::StateSpace::STATESPACE_ENFORCE_BOUNDS_NO_OP |
                                           ob::StateSpace::STATESPACE_SERIALIZATION));
}

TEST_F(OmplStateSpaceTest, InterpolatesGeodesicsAndWrapsAngles) {
  const auto from = state({0, 0, 3});
  const auto to = state({0, 0, -3});
  auto half = state({1, 1, 1});
  space_->interpolate(from.get(), to.get(), 0.5, half.get());
  const std::vector<double> q = space_->configuration(half.get());
  EXPECT_NEAR(q[0], 0, kTolerance);
  EXPECT_NEAR(std::abs(q[2]), std::numbers::pi, kTolerance);
  EXPECT_TRUE(space_->satisfiesBounds(half.get()));
  space_->interpolate(from.get(), to.get(), 1, half.get());
  EXPECT_THAT(space_->configuration(half.get()), ElementsAre(0, 0, DoubleNear(-3, 1e-15 * 8)));
}

TEST_F(OmplStateSpaceTest, MeasuresStraightLinesOrGeodesics) {
  const auto from = state({0, 0, 0});
  const auto to = state({0, 1, 0});
  EXPECT_NEAR(space_->distance(from.get(), to.get()), 1, kTolerance);
  EXPECT_NEAR(space_->distance(from.get(), state({0, 0, 1}).get()), 0.5, kTolerance);
  EXPECT_NEAR(space_->length(from.get(), to.get()), 3.3403830192305876, kTolerance);
  const SteeringObjective objective(si_);
  EXPECT_TRUE(objective.isSymmetric());
  EXPECT_NEAR(objective.motionCost(from.get(), to.get()).value(), 3.3403830192305876, kTolerance);
  const SteeringStateSpace geodesic(unicycle(), box(2), 1, SteeringStateSpace::Nearness::kGeodesic);
  EXPECT_NEAR(geodesic.distance(from.get(), to.get()), 3.3403830192305876, kTolerance);
  EXPECT_FALSE(geodesic.isMetricSpace());
}

TEST_F(OmplStateSpaceTest, ChecksMotionsAlongTheGeodesic) {
  const auto from = state({0, 0, 0});
  const auto to = state({0, 1, 0});
  EXPECT_TRUE(si_->checkMotion(from.get(), to.get()));
  wall_ = 0.5;  // the path crosses it
  EXPECT_FALSE(si_->checkMotion(from.get(), to.get()));
  auto last = state({0, 0, 0});
  std::pair<ob::State*, double> last_valid{last.get(), -1};
  EXPECT_FALSE(si_->checkMotion(from.get(), to.get(), last_valid));
  EXPECT_GT(last_valid.second, 0);
  EXPECT_LT(last_valid.second, 1);
  EXPECT_LT(space_->configuration(last.get())[1], wall_);
  EXPECT_GT(space_->configuration(last.get())[1], wall_ - 0.2);
}

TEST(OmplStateSpace, OnTheCoverAnglesAreLines) {
  const SteeringStateSpace space(unicycle(false), box(3));
  EXPECT_EQ(space.getSubspaceCount(), 1);
  EXPECT_THROW(SteeringStateSpace(unicycle(false), box(2)), std::invalid_argument);
  EXPECT_THROW(SteeringStateSpace(unicycle(), box(3)), std::invalid_argument);
}

}  // namespace
}  // namespace carnot
