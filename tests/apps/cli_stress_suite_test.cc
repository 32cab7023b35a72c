#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "benchmark/stress_suite.h"
#include "command.h"

namespace carnot::apps::cli_stress_suite_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(StressSuite, HoldsItsContractAndItsLaws) {
  const Outcome outcome = run({"stress", "--suite", "--short", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version", "arguments", "cases", "count", "held", "elapsed_seconds"));
  EXPECT_EQ(json["count"], json["cases"].size());
  EXPECT_EQ(json["held"], json["count"]);
  std::set<std::string> groups;
  for (const auto& one : json["cases"]) {
    EXPECT_THAT(
        keys(one),
        ElementsAre("group", "case", "law", "figure", "bound", "holds", "naive", "naive_figure"));
    EXPECT_TRUE(one["holds"]) << one["case"] << ": " << one["figure"];
    groups.insert(one["group"]);
  }
  EXPECT_THAT(groups,
              ElementsAre("boundary-value extremes",
                          "large steps and stiffness",
                          "long runs",
                          "near loss of index 1",
                          "unstable motions"));
}

// The measurement sees a broken law, and one of which nothing is known.
TEST(StressSuite, MarksWhatIsBroken) {
  const std::vector<StressCase> cases{{"group", "kept", "law", 1, 1, "naive", 2},
                                      {"group", "broken", "law", 2, 1, "naive", 2},
                                      {"group", "unknown", "law", std::nan(""), 1, "naive", 2}};
  EXPECT_EQ(suite_json(cases)["held"], 1);
  EXPECT_EQ(suite_json(cases)["count"], 3);
  const std::string text = suite_text(cases);
  EXPECT_THAT(text, HasSubstr("2*"));
  EXPECT_THAT(text, HasSubstr("nan*"));
  EXPECT_THAT(text, HasSubstr("1 of 3 hold"));
}

TEST(StressSuite, OfTheLineHasTheGoldenRatio) {
  const auto [fast, slow] = rates_of_line(1, 1, 1);
  EXPECT_NEAR(fast, (1 + std::sqrt(5.0)) / 2, 1e-15);
  EXPECT_NEAR(slow, (std::sqrt(5.0) - 1) / 2, 1e-15);
  EXPECT_NEAR(rates_of_line(0.1, 0.02, 2.5).first, 7.128, 1e-3);
}

TEST(StressSuite, RefusesBadInput) {
  expect_refused({"stress", "vehicle", "--suite"}, HasSubstr("scenes of its own"));
  expect_refused({"stress", "vehicle", "--short"}, HasSubstr("--suite"));
}

}  // namespace
}  // namespace carnot::apps::cli_stress_suite_test
