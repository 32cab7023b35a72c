#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "command.h"

namespace carnot::apps::cli_benchmark_boundary_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

Words few(const Words& more) {
  return with({"benchmark", "--boundary-value", "--starts", "1", "--targets", "1"}, more);
}

TEST(BoundaryBenchmark, HoldsItsContract) {
  const Sandbox sandbox;
  const Outcome outcome =
      sandbox.run(few({"--json", "--plot", "starts.png", "--output", "solvers.md"}));
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
                          "seed",
                          "problems",
                          "rows",
                          "curve",
                          "elapsed_seconds"));
  EXPECT_EQ(json["problems"].size(), 3);
  std::set<std::string> ways;
  int by_default = 0;
  for (const auto& row : json["rows"]) {
    EXPECT_THAT(keys(row),
                ElementsAre("scene",
                            "solver",
                            "start",
                            "peer",
                            "verified",
                            "starts",
                            "solved",
                            "success_rate",
                            "seconds_per_start",
                            "seconds_per_success",
                            "least_found",
                            "best_action_error"));
    ways.insert(row["solver"].get<std::string>() + " " + row["start"].get<std::string>());
    EXPECT_EQ(row["starts"], 1);
    EXPECT_LE(row["least_found"], row["solved"]);
    EXPECT_LE(row["solved"], row["starts"]);
    EXPECT_GT(row["seconds_per_start"], 0);
    EXPECT_EQ(row["seconds_per_success"].is_null(), row["solved"] == 0);
    EXPECT_EQ(row["best_action_error"].is_null(), row["solved"] == 0);
    if (row["solver"] == "ceres" && row["start"] == "path") by_default += row["solved"].get<int>();
  }
  EXPECT_EQ(ways.size(), 14);
  EXPECT_EQ(ways.count("nlopt:isres momentum"), 1);
  EXPECT_GT(by_default, 0);
  // More starts find no less.
  EXPECT_EQ(json["curve"].size(), 3 * 7);
  std::map<std::string, int> before;
  for (const auto& point : json["curve"]) {
    EXPECT_THAT(keys(point),
                ElementsAre("scene", "starts", "targets", "solved", "least", "seconds_per_start"));
    int& least = before[point["scene"]];
    EXPECT_GE(point["least"], least);
    EXPECT_LE(point["least"], point["solved"]);
    least = point["least"];
    if (point["starts"] == 64) {
      EXPECT_EQ(point["least"], point["solved"]);
    }
  }
  EXPECT_THAT(sandbox.files(), UnorderedElementsAre("solvers.md", "starts.png"));
  EXPECT_THAT(read_text(sandbox.directory() / "solvers.md"),
              AllOf(HasSubstr("## unicycle"), HasSubstr("| newton | path |")));
}

// All but the times.
TEST(BoundaryBenchmark, IsTheSameOnAnyNumberOfThreads) {
  const auto counts = [](const std::string& threads) {
    std::vector<std::string> lines;
    const auto json = run(few({"--json", "--seed", "5", "--threads", threads})).json();
    for (const auto& row : json["rows"]) {
      lines.push_back(row["scene"].dump() + row["solver"].dump() + row["start"].dump() +
                      row["solved"].dump() + row["least_found"].dump() +
                      row["best_action_error"].dump());
    }
    for (const auto& point : json["curve"]) {
      lines.push_back(point["scene"].dump() + point["solved"].dump() + point["least"].dump());
    }
    return lines;
  };
  EXPECT_EQ(counts("1"), counts("2"));
}

TEST(BoundaryBenchmark, RefusesBadInput) {
  const std::map<Words, std::string> cases{
      {{"benchmark", "vehicle", "--boundary-value"}, "SCENE 'vehicle'"},
      {{"benchmark", "--boundary-value", "--starts", "0"}, "--starts '0'"},
      {{"benchmark", "--boundary-value", "--targets", "x"}, "--targets 'x'"},
      {{"benchmark", "--boundary-value", "--output", "x.csv"}, "--output"},
      {{"benchmark", "--boundary-value", "--limits"}, "--limits"},
      {{"benchmark", "--seed", "3"}, "--boundary-value"}};
  for (const auto& [arguments, message] : cases) expect_refused(arguments, HasSubstr(message));
}

#ifdef CARNOT_PEERS
TEST(BoundaryBenchmark, RunsPeers) {
  const auto json =
      run({"benchmark", "--boundary-value", "--starts", "5", "--targets", "1", "--peers", "--json"})
          .json();
  std::map<std::string, int> solved;
  for (const auto& row : json["rows"]) {
    if (!row["peer"].get<bool>()) continue;
    solved[row["solver"]] += row["solved"].get<int>();
    constexpr double kGrid = 0.02;  // of 50 intervals
    if (row["solver"] == "ipopt") {
      EXPECT_LT(row["best_action_error"], kGrid);
    }
  }
  EXPECT_EQ(solved.size(), 2);
  EXPECT_GT(solved["ipopt"], 8);
  EXPECT_GT(solved["gsl-hybridsj"], 0);
}
#endif

}  // namespace
}  // namespace carnot::apps::cli_benchmark_boundary_test
