// Lists of all extremals where the frame loses rank on the way, which grids do not see.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::all_extremals_test {
namespace {

// From the origin of the Grushin plane, with w = p_y: x(t) = p_x sin(w t)/w and
// y(1) = x(1)^2 (w - sin w cos w) / (2 sin(w)^2). So w solves one equation in every interval
// between multiples of pi, by one root in the first and by two or none in the others. Actions w^2
// x^2 / (2 sin(w)^2).
std::vector<double> grushin_actions(double x, double y) {
  std::vector<double> actions;
  const auto height = [&](double w) {
    const double s = std::sin(w);
    return x * x * (w - s * std::cos(w)) / (2 * s * s) - y;
  };
  const auto bisect = [&](double a, double b) {
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (a + b);
      ((height(middle) > 0) == (height(b) > 0) ? b : a) = middle;
    }
    const double root = a * x / std::sin(a);
    actions.push_back(0.5 * root * root);
  };
  constexpr double kPi = std::numbers::pi;
  constexpr double kAside = 1e-9;
  constexpr int kSamples = 1000;
  for (int k = 0; k * kPi < 4 * y / (x * x) + kPi; ++k) {
    double before = k * kPi + kAside;
    for (int i = 1; i <= kSamples; ++i) {
      const double after = k * kPi + kAside + i * (kPi - 2 * kAside) / kSamples;
      if ((height(before) > 0) != (height(after) > 0)) bisect(before, after);
      before = after;
    }
  }
  std::sort(actions.begin(), actions.end());
  return actions;
}

TEST(AllExtremals, OfTheGrushinPlane) {
  const std::vector<double> expected = grushin_actions(1, 20);
  ASSERT_EQ(expected.size(), 25U);
  GeodesicOptions options;
  options.all = true;
  const GeodesicReport report = find_geodesics(test::grushin({0, 0}, {1, 20}), options);
  ASSERT_EQ(report.geodesics.size(), expected.size());
  constexpr double kMagnified = 1e-10;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(report.geodesics[i].action / expected[i], 1, kMagnified) << i;
    EXPECT_EQ(report.geodesics[i].label, i < 2 ? Label::kLocallyMinimal : Label::kConjugatePassed)
        << i;
  }
}

// Dilations of the Heisenberg group change nothing but the scale.
TEST(AllExtremals, DilationsKeepThem) {
  GeodesicOptions options;
  options.all = true;
  for (const double d : {1.0, 1e-2, 1e-3}) {
    const BoundaryValueProblem problem = test::heisenberg_group({0.5 * d, 0, 2 * d * d});
    const GeodesicReport report = find_geodesics(problem, options);
    EXPECT_EQ(report.geodesics.size(), 19U) << d;
    constexpr double kDigits = 1e-9;
    EXPECT_NEAR(report.geodesics.at(0).action / (d * d), 10.222137129566029, kDigits) << d;
  }
}

}  // namespace
}  // namespace carnot::all_extremals_test
