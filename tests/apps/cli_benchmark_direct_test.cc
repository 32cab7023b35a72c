#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "command.h"

namespace carnot::apps::cli_benchmark_direct_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(LimitsBenchmark, HoldsItsContract) {
  const Sandbox sandbox;
  const Outcome outcome =
      sandbox.run({"benchmark", "--limits", "--quick", "--json", "--output", "limits.md"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
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
                          "elapsed_seconds"));
  ASSERT_EQ(json["rows"].size(), 5);
  for (const auto& row : json["rows"]) {
    EXPECT_THAT(keys(row),
                ElementsAre("problem",
                            "scene",
                            "from",
                            "to",
                            "limits",
                            "discs",
                            "action",
                            "verification",
                            "contacts",
                            "violation",
                            "label",
                            "seconds",
                            "direct"));
    EXPECT_LE(row["violation"].get<double>(), 1e-10);
    EXPECT_GE(row["contacts"].get<int>(), 1);
    EXPECT_TRUE(row["direct"].is_null());
  }
  EXPECT_THAT(read_text(sandbox.directory() / "limits.md"), HasSubstr("| vehicle |"));
}

TEST(LimitsBenchmark, RefusesBadInput) {
  const std::map<Words, std::string> cases{
      {{"benchmark", "vehicle", "--limits"}, "SCENE 'vehicle'"},
      {{"benchmark", "--limits", "--energy"}, "--energy"},
      {{"benchmark", "--limits", "--starts", "3"}, "--starts"},
      {{"benchmark", "--limits", "--threads", "1"}, "--threads"},
      {{"benchmark", "--limits", "--plot", "l.png"}, "--plot"},
      {{"benchmark", "--limits", "--seed", "-1"}, "--seed"},
      {{"benchmark", "--limits", "--drift"}, "--drift"},
      {{"benchmark", "--drift", "--energy"}, "--energy"},
      {{"benchmark", "--drift", "--plot", "d.png"}, "--plot"},
      {{"benchmark", "--drift", "--steps", "1000"}, "--steps"}};
  for (const auto& [arguments, message] : cases) expect_refused(arguments, HasSubstr(message));
}

TEST(DriftBenchmark, HoldsItsContract) {
  const Sandbox sandbox;
  const Outcome outcome =
      sandbox.run({"benchmark", "--drift", "--quick", "--json", "--output", "drift.md"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = outcome.json();
  ASSERT_EQ(json["rows"].size(), 7);
  for (const auto& row : json["rows"]) {
    EXPECT_THAT(keys(row),
                ElementsAre("problem",
                            "scene",
                            "from",
                            "to",
                            "time",
                            "action",
                            "verification",
                            "label",
                            "seconds",
                            "direct"));
    EXPECT_EQ(row["label"], "locally-minimal") << row["problem"];
    EXPECT_TRUE(row["direct"].is_null());
  }
  const std::string report = read_text(sandbox.directory() / "drift.md");
  EXPECT_THAT(report, HasSubstr("## Drift"));
  EXPECT_THAT(report, HasSubstr("| kepler-transfer |"));
}

#ifdef CARNOT_PEERS
// A direct method agrees, as well as its grids tell.
TEST(LimitsBenchmark, AgreesWithADirectMethod) {
  const auto json = run({"benchmark", "--limits", "--quick", "--peers", "--json"}).json();
  for (const auto& row : json["rows"]) {
    const auto& direct = row["direct"];
    ASSERT_FALSE(direct["action"].is_null()) << row["problem"];
    const double action = row["action"];
    // Arcs begin between nodes, so the errors of grids do not fall quite as squares.
    constexpr double kTrust = 3;
    EXPECT_NEAR(
        direct["action"], action, kTrust * direct["action_error"].get<double>() + 1e-7 * action)
        << row["problem"];
    EXPECT_GE(direct["solved"], 1);
  }
}

// Of each scene the direct method sees its Hamiltonian only, and makes all derivatives itself.
TEST(DriftBenchmark, AgreesWithADirectMethod) {
  const auto json = run({"benchmark", "--drift", "--quick", "--peers", "--json"}).json();
  for (const auto& row : json["rows"]) {
    const auto& direct = row["direct"];
    ASSERT_FALSE(direct["action"].is_null()) << row["problem"];
    const double action = row["action"];
    EXPECT_NEAR(direct["action"], action, direct["action_error"].get<double>() + 1e-9 * action)
        << row["problem"];
    EXPECT_GE(direct["solved"], 1) << row["problem"];
  }
}
#endif

}  // namespace
}  // namespace carnot::apps::cli_benchmark_direct_test
