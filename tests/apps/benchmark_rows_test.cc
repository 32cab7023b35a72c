#include "benchmark_rows.h"

#include <gtest/gtest.h>

namespace carnot::apps {
namespace {

BenchmarkRow row(const std::string& method, double error, double seconds) {
  return {"vehicle", method, "single", method == kContrast, true, 1e-8, error, seconds, 1, 0};
}

TEST(BenchmarkCurves, InterpolateTimesAtEqualError) {
  // Time like error^(-1/4), a row that others beat, and another method ten times slower.
  const std::vector<BenchmarkRow> rows{row(kContrast, 1e-4, 1e-5),
                                       row(kContrast, 1e-3, 2e-5),
                                       row("gauss16", 1e-4, 1e-4),
                                       row("gauss16", 1e-12, 1e-2),
                                       row(kContrast, 1e-12, 1e-3)};
  const auto curves = benchmark_curves(rows);
  ASSERT_EQ(curves.size(), 2);
  EXPECT_EQ(curves[0].method, kContrast);
  constexpr double kRoundOff = 1e-12;  // of logarithms
  const auto seconds = seconds_at(curves[0], 1e-8);
  ASSERT_TRUE(seconds);
  EXPECT_NEAR(*seconds, 1e-4, kRoundOff * 1e-4);
  const auto ratio = speed_ratio(curves, curves[1], 1e-8);
  ASSERT_TRUE(ratio);
  EXPECT_NEAR(*ratio, 0.1, kRoundOff);
  EXPECT_EQ(seconds_at(curves[0], 1e-2), std::nullopt);
  EXPECT_EQ(seconds_at(curves[0], 1e-13), std::nullopt);
}

}  // namespace
}  // namespace carnot::apps
