#include "text/arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "carnot/language/nearest.h"

namespace carnot::apps::arguments_test {
namespace {

using ::testing::ElementsAre;

const OptionNames kNames{{"--from", "--time"}, {"--set"}, {"--json"}};

TEST(JoinValues, JoinsNegativeValues) {
  EXPECT_THAT(join_values({"flow", "--from", "-pi/2,0", "--json", "--time", "-1"}, kNames),
              ElementsAre("flow", "--from=-pi/2,0", "--json", "--time=-1"));
  EXPECT_THAT(join_values({"--from=-3,4", "x"}, kNames), ElementsAre("--from=-3,4", "x"));
}

TEST(JoinValues, LeavesOthersAlone) {
  EXPECT_THAT(join_values({"-h", "--unknown", "-1", "--", "a=b"}, kNames),
              ElementsAre("-h", "--unknown", "-1", "--", "a=b"));
}

TEST(JoinValues, RepeatsOnlyWhatMayBeRepeated) {
  EXPECT_THAT(join_values({"--set", "a=1", "--set=b=-2"}, kNames),
              ElementsAre("--set=a=1", "--set=b=-2"));
  EXPECT_THROW(join_values({"--time", "1", "--time=2"}, kNames), std::invalid_argument);
}

TEST(JoinValues, RefusesMissingAndNeedlessValues) {
  const std::vector<std::vector<std::string>> cases{{"--from"},
                                                    {"--from="},
                                                    {"--from", ""},
                                                    {"--from", "--time", "1"},
                                                    {"--from=", "1,2"},
                                                    {"--json=true"}};
  for (const auto& arguments : cases) {
    EXPECT_THROW(join_values(arguments, kNames), std::invalid_argument) << arguments[0];
  }
}

TEST(OneLine, EscapesControlCharacters) {
  EXPECT_EQ(one_line("a\nb\r\x1b[0m"), "a\\nb\\x0d\\x1b[0m");
  EXPECT_EQ(one_line("\xc3\xa9"), "\xc3\xa9");
}

TEST(Nearest, MeasuresEdits) {
  EXPECT_EQ(language::edit_distance("", ""), 0);
  EXPECT_EQ(language::edit_distance("abc", ""), 3);
  EXPECT_EQ(language::edit_distance("", "abc"), 3);
  EXPECT_EQ(language::edit_distance("kitten", "sitting"), 3);
}

TEST(Nearest, SuggestsOnlyWhatIsNear) {
  const std::vector<std::string> known{"vehicle", "heisenberg"};
  EXPECT_EQ(language::nearest("vehicel", known), "vehicle");
  EXPECT_EQ(language::nearest("banana", known), "");
  EXPECT_EQ(language::suggestion("heisenburg", known), " (did you mean heisenberg?)");
  EXPECT_EQ(language::suggestion(std::string(100000, 'x'), known), "");
}

}  // namespace
}  // namespace carnot::apps::arguments_test
