#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "command.h"
#include "text/version.h"

namespace carnot::apps::cli_tables_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Help, IsThereForEverySubcommand) {
  EXPECT_THAT(run({"--help"}).out, AllOf(HasSubstr("geodesic"), HasSubstr("Exit status")));
  EXPECT_EQ(run({"-h"}).out, run({"--help"}).out);
  for (const char* name : {"geodesic", "flow", "scenes", "methods", "verify"}) {
    const Outcome outcome = run({name, "--help"});
    EXPECT_EQ(outcome.status, 0) << name;
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("Examples"), HasSubstr("Exit status")));
  }
}

TEST(Version, IsThatOfTheProject) {
  const Outcome outcome = run({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, std::string("carnot ") + kVersion + "\n");
}

TEST(ScenesCommand, DescribesAllScenes) {
  const Outcome outcome = run({"scenes", "--json"});
  ASSERT_EQ(outcome.status, 0);
  const auto json = outcome.json();
  EXPECT_THAT(keys(json), ElementsAre("version", "arguments", "scenes"));
  std::set<std::string> names;
  for (const auto& scene : json["scenes"]) {
    EXPECT_THAT(keys(scene),
                ElementsAre("name",
                            "summary",
                            "kind",
                            "configuration",
                            "periods",
                            "multipliers",
                            "parameters",
                            "reference"));
    EXPECT_NE(scene["summary"], "");
    names.insert(scene["name"]);
    for (const auto& parameter : scene["parameters"]) {
      EXPECT_THAT(keys(parameter), ElementsAre("name", "default", "unit", "range", "meaning"));
    }
    EXPECT_THAT(run({"scenes"}).out, HasSubstr(scene["name"].get<std::string>()));
  }
  EXPECT_EQ(names.size(), json["scenes"].size());
  for (const char* name :
       {"vehicle", "vehicle-cosine", "heisenberg", "heisenberg-group", "unicycle"}) {
    EXPECT_EQ(names.count(name), 1) << name;
  }
}

TEST(ScenesCommand, DescribesOneScene) {
  const auto json = run({"scenes", "vehicle", "--json"}).json();
  ASSERT_EQ(json["scenes"].size(), 1);
  const auto& vehicle = json["scenes"][0];
  EXPECT_EQ(vehicle["configuration"].dump(), R"(["x","y","theta","phi"])");
  EXPECT_DOUBLE_EQ(vehicle["periods"]["theta"].get<double>(), 6.283185307179586);
  EXPECT_EQ(vehicle["multipliers"], 2);
  EXPECT_EQ(vehicle["parameters"][0]["name"], "alpha");
  EXPECT_EQ(vehicle["parameters"][0]["default"], 1);
  EXPECT_THAT(run({"scenes", "vehicle"}).out, AllOf(HasSubstr("alpha"), HasSubstr(">= 0")));
}

TEST(MethodsCommand, DeclaresAndMeasures) {
  const auto json = run({"methods", "--json"}).json();
  ASSERT_EQ(json["methods"].size(), 26);
  std::set<std::string> names;
  for (const auto& method : json["methods"]) {
    EXPECT_THAT(keys(method),
                ElementsAre("name",
                            "order",
                            "stages",
                            "family",
                            "symplectic",
                            "symmetric",
                            "scene",
                            "measured_order",
                            "order_verdict",
                            "symplecticity_defect",
                            "reversibility_defect",
                            "summary"));
    SCOPED_TRACE(method["name"]);
    names.insert(method["name"].get<std::string>());
    EXPECT_EQ(method["symplecticity_defect"].get<double>() < 1e-14,
              method["symplectic"].get<bool>());
    EXPECT_EQ(method["reversibility_defect"].get<double>() < 1e-14,
              method["symmetric"].get<bool>());
    EXPECT_NE(method["order_verdict"], "fails");
    const auto order = method["order"].get<double>();
    if (order <= 6) {
      EXPECT_NEAR(method["measured_order"].get<double>(), order, 0.06 * order);
    }
  }
  EXPECT_EQ(names.size(), json["methods"].size());
  for (const char* name : {"midpoint", "gauss16", "midpoint8", "lobatto8", "radau5", "rattle6"}) {
    EXPECT_EQ(names.count(name), 1) << name;
  }
  const auto& first = json["methods"][0];
  EXPECT_EQ(first["name"], "midpoint");
  EXPECT_EQ(first["order"], 2);
  EXPECT_EQ(first["stages"], 1);
}

TEST(MethodsCommand, MarksWhatIsBroken) {
  const std::string text = run({"methods"}).out;
  const std::string radau = text.substr(text.find("\nradau5") + 1);
  EXPECT_THAT(radau.substr(0, radau.find('\n')), AllOf(HasSubstr("*"), HasSubstr("Radau IIA")));
  EXPECT_EQ(text.substr(0, text.find("\ngauss6")).find('*'), std::string::npos);
}

TEST(Tables, GoToAFile) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"methods", "--output", "m.json", "--json"});
  EXPECT_EQ(read_text(sandbox.directory() / "m.json"), outcome.out);
}

}  // namespace
}  // namespace carnot::apps::cli_tables_test
