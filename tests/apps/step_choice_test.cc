#include "carnot/laws/step_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "catalogue/method_table.h"
#include "catalogue/scene_choice.h"

namespace carnot::apps::step_choice_test {
namespace {

using ::testing::HasSubstr;

const std::vector<double> kStart{0, 0, 0, 0.1, 0.3, 1};
constexpr double kTime = 10;

Dynamics heisenberg(const std::string& method) { return find_scene("heisenberg").make({}, method); }

std::vector<double> end_point(const Dynamics& dynamics, long count) {
  std::vector<double> z = kStart;
  EXPECT_TRUE(dynamics.flow(StepPlan::equal(0, kTime, count), z).completed());
  return z;
}

double error(const Dynamics& dynamics, long count) {
  const auto exact = end_point(heisenberg("gauss16"), 200);
  const auto z = end_point(dynamics, count);
  double largest = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    largest = std::max(largest, std::abs(z[i] - exact[i]));
  }
  return largest;
}

TEST(ChooseSteps, ReachesTheToleranceButNotByFar) {
  for (const Method& method : methods()) {
    for (const double tolerance : {1e-4, 1e-8, 1e-12}) {
      if (method.order < 4 && tolerance < 1e-8) continue;  // beyond the cap
      const Dynamics dynamics = heisenberg(method.name);
      const StepChoice choice = choose_steps(dynamics, 0, kTime, kStart, tolerance);
      ASSERT_EQ(choice.status, StepChoiceStatus::kOk) << method.name << choice.message;
      EXPECT_LE(error(dynamics, choice.count), 2 * tolerance + 1e-13) << method.name;
      EXPECT_LE(choice.error, tolerance);
      EXPECT_GT(choice.evaluations, 0);
      // With two thirds of the steps the tolerance is missed (unless there were few to begin with).
      if (choice.count > 8) {
        EXPECT_GT(error(dynamics, choice.count * 2 / 3), 0.5 * tolerance) << method.name;
      }
    }
  }
}

TEST(ChooseSteps, TellsWhenTheToleranceIsOutOfReach) {
  const StepChoice midpoint = choose_steps(heisenberg("midpoint"), 0, kTime, kStart, 1e-14);
  EXPECT_EQ(midpoint.status, StepChoiceStatus::kNotReached);
  EXPECT_THAT(midpoint.message, HasSubstr("tolerance 1e-14 would take about"));
  const std::vector<double> far{1e8, -1e8, 0, 1e3, 3e3, 1};
  const StepChoice round_off = choose_steps(heisenberg("gauss16"), 0, kTime, far, 1e-16);
  EXPECT_EQ(round_off.status, StepChoiceStatus::kNotReached);
  EXPECT_THAT(round_off.message, HasSubstr("tolerance 1e-16"));
}

TEST(ChooseSteps, CanBeStopped) {
  const StepChoice choice =
      choose_steps(heisenberg("midpoint"), 0, kTime, kStart, 1e-8, [](double) { return false; });
  EXPECT_EQ(choice.status, StepChoiceStatus::kStopped);
}

}  // namespace
}  // namespace carnot::apps::step_choice_test
