#include "text/json_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "text/csv_text.h"

namespace carnot::apps::json_text_test {
namespace {

TEST(JsonText, PrintsSeventeenDigits) {
  EXPECT_EQ(json_text(0.1), "0.10000000000000001\n");
  EXPECT_EQ(json_text(1.0), "1\n");
  EXPECT_EQ(json_text(1e300), "1.0000000000000001e+300\n");
  EXPECT_EQ(json_text(7), "7\n");
}

TEST(JsonText, ReadsBackExactly) {
  for (const double x :
       {1.0 / 3, std::nextafter(1.0, 2.0), 5e-324, -1.7976931348623157e308, -0.0}) {
    EXPECT_EQ(Json::parse(json_text(x)).get<double>(), x);
  }
}

TEST(JsonText, HasNullForWhatIsNotFinite) {
  EXPECT_EQ(json_text({std::nan(""), INFINITY, -INFINITY}), "[null, null, null]\n");
}

TEST(JsonText, PutsListsOfValuesOnOneLine) {
  const Json value{{"a", {1, 2.5, "x", true, nullptr}},
                   {"b", Json::array({{1, 2}, {3, 4}})},
                   {"c", Json::array()},
                   {"d", Json::object()}};
  EXPECT_EQ(json_text(value),
            "{\n"
            "  \"a\": [1, 2.5, \"x\", true, null],\n"
            "  \"b\": [\n    [1, 2],\n    [3, 4]\n  ],\n"
            "  \"c\": [],\n"
            "  \"d\": {}\n"
            "}\n");
}

TEST(JsonText, SurvivesWhatIsNotUtf8) { EXPECT_TRUE(Json::accept(json_text("\xff\"\n"))); }

SceneInfo plane() {
  SceneInfo info;
  info.configuration = {{"x", "m", 0}, {"y", "m", 0}};
  return info;
}

const Trajectory kTrajectory{
    {0, 0.1}, {{1, 2}, {3, 4}}, {{5, 6}, {7, 8}}, {{9}, {10}}, {0.5, 0.5}, {}};

TEST(CsvText, HasNamedColumns) {
  EXPECT_EQ(csv_text(plane(), 1, {&kTrajectory}),
            "t,q_x,q_y,p_x,p_y,lambda_1,hamiltonian\n"
            "0,1,2,5,6,9,0.5\n"
            "0.10000000000000001,3,4,7,8,10,0.5\n");
}

TEST(CsvText, NumbersSeveralGeodesics) {
  EXPECT_EQ(csv_text(plane(), 1, {&kTrajectory, &kTrajectory}),
            "geodesic,t,q_x,q_y,p_x,p_y,lambda_1,hamiltonian\n"
            "1,0,1,2,5,6,9,0.5\n"
            "1,0.10000000000000001,3,4,7,8,10,0.5\n"
            "2,0,1,2,5,6,9,0.5\n"
            "2,0.10000000000000001,3,4,7,8,10,0.5\n");
}

}  // namespace
}  // namespace carnot::apps::json_text_test
