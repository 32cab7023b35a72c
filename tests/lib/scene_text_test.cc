// What the language accepts, and what it says of the rest: where, what, and what would do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "carnot/language/scene_source.h"
#include "carnot/load_scene.h"

namespace carnot::scene_text_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string refusal(const std::string& text) {
  try {
    (void)scene_from_text(text, "test", "test.scene");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

constexpr const char* kUnicycle = R"(coordinates x, y [length], theta [angle]
kinetic = (x'^2 + y'^2 + theta'^2) / 2
0 = x' sin(theta) - y' cos(theta)
)";

TEST(SceneText, ReadsAScene) {
  const TextScene scene = scene_from_text(kUnicycle, "wheel");
  EXPECT_EQ(scene.info().name, "wheel");
  EXPECT_EQ(scene.info().kind, "velocity constraints");
  EXPECT_EQ(scene.dof(), 3);
  EXPECT_EQ(scene.multipliers(), 1);
  ASSERT_EQ(scene.info().configuration.size(), 3u);
  EXPECT_EQ(scene.info().configuration[0].unit, "length");
  EXPECT_EQ(scene.info().configuration[1].unit, "length");
  EXPECT_EQ(scene.info().configuration[1].period, 0);
  EXPECT_EQ(scene.info().configuration[2].unit, "rad");
  EXPECT_GT(scene.info().configuration[2].period, 6.28);
}

struct Case {
  const char* what;
  std::string text;
  std::string place;  // line:column
  std::string says;
};

class Refusals : public ::testing::TestWithParam<Case> {};

TEST_P(Refusals, PointAtThePlace) {
  const std::string said = refusal(GetParam().text);
  EXPECT_THAT(said, StartsWith("test.scene:" + GetParam().place + ": "));
  EXPECT_THAT(said, HasSubstr(GetParam().says));
}

std::string with(const std::string& line) { return kUnicycle + line + "\n"; }

INSTANTIATE_TEST_SUITE_P(
    SceneText,
    Refusals,
    ::testing::Values(
        Case{"nothing", "", "1:1", "there are no coordinates"},
        Case{"no_function", "coordinates x\n", "1:1", "accepted: kinetic or mass"},
        Case{"unknown_word", "coordintes x, y\n", "1:1", "did you mean coordinates?"},
        Case{"unknown_statement", with("kinetics = 3"), "4:1", "did you mean kinetic?"},
        Case{"unknown_name", with("let a = thta + 1"), "4:9", "did you mean theta?"},
        Case{"unknown_function", with("let a = sine(theta)"), "4:9", "did you mean sin?"},
        Case{"kink", with("let a = abs(theta)"), "4:9", "it has a kink; write sqrt"},
        Case{"bad_character", with("let a = theta & 1"), "4:15", "'&' is not part of the language"},
        Case{"open_bracket",
             "coordinates x\nlet a = (x + 1\n",
             "3:1",
             "')' for the '(' in line 2, column 9"},
        Case{"no_operand", with("let a = theta +"), "4:16", "accepted: a number, a name or '('"},
        Case{"second_derivative", with("0 = x''"), "4:7", "second derivatives"},
        Case{
            "velocity_of_a_parameter", with("parameters k = 1\n0 = k'"), "5:5", "only coordinates"},
        Case{"zero", with("let a = 1/0"), "4:10", "division by zero"},
        Case{"infinite", with("let a = log(-1)"), "4:15", "infinite or not a number"},
        Case{"twice", with("let x = 1"), "4:5", "'x' is defined twice"},
        Case{"reserved", with("let pi = 3"), "4:5", "word of the language"},
        Case{"two_kinetics", with("kinetic = x'^2"), "4:1", "given twice"},
        Case{"default_out_of_range", "parameters k = -1 > 0\n", "1:12", "out of its range"},
        Case{"no_equation", with("x' sin(theta)"), "4:14", "'=' in an equation"},
        Case{"no_coordinates", with("0 = 3"), "4:1", "no coordinates"},
        Case{"time", with("0 = x - t"), "4:1", "depends on t"},
        Case{"too_many_rows", with("0 = x'\n0 = y'"), "5:1", "nothing free"},
        Case{"not_quadratic",
             "coordinates x, y\nkinetic = x'^4 + y'^2\n",
             "2:1",
             "no quadratic form"},
        Case{"not_at_rest",
             "coordinates x, y\nkinetic = x'^2 + y\n",
             "2:1",
             "does not vanish at rest"},
        Case{"mass_shape", "coordinates x, y\nmass = diag(1, 1, 1)\n", "2:8", "3 x 3"},
        Case{"mass_symmetric", "coordinates x, y\nmass = [1, 2; 0, 1]\n", "2:8", "not symmetric"},
        Case{"ragged", "coordinates x, y\nmass = [1, 2; 0]\n", "2:8", "rows of different lengths"},
        Case{"no_cost", "coordinates x\ncontrols u\nx' = u\n", "1:1", "no cost"},
        Case{"no_dynamics",
             "coordinates x, y\ncontrols u\nx' = u\ncost = u^2/2\n",
             "4:1",
             "the velocity of y is not given"},
        Case{"dynamics_twice",
             "coordinates x\ncontrols u\nx' = u\nx' = 2 u\ncost = u^2\n",
             "4:1",
             "given twice"},
        Case{"no_structure", "coordinates x, y\nhamiltonian = x^2 + y^2\n", "2:1", "no structure"},
        Case{"not_antisymmetric",
             "coordinates x, y\nhamiltonian = x^2 + y^2\nstructure = [0, 1; 1, 0]\n",
             "3:13",
             "antisymmetric"},
        Case{"dependent_rows",
             with("0 = 2 x' sin(theta) - 2 y' cos(theta)"),
             "3:1",
             "linearly dependent"},
        Case{"mass_not_positive",
             "coordinates x, y\nkinetic = (x'^2 - y'^2)/2\n",
             "2:1",
             "not positive definite"},
        Case{"false_symmetry",
             with("symmetry mirror: x -> -x"),
             "4:10",
             "does not have this symmetry"},
        Case{"odd_symmetry", with("symmetry mirror: x -> 2 x"), "4:10", "change of signs"},
        Case{"draw_velocity", with("draw (x', y) -- (0, 0)"), "4:6", "coordinates only"},
        Case{"draw_point", with("draw (x, y)"), "4:12", "'--' and another point"},
        Case{"wheel", with("draw wheel((x, y), theta)"), "4:6", "heading, radius"},
        Case{"period", with("period theta = -1"), "4:16", "a period is positive"},
        Case{"limit", with("limit theta in -1:1"), "4:13", "'in' is not known"},
        Case{"number", with("let a = 1e999"), "4:9", "'1e999' is not part"},
        Case{"quote", with("summary \"open"), "4:9", "'\"' is not part"}),
    [](const auto& name) { return name.param.what; });

TEST(SceneText, ShowsTheLineAndACaret) {
  const std::string said = refusal("coordinates x, y\nlet a = x + yy\n");
  EXPECT_THAT(said, HasSubstr("\n  let a = x + yy\n  "));
  EXPECT_EQ(said.substr(said.rfind('\n') + 1), "  " + std::string(12, ' ') + "^");
}

// Files are untrusted: what they ask for is bounded, and refused in a line.
TEST(SceneText, IsBounded) {
  std::string deep = "coordinates x\nlet a = ";
  for (int i = 0; i < 10000; ++i) deep += '(';
  EXPECT_THAT(refusal(deep), HasSubstr("nested too deeply"));

  std::string minus = "coordinates x\nlet a = ";
  for (int i = 0; i < 50000; ++i) minus += "- ";
  EXPECT_THAT(refusal(minus + "x\n"), HasSubstr("accepted: kinetic"));

  EXPECT_THAT(refusal(std::string(1000000, ' ')), HasSubstr("too long"));

  std::string doubling = "coordinates x\nlet a0 = tanh(x)\n";
  for (int i = 1; i < 150; ++i) {
    const std::string last = "a" + std::to_string(i - 1);
    doubling += "let a" + std::to_string(i) + " = tanh(" + last + " + " + last + "^2)\n";
  }
  EXPECT_NE(refusal(doubling + "kinetic = (1 + a149^2) x'^2\n"), "");  // no more than seconds

  std::string many = "coordinates x0";
  for (int i = 1; i < 100; ++i) many += ", x" + std::to_string(i);
  EXPECT_THAT(refusal(many + "\n"), HasSubstr("too many coordinates"));
  EXPECT_THAT(refusal("coordinates x\nlet a = x^1e300^1e300\n"), HasSubstr("test.scene:2:"));
}

TEST(SceneText, JuxtapositionMultiplies) {
  const auto value = [](const std::string& formula) {
    const language::SceneSource source = language::read_scene(
        "coordinates x\nparameters k = 3\nreport r = " + formula + "\n", "test", "test");
    const std::vector<double> at{0, 2};  // t, x
    return source.graph->evaluate(source.reports[0].values[0], at);
  };
  EXPECT_EQ(value("2 x"), 4);
  EXPECT_EQ(value("2x k"), 12);
  EXPECT_EQ(value("k(x + 1)"), 9);
  EXPECT_EQ(value("1/2 x"), 1);
  EXPECT_EQ(value("-x^2"), -4);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("2^-1"), 0.5);
  EXPECT_EQ(value("x - -x"), 4);
  EXPECT_EQ(value("sqrt(x + 2) x"), 4);
  EXPECT_EQ(value("(x\n + 1)"), 3);  // brackets join lines
  EXPECT_NEAR(value("sin(pi/2) + atan2(0, x) + 1e0"), 2, 1e-15);
}

// What is more than a scene with velocity constraints can have becomes a Lagrangian.
TEST(SceneText, TimeAndOtherConstraintsMakeALagrangian) {
  const auto kind = [](const std::string& text) { return scene_from_text(text).info().kind; };
  EXPECT_EQ(kind(kUnicycle), "velocity constraints");
  const std::string plane = "coordinates x, y\nkinetic = (x'^2 + y'^2)/2\n";
  EXPECT_EQ(kind(plane), "velocity constraints");
  EXPECT_EQ(kind(plane + "potential = x sin(t)\n"), "Lagrangian");
  EXPECT_EQ(kind(plane + "0 = x' - t y'\n"), "Lagrangian");
  EXPECT_EQ(kind(plane + "0 = x' - 1\n"), "Lagrangian");
  EXPECT_EQ(kind("coordinates x, y, z\nkinetic = (x'^2 + y'^2 + z'^2)/2\n"
                 "0 = x'^2 + y'^2 - z'^2\nguess x' = p_x, y' = p_y, z' = p_z\n"),
            "Lagrangian");
  EXPECT_EQ(kind(plane + "0 = x^2 + y^2 - 1\n"), "velocity + holonomic constraints");
}

TEST(SceneText, CommentsUnitsAndTexts) {
  const TextScene scene = scene_from_text(
      "# arm.scene: an arm  \n\n"
      "reference \"somebody\"  # and a comment\n"
      "coordinates q [angle], w [rad/time]\n"
      "period w = 2 pi, q = none\n"
      "parameters mass = 2 [kg m^2] > 0 \"how heavy\", k = pi/2 >= 0\n"
      "kinetic = (mass q'^2 + k w'^2) / 2\n"
      "report bend [angle] = q - w\n",
      "file");
  EXPECT_EQ(scene.info().name, "file");
  EXPECT_EQ(scene.info().summary, "an arm");
  EXPECT_EQ(scene.info().reference, "somebody");
  EXPECT_EQ(scene.info().configuration[0].period, 0);
  EXPECT_GT(scene.info().configuration[1].period, 6.28);
  ASSERT_EQ(scene.parameters().size(), 2u);
  EXPECT_EQ(scene.parameters()[0].unit, "kg m^2");
  EXPECT_EQ(scene.parameters()[0].meaning, "how heavy");
  EXPECT_TRUE(scene.parameters()[0].range.open);
  EXPECT_FALSE(scene.parameters()[1].range.open);
  ASSERT_EQ(scene.info().extremes.size(), 1u);
  EXPECT_EQ(scene.info().extremes[0].name, "largest_bend");
  EXPECT_EQ(scene.info().extremes[0].unit, "rad");
  const double q[] = {0.5, 2};
  EXPECT_EQ(scene.info().extremes[0].value(q), -1.5);
}

TEST(SceneText, ReportsTheLargestOfSeveral) {
  const TextScene scene = scene_from_text(
      "coordinates x, y\nkinetic = (x'^2 + y'^2)/2\nreport reach = x, -2 y, x + y\n");
  ASSERT_EQ(scene.info().extremes.size(), 1u);
  const double far[] = {3, 1};
  EXPECT_EQ(scene.info().extremes[0].value(far), 4);
  const double up[] = {-1, 2};
  EXPECT_EQ(scene.info().extremes[0].value(up), -4);
}

}  // namespace
}  // namespace carnot::scene_text_test
