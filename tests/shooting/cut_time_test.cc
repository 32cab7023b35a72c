// Cut times on SE(2), the unicycle with angles modulo 2 pi: where the list changes its first entry.
//
// At unit speed, with rho = |(p_x, p_y)|, theta'^2 = 1 - rho^2 cos^2(theta - phi): a pendulum. A
// geodesic is the shortest up to the time (Sachkov, ESAIM: COCV 16 (2010), 1018)
//
//   2 K(rho) for rho < 1,      2 k p1(k), k = 1 / rho, for rho > 1,
//
// where p1(k) is the least positive zero of cn(p) (E(p) - p) - dn(p) sn(p).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::cut_time_test {
namespace {

double cut_time(double rho) {
  if (rho < 1) return 2 * std::comp_ellint_1(rho);
  const double k = 1 / rho;
  const auto f = [&](double amplitude) {
    const double sn = std::sin(amplitude);
    return std::cos(amplitude) * (std::ellint_2(k, amplitude) - std::ellint_1(k, amplitude)) -
           std::sqrt(1 - k * k * sn * sn) * sn;
  };
  double low = 0.5 * std::numbers::pi;  // f < 0
  double high = std::numbers::pi;       // f > 0
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0 ? low : high) = middle;
  }
  return 2 * k * std::ellint_1(k, low);
}

// A geodesic from the origin at unit speed.
struct Ray {
  double rho;
  double p_x;  // the speed at first
};

class CutTimes : public testing::TestWithParam<Ray> {
 protected:
  // The momentum for which time 1 is time t at unit speed.
  [[nodiscard]] std::vector<double> momentum(double t) const {
    const auto [rho, p_x] = GetParam();
    return {t * p_x, t * std::sqrt(rho * rho - p_x * p_x), t * std::sqrt(1 - p_x * p_x)};
  }

  // From the origin to where the ray is at time t.
  [[nodiscard]] BoundaryValueProblem problem(double t) const {
    BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 0, 0});
    constexpr long kSteps = 128;
    std::vector<double> z{0, 0, 0};
    for (const double p : momentum(t)) z.push_back(p);
    EXPECT_TRUE(problem.dynamics.flow(StepPlan::equal(0, 1, kSteps), z).completed());
    problem.to.assign(z.begin(), z.begin() + 3);
    return problem;
  }

  [[nodiscard]] Geodesic shortest(double t) const {
    GeodesicOptions options;
    options.samples = 0;
    options.mod_angles = true;
    const GeodesicReport report = find_geodesics(problem(t), options);
    EXPECT_EQ(report.status, GeodesicStatus::kConverged);
    return report.geodesics.at(0);
  }

  // Follows a rival of the ray to time t. How much more its action is.
  [[nodiscard]] double lead(double t, Geodesic& rival) const {
    GeodesicOptions options;
    options.samples = 0;
    options.guess = rival.p0;
    BoundaryValueProblem there = problem(t);
    there.to[2] += 2 * std::numbers::pi * rival.windings[2];
    const GeodesicReport report = find_geodesics(there, options);
    if (report.geodesics.empty()) return std::nan("");
    rival.p0 = report.geodesics[0].p0;
    return report.geodesics[0].action - 0.5 * t * t;
  }
};

TEST_P(CutTimes, UpToItTheRayIsTheShortest) {
  constexpr double kBefore = 0.99;
  constexpr double kTolerance = 1e-9;  // ends agree to 1e-10
  const double t = kBefore * cut_time(GetParam().rho);
  const Geodesic first = shortest(t);
  EXPECT_NEAR(first.action, 0.5 * t * t, kTolerance);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(first.p0[j], momentum(t)[j], kTolerance);
  EXPECT_EQ(first.label, Label::kLocallyMinimal);
}

TEST_P(CutTimes, FromItOnAnotherOneIs) {
  constexpr double kAfter = 1.01;
  constexpr double kTolerance = 1e-9;  // relative, of the cut time
  const double expected = cut_time(GetParam().rho);
  double t = kAfter * expected;
  Geodesic rival = shortest(t);
  double ahead = rival.action - 0.5 * t * t;
  EXPECT_LT(ahead, -1e-4);
  // The time at which both are as long, by the secant method.
  double next = 0.5 * (1 + kAfter) * expected;
  constexpr int kIterations = 8;
  for (int i = 0; i < kIterations && std::abs(next - t) > 1e-12 * t; ++i) {
    const double ahead_there = lead(next, rival);
    ASSERT_TRUE(std::isfinite(ahead_there));
    const double slope = (ahead_there - ahead) / (next - t);
    t = next;
    ahead = ahead_there;
    next = t - ahead / slope;
  }
  EXPECT_NEAR(next, expected, kTolerance * expected);
  EXPECT_GT(std::abs(rival.p0[2] - momentum(next)[2]) + std::abs(rival.p0[0] - momentum(next)[0]),
            1e-3);  // it is another one
}

// Windings of the wheel as the pendulum turns over, and oscillates.
INSTANTIATE_TEST_SUITE_P(
    Sides,
    CutTimes,
    testing::Values(Ray{0.5, 0.3}, Ray{0.9, 0.5}, Ray{1.3, 0.6}, Ray{2.5, 0.5}),
    [](const auto& test) { return "Rho" + std::to_string(std::lround(10 * test.param.rho)); });

}  // namespace
}  // namespace carnot::cut_time_test
