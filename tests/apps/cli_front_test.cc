// carnot front: the contract, refusals, and what does not change the answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "command.h"

namespace carnot::apps::cli_front_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Words unicycle(const Words& more) {
  return with({"front", "unicycle", "--from", "0,0,0", "--what", "cut"}, more);
}

TEST(FrontCommand, KeepsTheContract) {
  const Outcome outcome = run(unicycle({"--momentum", "0.4,0.3,0.9", "--json"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "scene",
                          "parameters",
                          "from",
                          "momentum",
                          "method",
                          "status",
                          "message",
                          "cut_time",
                          "conjugate_time",
                          "partner_p0",
                          "label",
                          "max_time",
                          "searches",
                          "elapsed_seconds"));
  const double speed = std::hypot(0.4, 0.9);
  const double rho = 0.5 / speed;
  EXPECT_NEAR(json["cut_time"].get<double>(), 2 * std::comp_ellint_1(rho) / speed, 1e-11);
  EXPECT_TRUE(json["conjugate_time"].is_null());
  EXPECT_NEAR(json["partner_p0"][2].get<double>(), -0.9, 1e-10);
  EXPECT_EQ(json["label"], "reversal");
  EXPECT_EQ(json["status"], "converged");
}

TEST(FrontCommand, HasNullsWhereThereIsNone) {
  const Outcome none = run(unicycle({"--momentum", "0.4,0.3,0.9", "--max-time", "1", "--json"}));
  ASSERT_EQ(none.status, 0) << none.err;
  EXPECT_TRUE(none.json()["cut_time"].is_null());
  EXPECT_TRUE(none.json()["partner_p0"].is_null());
  EXPECT_EQ(none.json()["label"], "none-found");
  const Outcome family = run({"front",
                              "heisenberg-group",
                              "--from",
                              "0,0,0",
                              "--momentum",
                              "1,0,2",
                              "--what",
                              "cut",
                              "--json"});
  EXPECT_TRUE(family.json()["partner_p0"].is_null());
  EXPECT_EQ(family.json()["label"], "conjugate");
  EXPECT_NEAR(family.json()["cut_time"].get<double>(), std::numbers::pi, 1e-12);
}

TEST(FrontCommand, TakesParametersTextsAndAnyNumberOfThreads) {
  // Lengths in another unit: beta x, beta^2 p.
  const auto one = run(unicycle({"--momentum", "0.4,0.3,0.9", "--json"})).json();
  const auto two =
      run(unicycle({"--momentum", "0.2,0.15,0.9", "--set", "beta=2", "--threads", "1", "--json"}))
          .json();
  EXPECT_NEAR(two["cut_time"].get<double>(), 4 * one["cut_time"].get<double>(), 1e-10);
  const auto again =
      run(unicycle({"--momentum", "0.4,0.3,0.9", "--threads", "1", "--json"})).json();
  EXPECT_EQ(again["cut_time"], one["cut_time"]);
  EXPECT_EQ(again["partner_p0"], one["partner_p0"]);
  const Sandbox sandbox;
  const Outcome text = sandbox.run({"scenes", "unicycle", "--text"});
  std::ofstream(sandbox.directory() / "wheel.scene") << text.out;
  const Outcome by_text = sandbox.run({"front",
                                       "wheel.scene",
                                       "--from",
                                       "0,0,0",
                                       "--momentum",
                                       "0.4,0.3,0.9",
                                       "--what",
                                       "cut",
                                       "--json"});
  ASSERT_EQ(by_text.status, 0) << by_text.err;
  EXPECT_NEAR(by_text.json()["cut_time"].get<double>(), one["cut_time"].get<double>(), 1e-11);
}

TEST(FrontCommand, WritesSurfaces) {
  const Sandbox sandbox;
  const Words sphere{"front",
                     "heisenberg-group",
                     "--from",
                     "0,0,0",
                     "--what",
                     "sphere",
                     "--length",
                     "1",
                     "--edge",
                     "0.5",
                     "--check",
                     "--json",
                     "--output"};
  const Outcome outcome = sandbox.run(with(sphere, {"s.csv"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "scene",
                          "parameters",
                          "from",
                          "method",
                          "what",
                          "status",
                          "message",
                          "surfaces"));
  EXPECT_THAT(keys(json["surfaces"][0]),
              ElementsAre("length",
                          "vertices",
                          "triangles",
                          "left_out",
                          "closed",
                          "euler_characteristic",
                          "volume",
                          "searches",
                          "elapsed_seconds"));
  EXPECT_EQ(json["surfaces"][0]["euler_characteristic"], 2);
  const std::string csv = read_text(sandbox.directory() / "s.csv");
  EXPECT_THAT(csv, ::testing::StartsWith("q_x,q_y,q_z,p0_x,p0_y,p0_z,t_cut,t_conj,length,label\n"));
  const long vertices = json["surfaces"][0]["vertices"].get<long>();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), vertices + 1);
  ASSERT_EQ(sandbox.run(with(sphere, {"s.ply"})).status, 0);
  const std::string ply = read_text(sandbox.directory() / "s.ply");
  EXPECT_THAT(ply, HasSubstr("element vertex " + std::to_string(vertices) + "\n"));
  EXPECT_THAT(ply, HasSubstr("comment label: 0 front, 1 sphere, "));
  EXPECT_THAT(ply, HasSubstr("property double length\nproperty int label\n"));
  ASSERT_EQ(sandbox.run(with(sphere, {"s.vtp"})).status, 0);
  const std::string vtp = read_text(sandbox.directory() / "s.vtp");
  EXPECT_THAT(vtp, HasSubstr("NumberOfPoints=\"" + std::to_string(vertices) + "\""));
  EXPECT_THAT(vtp, HasSubstr("<DataArray type=\"Int32\" Name=\"label\""));
}

TEST(FrontCommand, WritesAndDrawsCurves) {
  const Sandbox sandbox;
  const Words front{"front", "grushin", "--from", "0,0", "--what", "front", "--length", "0.5,1"};
  const Outcome outcome =
      sandbox.run(with(front, {"--json", "--output", "c.vtp", "--plot", "c.svg"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto surfaces = outcome.json()["surfaces"];
  ASSERT_EQ(surfaces.size(), 2U);
  const long segments = surfaces[0]["segments"].get<long>() + surfaces[1]["segments"].get<long>();
  EXPECT_THAT(read_text(sandbox.directory() / "c.vtp"),
              HasSubstr("NumberOfLines=\"" + std::to_string(segments) + "\""));
  EXPECT_THAT(read_text(sandbox.directory() / "c.svg"), HasSubstr("length 0.5"));
  ASSERT_EQ(sandbox.run(with(front, {"--output", "c.ply"})).status, 0);
  EXPECT_THAT(read_text(sandbox.directory() / "c.ply"),
              HasSubstr("element edge " + std::to_string(segments) + "\n"));
}

TEST(FrontCommand, DrawsSurfaces) {
  const Sandbox sandbox;
  const Words front{"front",
                    "heisenberg-group",
                    "--from",
                    "0,0,0",
                    "--what",
                    "front",
                    "--length",
                    "0.5,1",
                    "--edge",
                    "1",
                    "--vertices",
                    "1600",
                    "--plot"};
  const Outcome outcome = sandbox.run(with(front, {"f.svg"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(read_text(sandbox.directory() / "f.svg"), HasSubstr("section at y = 0"));
}

// In a .gif every frame begins with a graphic control extension.
int frames_of(const std::string& gif) {
  const std::string mark{'\x21', '\xf9', '\x04'};
  int frames = 0;
  for (auto at = gif.find(mark); at != std::string::npos; at = gif.find(mark, at + 1)) ++frames;
  return frames;
}

TEST(FrontCommand, GrowsFrontsInAnAnimation) {
  const Sandbox sandbox;
  const Words plane{"front", "grushin", "--from", "0,0", "--what", "front", "--vertices", "1600"};
  const Words space{
      "front", "heisenberg-group", "--from", "0,0,0", "--what", "front", "--vertices", "1600"};
  for (const Words& front : {plane, space}) {
    SCOPED_TRACE(front[1]);
    const Outcome outcome = sandbox.run(with(front, {"--length", "0.4,0.7,1", "--plot", "f.gif"}));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(frames_of(read_text(sandbox.directory() / "f.gif")), 3);
    ASSERT_EQ(sandbox.run(with(front, {"--length", "1", "--plot", "f.gif"})).status, 0);
    EXPECT_LE(frames_of(read_text(sandbox.directory() / "f.gif")), 1);
  }
}

TEST(FrontCommand, GivesSurfacesUpWhenTimeIsUp) {
  const Sandbox sandbox;
  const Outcome late = sandbox.run(
      unicycle({"--length", "1", "--time-limit", "1e-9", "--output", "a.csv", "--json"}));
  EXPECT_EQ(late.status, 1);
  EXPECT_EQ(late.json()["status"], "failed");
  EXPECT_THAT(late.err, HasSubstr("time limit"));
  EXPECT_TRUE(sandbox.files().empty());
}

TEST(FrontCommand, FixesMomentaOfASection) {
  const Outcome outcome = run({"front",
                               "engel",
                               "--from",
                               "0,0,0,0",
                               "--what",
                               "front",
                               "--length",
                               "0.5,1",
                               "--fix",
                               "p_x4=0",
                               "--project",
                               "x1,x2,x4",
                               "--edge",
                               "1",
                               "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["surfaces"].size(), 2U);
  EXPECT_THAT(outcome.json()["surfaces"][1]["left_out"].get<std::string>(), HasSubstr("beyond"));
}

Words vehicle_front(const Words& more) {
  return with({"front", "vehicle", "--from", "0,0,0,0", "--what", "front", "--length", "1"}, more);
}

TEST(FrontCommand, TakesAConditionOnTheEnds) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run(
      vehicle_front({"--fix", "theta=phi", "--edge", "1", "--output", "a.csv", "--bound", "4"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("left out: momenta beyond 4 in their plane"));
  EXPECT_THAT(sandbox.files(), ElementsAre("a.csv"));
}

TEST(FrontCommand, SaysThatTimeWasUp) {
  const Outcome late =
      run(unicycle({"--momentum", "0.4,0.3,0.9", "--time-limit", "1e-9", "--json"}));
  EXPECT_EQ(late.status, 1);
  EXPECT_EQ(late.json()["status"], "not_converged");
  EXPECT_TRUE(late.json()["cut_time"].is_null());
  EXPECT_THAT(late.err, HasSubstr("time limit"));
}

TEST(FrontCommand, RefusesInOneLine) {
  const std::vector<std::pair<Words, std::string>> cases{
      {{"front"}, "SCENE"},
      {{"front", "unicycle", "--from", "0,0,0", "--momentum", "1,0,0"}, "--what"},
      {{"front", "unicycle", "--from", "0,0,0", "--what", "edge"}, "'edge'"},
      {{"front", "unicycle", "--momentum", "1,0,0", "--what", "cut"}, "--from"},
      {{"front", "unicycle", "--from", "0,0,0", "--what", "cut"}, "--length"},
      {unicycle({"--length", "0"}), "--length '0'"},
      {unicycle({"--length", "1,x"}), "'x'"},
      {unicycle({"--length", "1", "--fix", "p_q=1"}), "--fix 'p_q=1'"},
      {unicycle({"--length", "1", "--fix", "p_y"}), "there is no ="},
      {unicycle({"--length", "1", "--project", "x,y"}), "--project"},
      {vehicle_front({"--fix", "theta=psi"}), "'psi'"},
      {vehicle_front({"--fix", "theta=theta"}), "always that which it is"},
      {vehicle_front({"--fix", "theta=phi", "--fix", "x=1"}), "a condition on the ends already"},
      {vehicle_front({"--fix", "theta=phi", "--fix", "p_x=1"}), "two momenta beside them are free"},
      {{"front",
        "vehicle",
        "--from",
        "0,0,0,0",
        "--what",
        "caustic",
        "--length",
        "1",
        "--fix",
        "theta=phi"},
       "of a front or of a sphere"},
      {unicycle({"--length", "1", "--output", "a.stl"}), "'a.stl'"},
      {unicycle({"--length", "1", "--check"}), "--check"},
      {unicycle({"--length", "1", "--edge", "2"}), "--edge"},
      {unicycle({"--length", "1", "--vertices", "9"}), "--vertices"},
      {unicycle({"--length", "1", "--order", "2"}), "--order '2'"},
      {unicycle({"--length", "1", "--cusps"}), "--cusps"},
      {{"front", "engel", "--from", "0,0,0,0", "--what", "front", "--length", "1"}, "to be fixed"},
      {{"front", "unicycle", "--from", "0,0,0", "--what", "sphere", "--momentum", "1,0,0"},
       "--momentum"},
      {unicycle({"--momentum", "1,0"}), "'1,0'"},
      {unicycle({"--momentum", "0,1,0"}), "velocity is zero"},
      {unicycle({"--momentum", "1,0,0", "--max-time", "0"}), "--max-time"},
      {unicycle({"--length", "1", "--mod-sign", "theta"}), "--mod-sign 'theta'"},
      {unicycle({"--momentum", "1,0,0", "--mod-sign", "theta"}), "--mod-sign 'theta'"},
      {{"front",
        "heisenberg-group",
        "--from",
        "0,0,0",
        "--what",
        "front",
        "--length",
        "1",
        "--mod-sign",
        "x"},
       "--mod-sign 'x'"},
      {unicycle({"--momentum", "1,0,0", "--time-limit", "-1"}), "--time-limit"},
      {unicycle({"--momentum", "1,0,0", "--cover", "--mod-angles"}), "--mod-angles"},
      {{"front", "vehicle-cosine", "--from", "0,1,0,0", "--momentum", "1,0,0,0", "--what", "cut"},
       "without a potential"},
      {{"front",
        "satellite-quaternion",
        "--from",
        "1,1,0,0",
        "--momentum",
        "0,1,0,0",
        "--what",
        "cut"},
       "--from"}};
  for (const auto& [line, expected] : cases) {
    const Sandbox sandbox;
    expect_refused(line, HasSubstr(expected), sandbox);
  }
}

}  // namespace
}  // namespace carnot::apps::cli_front_test
