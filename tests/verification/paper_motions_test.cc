// The two motions of the vehicle that the paper knows in closed form (section 5): straight, and on
// a circle. (The paper prints lambda = (1, -c) for the circle; it must be (0, -c).)
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/flow/flow.h"
#include "carnot/step/gauss.h"
#include "testing/runs.h"

namespace carnot::paper_motions_test {
namespace {

using System = VelocityConstraints<scenes::Vehicle>;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kStep = 0.1;

// x = c t, all else zero: zeros stay zeros although the motion is unstable (rate 1.6).
TEST(StraightMotionTest, IsExactInDouble) {
  const System system{{}};
  Gauss<System, 8> method(system);
  auto z = make_state<double, 4>({0, 0, 0, 0}, {1, 0, 0, 0});
  const StepPlan plan = StepPlan::of_length(0, 100, kStep);
  const auto watch = [&](long i, const auto&, const auto& node) {
    EXPECT_NEAR(node.value[0], plan.time(i + 1), 4 * kEps * plan.time(i + 1));
    EXPECT_EQ(node.value[4], 1);
    for (const int zero : {1, 2, 3, 5, 6, 7})
      EXPECT_EQ(node.value[zero], 0) << "component " << zero;
    return true;
  };
  EXPECT_TRUE(flow(method, plan, z, watch).completed());
}

// theta = a t, phi = theta + pi/2, (x, y) = l (cos theta, sin theta), p constant.
template <class T>
State<T, 4> circle(const scenes::Vehicle& v, T a, T t) {
  const T l = static_cast<T>(v.length);
  const T theta = a * t;
  const Vector<T, 4> q(
      l * std::cos(theta), l * std::sin(theta), theta, theta + std::numbers::pi_v<T> / 2);
  const Vector<T, 4> p(0, 0, a * (l * l + static_cast<T>(v.alpha)), static_cast<T>(v.beta) * a);
  return make_state<T, 4>(q, p);
}

TEST(CircularMotionTest, SolvesTheEquations) {
  for (const scenes::Vehicle& vehicle : {scenes::Vehicle{}, scenes::Vehicle{0.7, 0.4, 1.3}}) {
    const System system(vehicle);
    for (const double a : {1.0, -0.5}) {
      for (const double t : {0.0, 0.7, 3.0}) {
        const State<double, 4> z = circle(vehicle, a, t);
        const Vector<double, 4> q = z.value.head<4>();
        const Vector<double, 4> p = z.value.tail<4>();
        Vector<double, 2> y;
        Rate<double, 4> rate;
        Vector<double, 2> lambda;
        ASSERT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
        ASSERT_EQ(system.multipliers(q, p, rate.q_dot, lambda), RateStatus::kOk);
        constexpr double kRoundOff = 16 * kEps;
        const Vector<double, 4> q_dot(-a * q[1], a * q[0], a, a);
        EXPECT_LE((rate.q_dot - q_dot).cwiseAbs().maxCoeff(), kRoundOff);
        EXPECT_LE(rate.p_dot.cwiseAbs().maxCoeff(), kRoundOff);
        EXPECT_NEAR(lambda[0], 0, kRoundOff);
        EXPECT_NEAR(lambda[1], -a * vehicle.length, kRoundOff);
      }
    }
  }
}

// When the numerical orbit has left the circle by 0.1.
template <class T>
double departure_time(double longest) {
  const scenes::Vehicle vehicle;
  const System system(vehicle);
  Gauss<System, 8, T> method(system);
  auto z = circle<T>(vehicle, T(1), T(0));
  const StepPlan plan = StepPlan::of_length(0, longest, kStep);
  const FlowReport report = flow(method, plan, z, [&](long i, const auto&, const auto& node) {
    const T t = static_cast<T>(plan.time(i + 1));
    return (node.value - circle<T>(vehicle, T(1), t).value).cwiseAbs().maxCoeff() < T(0.1);
  });
  return report.time_reached;
}

// The circle is unstable with rate sqrt(3/2): an error of 1e-16 is of size 1 at t = 30.
TEST(CircularMotionTest, LeavesTheCircleWhenRoundOffHasGrown) {
  const double in_double = departure_time<double>(60);
  EXPECT_GT(in_double, 26);
  EXPECT_LT(in_double, 32);
  // 11 more bits: log(2^11) / sqrt(3/2) = 6.2 later, give or take the luck of the rounding.
  const double in_long_double = departure_time<long double>(60);
  EXPECT_GT(in_long_double, in_double + 3);
  EXPECT_LT(in_long_double, in_double + 10);
}

// Until then it is on the circle, as near as the growth allows.
TEST(CircularMotionTest, StaysOnTheCircleBefore) {
  constexpr double kRate = 1.224744871391589;
  const scenes::Vehicle vehicle;
  const System system(vehicle);
  Gauss<System, 8> method(system);
  auto z = circle(vehicle, 1.0, 0.0);
  const StepPlan plan = StepPlan::of_length(0, 20, kStep);
  const auto watch = [&](long i, const auto&, const auto& node) {
    const double t = plan.time(i + 1);
    const double error = (node.value - circle(vehicle, 1.0, t).value).cwiseAbs().maxCoeff();
    EXPECT_LE(error, 16 * kEps * std::exp(kRate * t));
    return true;
  };
  EXPECT_TRUE(flow(method, plan, z, watch).completed());
}

}  // namespace
}  // namespace carnot::paper_motions_test
