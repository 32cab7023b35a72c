// Scenes from files, wherever the program takes a scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "command.h"

namespace carnot::apps::cli_text_scenes_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr const char* kHooked = CARNOT_SOURCE_DIR "/docs/examples/scenes/hooked.scene";

Words park(const std::string& scene, const Words& more) {
  return with({"geodesic", scene, "--from", "0,0,0,0", "--to", "0,1,0,0", "--json"}, more);
}

TEST(TextScenes, HaveGeodesicsWithLabelsAndReports) {
  const Outcome outcome = run(park(kHooked, {}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json["scene"], "hooked");
  EXPECT_EQ(json["status"], "converged");
  EXPECT_EQ(json["parameters"]["hook"], 0.3);
  EXPECT_EQ(json["geodesics"][0]["label"], "locally-minimal");
  EXPECT_LE(json["geodesics"][0]["endpoint_error"].get<double>(), 1e-9);
}

// Hooked on the axle it is the car with a trailer that the program knows.
TEST(TextScenes, ParametersChangeThem) {
  const auto text = run(park(kHooked, {"--set", "hook=0", "--set", "w=1"})).json();
  const auto twin = run(park("trailer1", {})).json();
  const double action = twin["geodesics"][0]["action"].get<double>();
  EXPECT_NEAR(text["geodesics"][0]["action"].get<double>(), action, 1e-9 * action);
  EXPECT_EQ(text["geodesics"][0]["label"], twin["geodesics"][0]["label"]);
  const Outcome refused = run(park(kHooked, {"--set", "rod=0"}));
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("rod > 0"));
}

TEST(TextScenes, AreDescribed) {
  const auto json = run({"scenes", kHooked, "--json"}).json();
  ASSERT_EQ(json["scenes"].size(), 1u);
  EXPECT_EQ(json["scenes"][0]["name"], "hooked");
  EXPECT_EQ(json["scenes"][0]["multipliers"], 2);
  EXPECT_EQ(json["scenes"][0]["parameters"].size(), 3u);
}

TEST(TextScenes, FlowContinueAndStressTakeThem) {
  const Words flow{"flow", kHooked, "--from", "0,0,0,0", "--momentum", "1,1,0.2,0.3"};
  const auto json = run(with(flow, {"--time", "2", "--steps", "40", "--tangent", "--json"})).json();
  EXPECT_LE(json["symplecticity_defect_relative"].get<double>(), 1e-12);
  EXPECT_LE(json["energy_drift"].get<double>(), 1e-13);
  const Outcome along = run({"continue",
                             kHooked,
                             "--from",
                             "0,0,0,0",
                             "--to",
                             "0,1,0,0",
                             "--along",
                             "hook=0.2",
                             "--json"});
  EXPECT_EQ(along.status, 0) << along.err;
}

TEST(TextScenes, PrintThemselves) {
  const Sandbox sandbox;
  const Outcome text = sandbox.run({"scenes", "vehicle", "--text"});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("0 = x' sin(phi) - y' cos(phi)"));
  std::ofstream(sandbox.directory() / "mine.scene") << text.out;
  const auto mine = sandbox.run(park("mine.scene", {})).json();
  const auto own = sandbox.run(park("vehicle", {})).json();
  EXPECT_NEAR(mine["geodesics"][0]["action"].get<double>(),
              own["geodesics"][0]["action"].get<double>(),
              1e-9);
  EXPECT_EQ(sandbox.run({"scenes", "mine.scene", "--text"}).out, text.out);
  EXPECT_EQ(sandbox.run({"scenes", "--text"}).status, 2);
}

TEST(TextScenes, EveryOneOfTheProgramHasAText) {
  const auto scenes = run({"scenes", "--json"}).json()["scenes"];
  for (const auto& scene : scenes) {
    const Outcome text = run({"scenes", scene["name"].get<std::string>(), "--text"});
    EXPECT_EQ(text.status, 0) << scene["name"];
    EXPECT_THAT(text.out, HasSubstr("coordinates"));
  }
}

TEST(TextScenes, BeginWithATemplate) {
  const Sandbox sandbox;
  const Outcome made = sandbox.run({"scenes", "new", "robot"});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(sandbox.files(), ElementsAre("robot.scene"));
  EXPECT_EQ(sandbox.run(park("robot.scene", {})).json()["status"], "converged");
  EXPECT_EQ(sandbox.run({"scenes", "new", "robot"}).status, 2);  // not twice
  for (const char* bad : {"../robot", "a b", "-x", ""}) {
    EXPECT_EQ(sandbox.run({"scenes", "new", bad}).status, 2) << bad;
  }
}

TEST(TextScenes, ErrorsAreWhereEditorsFindThem) {
  const Sandbox sandbox;
  std::ofstream(sandbox.directory() / "bad.scene") << "coordinates x, y\nlet a = yy\n";
  const Outcome outcome = sandbox.run({"scenes", "bad.scene"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith("bad.scene:2:9: 'yy' is not known"));
  EXPECT_THAT(outcome.out, IsEmpty());
  const Outcome missing = sandbox.run({"scenes", "no.scene"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, HasSubstr("no.scene"));
}

}  // namespace
}  // namespace carnot::apps::cli_text_scenes_test
