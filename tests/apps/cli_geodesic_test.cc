#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "command.h"

namespace carnot::apps::cli_geodesic_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Words parking(const Words& more) {
  return with({"geodesic", "vehicle", "--from", "0,0,0,0", "--to", "0,1,0,0"}, more);
}

TEST(GeodesicCommand, KeepsTheContract) {
  const Outcome outcome = run(parking({"--json", "--samples", "11"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "scene",
                          "parameters",
                          "from",
                          "to",
                          "time",
                          "method",
                          "status",
                          "reason",
                          "message",
                          "geodesics",
                          "starts",
                          "converged_starts",
                          "distinct_hit",
                          "missed_estimate",
                          "elapsed_seconds"));
  EXPECT_EQ(json["status"], "converged");
  EXPECT_TRUE(json["reason"].is_null());
  EXPECT_EQ(json["to"].dump(), "[0,1,0,0]");
  ASSERT_EQ(json["geodesics"].size(), 1);
  const auto& geodesic = json["geodesics"][0];
  EXPECT_THAT(keys(geodesic),
              ElementsAre("p0",
                          "lambda0",
                          "action",
                          "length",
                          "verification",
                          "endpoint_error",
                          "knot_defect",
                          "constraint_error",
                          "energy_drift",
                          "conjugate_times",
                          "label",
                          "abnormal",
                          "morse_index",
                          "family_dimension",
                          "rank_in_list",
                          "hits",
                          "largest_steering_angle",
                          "trajectory"));
  EXPECT_EQ(geodesic["p0"].size(), 4);
  EXPECT_EQ(geodesic["lambda0"].size(), 2);
  EXPECT_EQ(geodesic["verification"], "single");
  EXPECT_TRUE(geodesic["knot_defect"].is_null());
  EXPECT_LE(geodesic["endpoint_error"], 1e-10);
  EXPECT_EQ(geodesic["rank_in_list"], 1);
  EXPECT_EQ(geodesic["trajectory"]["t"].size(), 11);
}

// V = 0: action = length^2 / (2 T).
TEST(GeodesicCommand, ActionAndLengthAgree) {
  const auto json = run(parking({"--json", "--time", "2"})).json();
  const auto& geodesic = json["geodesics"][0];
  const double length = geodesic["length"];
  EXPECT_NEAR(geodesic["action"].get<double>(), length * length / 4, 1e-8);
}

TEST(GeodesicCommand, ListsLeastActionFirst) {
  const auto json = run(parking({"--json", "--count", "3", "--no-trajectory"})).json();
  double last = 0;
  for (const auto& geodesic : json["geodesics"]) {
    EXPECT_GE(geodesic["action"].get<double>(), last - 1e-9);
    last = geodesic["action"];
    EXPECT_FALSE(geodesic.contains("trajectory"));
  }
  EXPECT_GE(json["geodesics"].size(), 1);
  EXPECT_LE(json["geodesics"].size(), 3);
}

TEST(GeodesicCommand, FlowOfItsMomentumArrives) {
  const auto geodesics = run(parking({"--json"})).json()["geodesics"];
  std::string p0 = geodesics[0]["p0"].dump();  // "[1.5,...]", shortest digits that read back
  p0 = p0.substr(1, p0.size() - 2);
  const auto flow = run({"flow",
                         "vehicle",
                         "--from",
                         "0,0,0,0",
                         "--momentum",
                         p0,
                         "--time",
                         "1",
                         "--tolerance",
                         "1e-12",
                         "--json"})
                        .json();
  const std::vector<double> to{0, 1, 0, 0};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(flow["q"][i].get<double>(), to[i], 1e-9);
}

TEST(GeodesicCommand, WithEqualEndsStays) {
  const auto json =
      run({"geodesic", "vehicle", "--from", "1,2,pi/2,0", "--to", "1,2,pi/2,0", "--json"}).json();
  ASSERT_EQ(json["geodesics"].size(), 1);
  EXPECT_EQ(json["geodesics"][0]["action"], 0);
  EXPECT_EQ(json["geodesics"][0]["p0"].dump(), "[0,0,0,0]");
}

TEST(GeodesicCommand, FailureHasACode) {
  const Outcome outcome = run(
      {"geodesic", "unicycle", "--from", "0,0,0", "--to", "0,1,0", "--max-length", "2", "--json"});
  EXPECT_EQ(outcome.status, 1);
  const auto json = outcome.json();
  EXPECT_EQ(json["status"], "not_converged");
  EXPECT_EQ(json["reason"], "too-long");
  EXPECT_THAT(json["message"].get<std::string>(), HasSubstr("larger --max-length"));
  EXPECT_TRUE(json["geodesics"].empty());
}

// On the line y = 0 of a metric that changes across it no momentum leads along the shortest path.
TEST(GeodesicCommand, SaysThatAPathIsStrictlyAbnormal) {
  const Words words{"geodesic",
                    CARNOT_SOURCE_DIR "/docs/examples/scenes/martinet-perturbed.scene",
                    "--set",
                    "alpha=0.3",
                    "--set",
                    "beta=0.2",
                    "--set",
                    "gamma=0",
                    "--from",
                    "0,0,0",
                    "--to=-1,0,0"};
  const Outcome table = run(words);
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("abnormal  -\n"));
  EXPECT_THAT(table.out, HasSubstr("strictly abnormal"));
  EXPECT_THAT(table.out + table.err, Not(HasSubstr("--starts")));
  const auto json = run(with(words, {"--json", "--samples", "3"})).json();
  EXPECT_EQ(json["status"], "converged");
  EXPECT_TRUE(json["reason"].is_null());
  EXPECT_TRUE(json["missed_estimate"].is_null());
  ASSERT_EQ(json["geodesics"].size(), 1);
  const auto& line = json["geodesics"][0];
  EXPECT_EQ(line["label"], "abnormal");
  EXPECT_EQ(line["abnormal"], true);
  EXPECT_NEAR(line["length"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(line["action"].get<double>(), 0.5, 1e-12);
  for (const char* key : {"p0", "lambda0", "conjugate_times", "morse_index", "energy_drift"}) {
    EXPECT_TRUE(line[key].is_null()) << key;
  }
  EXPECT_NEAR(line["trajectory"]["q"][1][0].get<double>(), -0.5, 1e-12);
  EXPECT_EQ(line["trajectory"]["p"][1].dump(), "[null,null,null]");
  Words along = words;
  along[0] = "continue";
  const Outcome followed = run(with(along, {"--along", "to=-2,0,0"}));
  EXPECT_EQ(followed.status, 1);
  EXPECT_THAT(followed.err, HasSubstr("not on one curve (abnormal"));
}

// A whole turn is no way at all where angles agree modulo 2 pi.
TEST(GeodesicCommand, ModAngles) {
  const Words words{"geodesic", "unicycle", "--from", "0,0,0", "--to", "0,0,2*pi", "--json"};
  const auto cover = run(words).json()["geodesics"][0];
  EXPECT_NEAR(cover["length"].get<double>(), 6.283185307179586, 1e-12);
  EXPECT_FALSE(cover.contains("windings"));
  Words modulo = words;
  modulo.emplace_back("--mod-angles");
  const auto identified = run(modulo).json()["geodesics"][0];
  EXPECT_EQ(identified["action"], 0);
  EXPECT_EQ(identified["windings"].dump(), "[0,0,-1]");
}

TEST(GeodesicCommand, TakesFreeEnds) {
  const Words words{"geodesic", "vehicle", "--from", "0,0,0,*", "--to", "0,1,0,*"};
  const Outcome table = run(words);
  EXPECT_THAT(table.out, HasSubstr("from (0, 0, 0, *) to (0, 1, 0, *)"));
  const auto json = run(with(words, {"--json"})).json();
  EXPECT_EQ(json["from"].dump(), "[0,0,0,null]");
  EXPECT_EQ(json["to"].dump(), "[0,1,0,null]");
  const auto& geodesic = json["geodesics"][0];
  EXPECT_LE(geodesic["endpoint_error"].get<double>(), 1e-10);
  EXPECT_LE(geodesic["transversality_error"].get<double>(), 1e-9);
  EXPECT_EQ(geodesic["p0"][3], 0);
  const auto& q = geodesic["trajectory"]["q"];
  for (const int j : {0, 1, 2, 3}) {
    EXPECT_NEAR(geodesic["from_found"][j], q.front()[j], 1e-12);
    EXPECT_NEAR(geodesic["to_found"][j], q.back()[j], 1e-9);
  }
  EXPECT_EQ(geodesic["to_found"][1], 1);
  EXPECT_NE(geodesic["to_found"][3], 0);
  EXPECT_EQ(run(parking({"--json"})).json()["geodesics"][0].count("to_found"), 0);
}

TEST(GeodesicCommand, KeepsToLimits) {
  const Words limits{"--limit", "phi-theta in -0.3:0.3", "--limit", "x in :5", "--disc", "9,9,1"};
  const Outcome table = run(parking(limits));
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("slack"));
  EXPECT_THAT(table.out, HasSubstr("(knots)"));
  const auto json = run(parking(with(limits, {"--json"}))).json();
  const auto& geodesic = json["geodesics"][0];
  EXPECT_NEAR(geodesic["action"], 23.275244006, 1e-8);
  EXPECT_EQ(geodesic["verification"], "knots");
  EXPECT_LE(geodesic["limit_violation"], 1e-10);
  const auto& list = geodesic["limits"];
  ASSERT_EQ(list.size(), 5);  // two limits, and three points of the body beside the disc
  EXPECT_EQ(list[0]["name"], "phi-theta");
  EXPECT_EQ(list[0]["active"].size(), 4);
  EXPECT_GT(list[0]["largest_multiplier"], 0);
  EXPECT_EQ(list[1]["name"], "x");
  EXPECT_GT(list[1]["lowest_slack"], 0);
  EXPECT_EQ(list[2]["name"], "disc 1, front");
  EXPECT_EQ(list[4]["name"], "disc 1, rear");
  EXPECT_TRUE(list[4]["active"].empty());
}

TEST(GeodesicCommand, RefusesLimitsThatAreNone) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"phi in :", "has no bound"},
      {"phi in 1", "is no range of an expression"},
      {" in 0:1", "is no range of an expression"},
      {"ph in 0:1", "'ph' is not known"},
      {"phi in 1:0", "not below the upper one"},
      {"phi in a:1", "not a finite number"},
      {"2 in 0:1", "depends on no coordinate"},
      {"phi) + (x in 0:1", "expected"},
      {"phi\nlimit x in 0:1", "a character that no formula has"}};
  for (const auto& [limit, expected] : cases) {
    const Outcome outcome = run(parking({"--limit", limit}));
    EXPECT_EQ(outcome.status, 2) << limit;
    EXPECT_THAT(outcome.err, HasSubstr(expected)) << limit;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST(GeodesicCommand, EndsWhenItsTimeIsUp) {
  const Words words{
      "geodesic", "heisenberg-group", "--from", "0,0,0", "--to", "0.4,0.1,0.5", "--json"};
  const auto json = run(with(words, {"--all", "--max-length", "9", "--time-limit", "0.2"})).json();
  EXPECT_THAT(json["message"], HasSubstr("the time limit of 0.2 s was up"));
  EXPECT_LT(json["starts"], 1200);  // what --all takes without it
  const auto generous = run(with(words, {"--time-limit", "100"})).json();
  EXPECT_EQ(generous["status"], "converged");
  EXPECT_EQ(generous["message"], "");
  EXPECT_EQ(generous["geodesics"].dump(), run(words).json()["geodesics"].dump());
}

TEST(GeodesicCommand, SaysWhichLimitCannotBeKept) {
  const Outcome end = run(parking({"--limit", "y in 0.5:", "--json"}));
  EXPECT_EQ(end.status, 1);
  EXPECT_EQ(end.json()["reason"], "limit-at-end");
  EXPECT_THAT(end.err, HasSubstr("the start is beyond the limit 'y' by 0.5"));
}

TEST(GeodesicCommand, DoesNotDependOnThreads) {
  const auto answer = [](const char* threads) {
    auto json = run(parking({"--json", "--threads", threads, "--seed", "7"})).json();
    return json["geodesics"].dump();
  };
  EXPECT_EQ(answer("1"), answer("3"));
}

TEST(GeodesicCommand, WritesFiles) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run(
      parking({"--count", "2", "--samples", "5", "--output", "a.csv", "--plot", "a.png"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  auto files = sandbox.files();
  std::sort(files.begin(), files.end());
  EXPECT_THAT(files, ElementsAre("a.csv", "a.png"));
  EXPECT_THAT(read_text(sandbox.directory() / "a.csv"), HasSubstr("t,q_x,q_y,q_theta,q_phi,p_x"));
  EXPECT_THAT(outcome.out, StartsWith("vehicle: "));
  EXPECT_THAT(outcome.out, HasSubstr("written: a.png"));
  EXPECT_EQ(outcome.err, "");
}

}  // namespace
}  // namespace carnot::apps::cli_geodesic_test
