#include "benchmark/benchmark_rows.h"

#include <gtest/gtest.h>

#include <cmath>

namespace carnot::apps::benchmark_rows_test {
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

// One that ends at (1 + error, 0), or not at all.
Contestant contestant(const std::string& method, double error, bool completes) {
  Contestant made;
  made.method = method;
  made.run = [=] {
    BenchmarkEnd end;
    end.z[0] = 1 + error;
    end.completed = completes;
    end.evaluations = 7;
    return end;
  };
  made.watch = [=] { return BenchmarkWatch{0.5, completes ? "" : "it fell"}; };
  return made;
}

BenchmarkScene scene_that_ends_at_one() {
  BenchmarkScene scene;
  scene.problem.trajectory.scene = "vehicle";
  scene.reference.digits = {"1", "0"};
  read_digits(scene.reference);
  return scene;
}

TEST(RunContest, TellsErrorsAndFailures) {
  BenchmarkScene scene = scene_that_ends_at_one();
  const std::vector<Contestant> contestants{contestant("exact", 0, true),
                                            contestant("wrong", 0.25, true),
                                            contestant("fallen", 0, false),
                                            contestant("infinite", INFINITY, true)};
  ASSERT_TRUE(run_contest(contestants, {1e-6, 2}, {}, scene));
  ASSERT_EQ(scene.rows.size(), 2);
  EXPECT_EQ(scene.rows[0].error, 0);
  EXPECT_EQ(scene.rows[1].error, 0.25);
  EXPECT_EQ(scene.rows[1].evaluations, 7);
  EXPECT_EQ(scene.rows[1].energy_drift, 0.5);
  EXPECT_GT(scene.rows[1].seconds, 0);
  ASSERT_EQ(scene.failures.size(), 2);
  EXPECT_EQ(scene.failures[0].method, "fallen");
  EXPECT_EQ(scene.failures[0].message, "it fell");
  EXPECT_EQ(scene.failures[1].method, "infinite");
}

TEST(RunContest, StopsWhenAsked) {
  for (const int calls : {0, 1, 2}) {
    BenchmarkScene scene = scene_that_ends_at_one();
    int left = calls;
    const Progress progress = [&left](double) { return left-- > 0; };
    EXPECT_FALSE(run_contest({contestant("exact", 0, true)}, {1e-6, 2}, progress, scene));
  }
}

}  // namespace
}  // namespace carnot::apps::benchmark_rows_test
