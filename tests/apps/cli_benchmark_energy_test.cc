#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "command.h"

namespace carnot::apps::cli_benchmark_energy_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(EnergyBenchmark, HoldsItsContract) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"benchmark",
                                       "--energy",
                                       "--quick",
                                       "--json",
                                       "--plot",
                                       "energy.png",
                                       "--output",
                                       "energy.md"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "status",
                          "message",
                          "processor",
                          "compiler",
                          "rows",
                          "growth",
                          "elapsed_seconds"));
  std::map<std::string, double> least;
  for (const auto& row : json["rows"]) {
    EXPECT_TRUE(row["error"].is_null());
    EXPECT_GT(row["seconds"], 0);
    EXPECT_GE(row["energy_drift"], 0);
    const auto [entry, first] = least.emplace(row["method"], row["energy_drift"]);
    if (!first) entry->second = std::min(entry->second, row["energy_drift"].get<double>());
  }
  // Symplectic methods that resolve the motion drift by round-off alone, which grows like the root
  // of some thousand steps.
  constexpr double kRoundOff = 3e-13;
  EXPECT_LE(least.at("gauss16"), kRoundOff);
  EXPECT_LE(least.at("gauss16, stages to 1e-13"), kRoundOff);
  EXPECT_GT(least.at("dop853-adaptive"), kRoundOff);
  ASSERT_EQ(json["growth"].size(), 8);  // two scenes, with and without, after 100 and 1000 steps
  for (const auto& point : json["growth"]) {
    constexpr double kAllowed = 30;  // without compensation; H is rounded to eps itself
    const double walk =
        std::numeric_limits<double>::epsilon() * std::sqrt(point["steps"].get<double>());
    EXPECT_LE(point["drift"], kAllowed * walk) << point;
  }
  EXPECT_THAT(sandbox.files(), ::testing::UnorderedElementsAre("energy.png", "energy.md"));
  const std::string report = read_text(sandbox.directory() / "energy.md");
  EXPECT_THAT(report, HasSubstr("# carnot benchmark --energy"));
  EXPECT_THAT(report, HasSubstr("| gauss16, stages to 1e-13"));
}

TEST(EnergyBenchmark, RefusesWhatItDoesNotKnow) {
  expect_refused({"benchmark", "--energy", "--boundary-value"}, HasSubstr("--energy"));
  expect_refused({"benchmark", "--energy", "vehicle"}, HasSubstr("SCENE"));
  expect_refused({"benchmark", "--energy", "--steps", "10"}, HasSubstr("--steps"));
  expect_refused({"benchmark", "--energy", "--starts", "3"}, HasSubstr("--starts"));
  expect_refused({"benchmark", "--steps", "1000"}, HasSubstr("--energy"));
  expect_refused({"benchmark", "--threads", "2"}, HasSubstr("--threads"));
}

// The stages are good to the change times one more contraction.
TEST(FlowCommand, EndsTheStageIterationWhereAsked) {
  const Sandbox sandbox;
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"flow",
                                   "vehicle",
                                   "--from",
                                   "1,0.5,0.3,0.8",
                                   "--momentum",
                                   "0.7,0.7,0.48,0.2",
                                   "--time",
                                   "10",
                                   "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return sandbox.run(words);
  };
  const auto exact = run({"--steps", "50"}).json();
  const auto loose = run({"--steps", "50", "--stage-tolerance", "1e-9"}).json();
  EXPECT_LT(loose["evaluations"], 0.8 * exact["evaluations"].get<double>());
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(loose["q"][i], exact["q"][i].get<double>(), 1e-8);  // 50 steps
  }
  EXPECT_EQ(run({"--tolerance", "1e-9", "--stage-tolerance", "1e-9"}).status, 2);
  EXPECT_EQ(run({"--steps", "50", "--stage-tolerance", "0"}).status, 2);
}

}  // namespace
}  // namespace carnot::apps::cli_benchmark_energy_test
