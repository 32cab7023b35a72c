#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "command.h"
#include "text/version.h"

namespace carnot::apps::cli_flow_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const Words kStraight{
    "flow", "vehicle", "--from", "0,0,0,0", "--momentum", "1,0,0,0", "--time", "5"};

TEST(FlowCommand, DrivesStraightExactly) {
  const Words words = with(kStraight, {"--steps", "10", "--json"});
  const Outcome outcome = run(words);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "scene",
                          "parameters",
                          "method",
                          "time",
                          "step",
                          "steps",
                          "status",
                          "message",
                          "time_reached",
                          "q",
                          "p",
                          "lambda",
                          "hamiltonian",
                          "action",
                          "energy_drift",
                          "constraint_error",
                          "evaluations",
                          "elapsed_seconds",
                          "trajectory"));
  EXPECT_EQ(json["version"], kVersion);
  EXPECT_EQ(json["arguments"].get<Words>(), words);
  EXPECT_EQ(json["scene"], "vehicle");
  EXPECT_EQ(json["parameters"].dump(), R"({"alpha":1,"beta":1,"length":1})");
  EXPECT_EQ(json["method"], "gauss16");
  EXPECT_EQ(json["time"], 5);
  EXPECT_EQ(json["step"], 0.5);
  EXPECT_EQ(json["steps"], 10);
  EXPECT_EQ(json["status"], "completed");
  EXPECT_EQ(json["message"], "");
  EXPECT_EQ(json["time_reached"], 5);
  EXPECT_EQ(json["hamiltonian"], 0.5);
  EXPECT_NEAR(json["action"].get<double>(), 2.5, 1e-14);
  const std::vector<double> end{5, 0, 0, 0};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(json["q"][i].get<double>(), end[i], 1e-14);
  EXPECT_EQ(json["lambda"].size(), 2);
  EXPECT_GE(json["evaluations"], 80);
}

TEST(FlowCommand, RecordsSamples) {
  const auto count = [](const Words& more) {
    const auto json = run(with(kStraight, with({"--steps", "7", "--json"}, more))).json();
    const auto& trajectory = json["trajectory"];
    EXPECT_THAT(keys(trajectory), ElementsAre("t", "q", "p", "lambda", "hamiltonian"));
    for (const auto& column : trajectory) EXPECT_EQ(column.size(), trajectory["t"].size());
    EXPECT_EQ(trajectory["t"].front(), 0);
    EXPECT_EQ(trajectory["t"].back(), 5);
    return trajectory["t"].size();
  };
  EXPECT_EQ(count({}), 201);
  EXPECT_EQ(count({"--samples", "2"}), 2);
  EXPECT_EQ(count({"--samples", "33"}), 33);
  const auto json = run(with(kStraight, {"--steps", "7", "--json", "--no-trajectory"})).json();
  EXPECT_FALSE(json.contains("trajectory"));
}

TEST(FlowCommand, EndsWithAShorterStep) {
  const auto json = run(with(kStraight, {"--step", "0.7", "--json"})).json();
  EXPECT_EQ(json["step"], 0.7);
  EXPECT_EQ(json["steps"], 8);
  EXPECT_EQ(json["time_reached"], 5);
}

TEST(FlowCommand, StartsAtStartTime) {
  const auto json = run(with(kStraight, {"--steps", "4", "--start-time", "-pi", "--json"})).json();
  EXPECT_EQ(json["time"], 5);
  EXPECT_DOUBLE_EQ(json["time_reached"].get<double>(), 5 - M_PI);
  EXPECT_DOUBLE_EQ(json["trajectory"]["t"][0].get<double>(), -M_PI);
}

// p = M q' - G' lambda at q = 0, where g1 = (0, -1, 0, 0), g2 = (0, -1, 1, 0).
TEST(FlowCommand, TurnsVelocityIntoMomentum) {
  const auto json = run({"flow",
                         "vehicle",
                         "--from",
                         "0,0,0,0",
                         "--velocity",
                         "2,0,0,3",
                         "--lambda",
                         "5,-7",
                         "--time",
                         "1e-9",
                         "--steps",
                         "1",
                         "--json"})
                        .json();
  const auto& p = json["trajectory"]["p"][0];
  EXPECT_THAT(p.get<std::vector<double>>(), ElementsAre(2, -2, 7, 3));
  const auto& lambda = json["trajectory"]["lambda"][0];
  EXPECT_NEAR(lambda[0].get<double>(), 5, 1e-14);
  EXPECT_NEAR(lambda[1].get<double>(), -7, 1e-14);
}

TEST(FlowCommand, ChoosesStepsForATolerance) {
  const Words start{
      "flow", "heisenberg", "--from", "0,0,0", "--momentum", "0.1,0.3,1", "--time", "20", "--json"};
  const auto exact = run(with(start, {"--steps", "400"})).json();
  for (const auto& [method, tolerance] :
       std::vector<std::pair<std::string, double>>{{"gauss4", 1e-6}, {"gauss16", 1e-12}}) {
    const auto json =
        run(with(start,
                 {"--method", method, "--tolerance", std::to_string(tolerance * 1e12) + "/1e12"}))
            .json();
    EXPECT_EQ(json["status"], "completed");
    EXPECT_EQ(json["method"], method);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(json["q"][i].get<double>(), exact["q"][i].get<double>(), 2 * tolerance);
    }
  }
}

TEST(FlowCommand, GivesTheTangentMap) {
  const auto json = run(with(kStraight, {"--steps", "20", "--tangent", "--json"})).json();
  ASSERT_EQ(json["tangent"].size(), 8);
  for (const auto& row : json["tangent"]) EXPECT_EQ(row.size(), 8);
  EXPECT_NEAR(json["tangent"][0][4].get<double>(), 5, 1e-13);  // dx(T)/dp_x = T
  EXPECT_GE(json["symplecticity_defect"], json["symplecticity_defect_relative"]);
  EXPECT_LT(json["symplecticity_defect_relative"], 1e-14);
}

TEST(FlowCommand, FailsWithAMessage) {
  for (const Words& more :
       {Words{"--momentum", "1e300,0,0,1e300", "--steps", "5"},
        Words{"--momentum", "1,2,3,4", "--tolerance", "1e-14", "--method", "midpoint"}}) {
    const Sandbox sandbox;
    const Outcome outcome = sandbox.run(
        with({"flow", "vehicle", "--from", "0,0,0,0", "--time", "5", "--json", "--output", "a.csv"},
             more));
    EXPECT_EQ(outcome.status, 1);
    const auto json = outcome.json();
    EXPECT_EQ(json["status"], "failed");
    EXPECT_NE(json["message"], "");
    EXPECT_EQ(json["time_reached"], 0);
    EXPECT_EQ(json["q"].size(), 4);
    EXPECT_THAT(outcome.err, HasSubstr(json["message"].get<std::string>()));
    EXPECT_THAT(sandbox.files(), IsEmpty());
  }
}

TEST(FlowCommand, ReadsBackExactly) {
  const Words start{"flow", "vehicle", "--time", "1", "--steps", "3", "--json"};
  const auto first =
      run(with(start, {"--from", "0.1,0.2,1/3,pi/7", "--momentum", "1,2,3,4"})).json();
  const auto text = [](const nlohmann::ordered_json& list) {
    std::ostringstream out;
    out.precision(17);
    for (const auto& x : list) out << (out.tellp() > 0 ? "," : "") << x.get<double>();
    return out.str();
  };
  const auto& q = first["trajectory"]["q"][0];
  const auto& p = first["trajectory"]["p"][0];
  const auto second = run(with(start, {"--from", text(q), "--momentum", text(p)})).json();
  EXPECT_EQ(first["q"], second["q"]);
  EXPECT_EQ(first["p"], second["p"]);
}

TEST(FlowCommand, PrintsForPeopleToo) {
  const Outcome outcome = run(with(kStraight, {"--steps", "10"}));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, StartsWith("vehicle: 10 steps of gauss16 to t = 5, completed"));
  EXPECT_EQ(outcome.err, "");
}

}  // namespace
}  // namespace carnot::apps::cli_flow_test
