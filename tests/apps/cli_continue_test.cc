#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "command.h"

namespace carnot::apps::cli_continue_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

Words unicycle(const Words& more) {
  return with({"continue", "unicycle", "--from", "0,0,0", "--to", "1,1,0"}, more);
}

// To a target where the extremal of second least action has a fold on the way down.
Words folding(const Words& more) {
  return with({"continue",
               "heisenberg-group",
               "--from",
               "0,0,0",
               "--to",
               "0.5,0,0.5",
               "--rank",
               "2",
               "--along",
               "to=0.5,0,0"},
              more);
}

TEST(ContinueCommand, KeepsTheContract) {
  const Outcome outcome = run(unicycle({"--along", "to=2,1,1", "--json"}));
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
                          "along",
                          "status",
                          "message",
                          "points",
                          "folds",
                          "branch_points",
                          "branch_status",
                          "elapsed_seconds"));
  EXPECT_EQ(json["status"], "reached");
  EXPECT_EQ(json["along"].dump(), R"({"name":"to","start":[1,1,0],"end":[2,1,1]})");
  EXPECT_THAT(keys(json["points"][0]),
              ElementsAre("branch",
                          "s",
                          "value",
                          "p0",
                          "lambda0",
                          "action",
                          "length",
                          "verification",
                          "endpoint_error",
                          "knot_defect",
                          "morse_index",
                          "label"));
  EXPECT_EQ(json["points"].front()["s"], 0);
  EXPECT_EQ(json["points"].back()["s"], 1);
  EXPECT_EQ(json["points"].back()["value"].dump(), "[2,1,1]");
  for (const auto& point : json["points"]) EXPECT_LE(point["endpoint_error"], 1e-10);
}

TEST(ContinueCommand, ListsFolds) {
  const auto json = run(folding({"--json"})).json();
  EXPECT_EQ(json["status"], "returned");
  ASSERT_EQ(json["folds"].size(), 1);
  EXPECT_THAT(json["branch_points"], IsEmpty());
  const Outcome text = run(folding({}));
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("fold at to = (0.5, 0, 0.2808380911)"));
}

TEST(ContinueCommand, ArrivesWhereSolvingAnewDoes) {
  for (const Words& change : {Words{"beta=2", "--set", "beta=2"}, Words{"time=2", "--time", "2"}}) {
    const auto followed = run(unicycle({"--along", change[0], "--json"})).json();
    ASSERT_EQ(followed["status"], "reached") << change[0];
    Words anew = unicycle({change[1], change[2], "--json", "--no-trajectory"});
    anew[0] = "geodesic";
    const auto solved = run(anew).json();
    const auto& last = followed["points"].back();
    EXPECT_EQ(last["value"], 2);
    EXPECT_NEAR(last["action"], solved["geodesics"][0]["action"], 1e-9);
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(last["p0"][j], solved["geodesics"][0]["p0"][j], 1e-8);
    }
  }
}

TEST(ContinueCommand, StartsFromAGuess) {
  const auto found = run(unicycle({"--along", "from=0.1,0,0", "--json", "--no-labels"})).json();
  std::string p0 = found["points"][0]["p0"].dump();
  p0 = p0.substr(1, p0.size() - 2);
  const auto guessed =
      run(unicycle({"--along", "from=0.1,0,0", "--guess", p0, "--json", "--no-labels"})).json();
  EXPECT_EQ(guessed["status"], "reached");
  EXPECT_TRUE(guessed["points"][0]["morse_index"].is_null());
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(guessed["points"].back()["p0"][j], found["points"].back()["p0"][j], 1e-8);
  }
}

TEST(ContinueCommand, KeepsFreeEnds) {
  const Words words{"continue", "vehicle", "--from", "0,0,0,0", "--to", "0,1,0,*", "--json"};
  const auto json = run(with(words, {"--along", "to=0,0.5,0,*"})).json();
  EXPECT_EQ(json["status"], "reached");
  EXPECT_EQ(json["to"].dump(), "[0,1,0,null]");
  for (const auto& point : json["points"]) EXPECT_LE(point["transversality_error"], 1e-9);
  const Outcome other = run(with(words, {"--along", "to=0,0.5,0,1"}));
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("other coordinates are free than at the start"));
}

TEST(ContinueCommand, WritesFiles) {
  const Sandbox sandbox;
  const Outcome outcome =
      sandbox.run(folding({"--quiet", "--plot", "curve.png", "--output", "curve.csv"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const std::string csv = read_text(sandbox.directory() / "curve.csv");
  EXPECT_THAT(csv,
              StartsWith("branch,s,to_x,to_y,to_z,action,length,endpoint_error,knot_defect,"
                         "morse_index,label,p_x,p_y,p_z\n0,0,0.5,0,0.5,"));
  EXPECT_GT(std::filesystem::file_size(sandbox.directory() / "curve.png"), 10000U);
}

TEST(ContinueCommand, StopsAtTheLargestNumberOfPoints) {
  const Outcome outcome = run(folding({"--max-points", "3", "--json"}));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.json()["status"], "max_points");
  EXPECT_EQ(outcome.json()["points"].size(), 3);
}

TEST(ContinueCommand, NumericalFailureIsOneLine) {
  const Outcome abnormal = run({"continue",
                                "vehicle",
                                "--from",
                                "0,0,0,0",
                                "--to",
                                "0,0,0,1",
                                "--along",
                                "to=0,0,0,2",
                                "--json",
                                "--quiet"});
  EXPECT_EQ(abnormal.status, 1);
  EXPECT_EQ(abnormal.json()["status"], "singular_start");
  EXPECT_THAT(abnormal.err, StartsWith("carnot: the extremal at the start"));
  EXPECT_EQ(std::count(abnormal.err.begin(), abnormal.err.end(), '\n'), 1);

  const Outcome astray =
      run(unicycle({"--along", "to=2,1,1", "--guess", "4000,-2000,1e5", "--json", "--quiet"}));
  EXPECT_EQ(astray.status, 1);
  EXPECT_EQ(astray.json()["status"], "not_converged");
  EXPECT_EQ(std::count(astray.err.begin(), astray.err.end(), '\n'), 1);

  const Outcome rank = run({"continue",
                            "heisenberg-group",
                            "--from",
                            "0,0,0",
                            "--to",
                            "1,0,0.1",
                            "--rank",
                            "2",
                            "--along",
                            "to=1,0,1",
                            "--quiet"});
  EXPECT_EQ(rank.status, 1);
  EXPECT_THAT(rank.err, HasSubstr("--rank"));
}

// Sideways parking while the wheel turns less and less.
Words tightening(const Words& more) {
  return with({"continue",
               "vehicle",
               "--from",
               "0,0,0,0",
               "--to",
               "0,1,0,0",
               "--limit",
               "phi-theta in -0.5:0.5",
               "--max-points",
               "100"},
              more);
}

TEST(ContinueCommand, MovesLimits) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run(tightening(
      {"--along", "limit:phi-theta=0.44", "--json", "--plot", "l.png", "--output", "l.csv"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json["along"].dump(), R"({"name":"limit:phi-theta","start":0.5,"end":0.44})");
  EXPECT_THAT(keys(json["points"][0]), IsSupersetOf({"limits", "limit_violation"}));
  ASSERT_EQ(json["contact_changes"].size(), 1);
  const auto& change = json["contact_changes"][0];
  EXPECT_THAT(keys(change), ElementsAre("s", "s_error", "value", "before", "after", "action"));
  EXPECT_EQ(change["before"].dump(), "[]");
  EXPECT_EQ(change["after"].dump(), R"(["phi-theta"])");
  EXPECT_NEAR(change["value"].get<double>(), 0.45727, 1e-4);
  EXPECT_THAT(read_text(sandbox.directory() / "l.csv"),
              StartsWith("branch,s,limit:phi-theta,action"));
  EXPECT_THAT(sandbox.files(), UnorderedElementsAre("l.csv", "l.png"));

  const Outcome text = run(tightening({"--along", "limit:phi-theta=-0.5:0.45"}));
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("goes over from no limit to phi-theta"));
}

// The axis says which number it is.
TEST(ContinueCommand, NamesTheOneNumberOfADiscThatChanges) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"continue",
                                       "unicycle",
                                       "--from",
                                       "0,0,0",
                                       "--to",
                                       "2,0,0.3",
                                       "--disc",
                                       "1,-0.5,0.2",
                                       "--along",
                                       "disc:1=1,-0.5,0.3",
                                       "--quiet",
                                       "--plot",
                                       "d.svg"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(read_text(sandbox.directory() / "d.svg"), HasSubstr("radius of disc 1"));
}

TEST(ContinueCommand, MovesDiscsAndKeepsToLimitsAlongParameters) {
  const auto disc = run({"continue",
                         "unicycle",
                         "--from",
                         "0,0,0",
                         "--to",
                         "2,0,0.3",
                         "--disc",
                         "1,-0.4,0.2",
                         "--along",
                         "disc:1=1,-0.2,0.3",
                         "--json"})
                        .json();
  EXPECT_EQ(disc["status"], "reached");
  EXPECT_EQ(disc["along"]["end"].dump(), "[1,-0.2,0.3]");
  EXPECT_EQ(disc["contact_changes"].size(), 1);
  const auto longer = run(tightening({"--along", "length=1.1", "--json"})).json();
  EXPECT_EQ(longer["status"], "reached");
  EXPECT_EQ(longer["points"].back()["limits"][0]["name"], "phi-theta");
}

TEST(ContinueCommand, BadInputIsOneLine) {
  const std::vector<std::pair<Words, std::string>> cases{
      {unicycle({}), "--along"},
      {unicycle({"--along", "to"}), "there is no '='"},
      {unicycle({"--along", "bta=2"}), "did you mean beta?"},
      {unicycle({"--along", "to=1,2"}), "2 numbers given"},
      {unicycle({"--along", "from=0,0,nan"}), "--along from"},
      {unicycle({"--along", "beta=-1"}), "out of range"},
      {unicycle({"--along", "time=0"}), "--along time"},
      {unicycle({"--along", "time=1"}), "is where it starts"},
      {unicycle({"--along", "time=2", "--max-points", "0"}), "--max-points"},
      {unicycle({"--along", "time=2", "--rank", "2", "--guess", "1,2,3"}), "--rank"},
      {unicycle({"--along", "time=2", "--guess", "1,2"}), "--guess"},
      {unicycle({"--along", "time=2", "--output", "a.txt"}), "--output"},
      {unicycle({"--along", "limit:theta=0.2"}), "no such limit"},
      {unicycle({"--along", "disc:1=0,1,1"}), "no such --disc"},
      {tightening({"--along", "limit:phi-theta=0.5"}), "is where it starts"},
      {tightening({"--along", "limit:phi-theta=-0.2"}), "--along limit:phi-theta"},
      {tightening({"--along", "limit:phi-theta=0.3:0.2"}), "is empty"},
      {tightening({"--along", "limit:theta=0.2"}),
       "accepted: to=Q1, from=Q0, time=T, limit:phi-theta"},
      {tightening({"--along", "disc:2=0,1,1"}), "no such --disc"},
      {tightening({"--along", "time=2", "--branches"}), "--branches"},
      {{"continue", "unicycle", "--to", "1,0,0", "--along", "time=2"}, "--from"},
      {{"continue", "rod-skate", "--from", "0,0,1,0", "--to", "1,0,2,0", "--along", "time=2"},
       "holonomic"},
      {{"continue",
        "satellite-quaternion",
        "--from",
        "1,0,0,0",
        "--to",
        "0,1,0,0",
        "--along",
        "to=0,0,1,0"},
       "leaves the holonomic constraints"}};
  for (const auto& [words, what] : cases) expect_refused(words, HasSubstr(what));
}

TEST(ContinueCommand, CanBeInterrupted) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"continue",
                                       "vehicle",
                                       "--set",
                                       "length=2.5",
                                       "--from",
                                       "0,0,0,0",
                                       "--to",
                                       "0,1,0,0",
                                       "--along",
                                       "to=19,9,1,0",
                                       "--rank",
                                       "500",
                                       "--output",
                                       "curve.json",
                                       "--quiet"},
                                      stopped_after("0.5"));
  EXPECT_EQ(outcome.status, 130);
  EXPECT_THAT(sandbox.files(), IsEmpty());
}

}  // namespace
}  // namespace carnot::apps::cli_continue_test
