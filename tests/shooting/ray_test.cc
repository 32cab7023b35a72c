// Extremals of unit speed are followed in as many steps as round-off needs.
#include "carnot/shooting/rays/ray.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "carnot/shooting/shoot/end_point.h"
#include "shooting/problems.h"

namespace carnot::internal::ray_test {
namespace {

const std::vector<double> kOrigin(4, 0.0);
const std::vector<double> kMomentum{0.8, 0.5, -1.5, 0.6};
constexpr double kTime = 8;

// At unit speed no coordinate is larger than the time, and kFlowRoundOff of that is round-off.
constexpr double kRoundOff = 1e-13 * kTime;

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  return largest_difference(a.data(), b.data(), static_cast<int>(a.size()));
}

TEST(Ray, IsFollowedInAsManyStepsAsRoundOffNeeds) {
  const Dynamics dynamics = test::vehicle(kOrigin, kOrigin).dynamics;
  const Ray ray(dynamics, kOrigin, kMomentum);
  const Followed followed = ray.follow(kTime);
  ASSERT_GT(followed.steps, kFewestSteps);
  EXPECT_EQ(followed.z, ray.at(kTime, followed.steps));
  EXPECT_EQ(ray.enough_steps(kTime), followed.steps);
  EXPECT_LT(apart(followed.z, ray.at(kTime, 2 * followed.steps)), kRoundOff);
  // Far fewer are not enough.
  EXPECT_GT(apart(followed.z, ray.at(kTime, followed.steps / 4)), kRoundOff);
}

TEST(Ray, IsFollowedInNoFewerStepsThanAskedFor) {
  const Dynamics dynamics = test::vehicle(kOrigin, kOrigin).dynamics;
  const Ray ray(dynamics, kOrigin, kMomentum);
  const Followed first = ray.follow(kTime);
  EXPECT_EQ(ray.follow(kTime, first.steps).steps, first.steps);
  EXPECT_EQ(ray.follow(kTime, first.steps).z, first.z);
  const Followed more = ray.follow(kTime, 3 * first.steps);
  EXPECT_EQ(more.steps, 3 * first.steps);
  EXPECT_LT(apart(more.z, first.z), kRoundOff);
}

TEST(Ray, HasNoEndWhereItsFlowFails) {
  const Dynamics dynamics = test::vehicle(kOrigin, kOrigin).dynamics;
  const Ray ray(dynamics, kOrigin, {0.8, std::numeric_limits<double>::quiet_NaN(), -1.5, 0.6});
  const Followed followed = ray.follow(kTime);
  EXPECT_TRUE(followed.z.empty());
  EXPECT_EQ(followed.steps, kMostSteps);
  EXPECT_FALSE(ray.end(kTime, kFewestSteps));
}

}  // namespace
}  // namespace carnot::internal::ray_test
