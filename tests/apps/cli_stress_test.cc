#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "command.h"

namespace carnot::apps::cli_stress_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Stress, HoldsItsContract) {
  const auto json = run({"stress", "unicycle", "--targets", "20", "--json"}).json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "scene",
                          "parameters",
                          "method",
                          "seed",
                          "targets",
                          "solved",
                          "solved_share",
                          "verified_at_knots",
                          "labels",
                          "reasons",
                          "median_seconds",
                          "p90_seconds",
                          "failures",
                          "elapsed_seconds"));
  EXPECT_EQ(json["targets"], 20);
  EXPECT_EQ(json["solved"], 20);
  EXPECT_EQ(json["labels"]["locally-minimal"], 20);
  EXPECT_LE(json["median_seconds"], json["p90_seconds"]);
  EXPECT_THAT(run({"stress", "unicycle", "--targets", "2"}).out, HasSubstr("2 (100.00 %)"));
}

TEST(Stress, KeepsToLimits) {
  const auto json =
      run({"stress", "vehicle", "--targets", "8", "--limit", "phi-theta in -0.3:0.3", "--json"})
          .json();
  EXPECT_EQ(json["solved"], 8);
  EXPECT_EQ(json["labels"]["locally-minimal"], 8);
  EXPECT_GT(json["verified_at_knots"], 0);  // pieces on the limit
}

TEST(Stress, GoesFromPointToPointOfAManifold) {
  const auto json = run({"stress", "satellite-quaternion", "--targets", "20", "--json"}).json();
  EXPECT_EQ(json["solved"], 20);
  EXPECT_EQ(json["method"], "gauss16");
}

TEST(Stress, IsTheSameOnAnyNumberOfThreads) {
  const auto counts = [](const std::string& threads) {
    auto json = run({"stress",
                     "heisenberg-group",
                     "--targets",
                     "30",
                     "--seed",
                     "3",
                     "--json",
                     "--threads",
                     threads})
                    .json();
    for (const char* key : {"arguments", "median_seconds", "p90_seconds", "elapsed_seconds"}) {
      json.erase(key);
    }
    return json.dump();
  };
  EXPECT_EQ(counts("1"), counts("3"));
}

// The midpoint rule does not reach the tolerance with the steps that verification affords.
TEST(Stress, CountsReasons) {
  const Outcome outcome =
      run({"stress", "unicycle", "--method", "midpoint", "--targets", "2", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json["solved"], 0);
  EXPECT_EQ(json["reasons"].dump(), R"({"method-too-coarse":2})");
  ASSERT_EQ(json["failures"].size(), 2);
  for (const auto& failure : json["failures"]) {
    EXPECT_EQ(failure["reason"], "method-too-coarse");
    EXPECT_THAT(failure["message"].get<std::string>(), HasSubstr("try a --method of higher order"));
  }
}

TEST(Stress, RefusesBadInput) {
  const std::map<std::vector<std::string>, std::string> cases{
      {{"stress", "unicicle"}, "did you mean unicycle?"},
      {{"stress", "rod-skate", "--method", "rattle"}, "RATTLE"},
      {{"stress", "unicycle", "--targets", "0"}, "--targets '0'"},
      {{"stress", "unicycle", "--seed", "-1"}, "--seed"},
      {{"stress", "unicycle", "--set", "gamma=1"}, "--set"},
      {{"stress", "unicycle", "--output", "x.csv"}, "--output"}};
  for (const auto& [arguments, message] : cases) expect_refused(arguments, HasSubstr(message));
}

}  // namespace
}  // namespace carnot::apps::cli_stress_test
