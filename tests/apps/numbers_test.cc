#include "text/numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <stdexcept>

namespace carnot::apps::numbers_test {
namespace {

using std::numbers::pi;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string message_of(const std::function<void()>& refused) {
  try {
    refused();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ParseReal, ReadsNumbersAndAngles) {
  const std::vector<std::pair<std::string, double>> cases{
      {"0", 0},         {"-0", 0},          {"1", 1},
      {"-1.5", -1.5},   {"+2", 2},          {".5", 0.5},
      {"5.", 5},        {"1e-3", 1e-3},     {"1E3", 1e3},
      {"1e300", 1e300}, {"pi", pi},         {"-pi", -pi},
      {"pi/2", pi / 2}, {"-pi/2", -pi / 2}, {"-3*pi/4", -3 * pi / 4},
      {"2pi", 2 * pi},  {"2*pi", 2 * pi},   {"pi*pi", pi * pi},
      {"1/3", 1.0 / 3}, {"0.1", 0.1},       {"1e-400", 0},
      {"-1e-999", 0}};
  for (const auto& [text, value] : cases) EXPECT_EQ(parse_real("--x", text), value) << text;
}

TEST(ParseReal, RefusesWhatIsNoFiniteNumber) {
  for (const std::string text : {"",
                                 "nan",
                                 "NaN",
                                 "-nan",
                                 "inf",
                                 "-inf",
                                 "infinity",
                                 "1e999",
                                 "-1e999",
                                 "1/0",
                                 "pi/0",
                                 "0/0",
                                 "one",
                                 "1x",
                                 "1 ",
                                 " 1",
                                 "--1",
                                 "+-1",
                                 "1e",
                                 "0x10",
                                 "pi2",
                                 "1*",
                                 "*1",
                                 "1//2",
                                 "pipi",
                                 "1,2",
                                 "1+1",
                                 "()",
                                 "e",
                                 "\xe2\x88\x92"
                                 "1",
                                 "1e300*1e300",
                                 "3 pi",
                                 "pi/-2"}) {
    const std::string message = message_of([&] { parse_real("--x", text); });
    EXPECT_THAT(message, AllOf(HasSubstr("--x '" + text + "'"), HasSubstr("accepted: a finite")));
  }
}

TEST(ParsePositive, RefusesZeroAndLess) {
  EXPECT_EQ(parse_positive("--x", "1e-300"), 1e-300);
  for (const char* text : {"0", "-0", "-1", "-pi", "nan"}) {
    EXPECT_THROW(parse_positive("--x", text), std::invalid_argument) << text;
  }
}

TEST(ParseTolerance, IsBetweenRoundOffAndOne) {
  EXPECT_EQ(parse_tolerance("--x", "1e-10"), 1e-10);
  EXPECT_EQ(parse_tolerance("--x", "1"), 1);
  for (const char* text : {"0", "-1e-9", "1e-30", "5", "inf"}) {
    EXPECT_THROW(parse_tolerance("--x", text), std::invalid_argument) << text;
  }
}

TEST(ParseVector, TakesOneNumberPerName) {
  EXPECT_THAT(parse_vector("--x", "-3,4,-pi/2,0", {"x", "y", "a", "b"}),
              ElementsAre(-3, 4, -pi / 2, 0));
  EXPECT_THAT(parse_vector("--x", "1, 2", {"x", "y"}), ElementsAre(1, 2));
  EXPECT_THAT(parse_vector("--x", "7", {"x"}), ElementsAre(7));
}

TEST(ParseVector, NamesWhatIsWrong) {
  const std::vector<std::string> names{"x", "y"};
  EXPECT_THAT(message_of([&] { parse_vector("--from", "1,2,3", names); }),
              AllOf(HasSubstr("--from '1,2,3': 3 numbers given"),
                    HasSubstr("accepted: 2 comma-separated finite numbers x,y")));
  for (const std::string text : {"", "1", "1,", ",1", "1,,2", "1;2", "1 2", "1,nan", "[1,2]"}) {
    EXPECT_THAT(message_of([&] { parse_vector("--from", text, names); }),
                HasSubstr("--from '" + text + "'"));
  }
}

TEST(ParseEnd, TakesStarsForFreeCoordinates) {
  using std::nullopt;
  EXPECT_EQ(parse_end("--to", "1,*, * ,pi", {"x", "y", "a", "b"}),
            (std::vector<std::optional<double>>{1, nullopt, nullopt, pi}));
  for (const std::string text : {"", "**", "1*,2", "*", "*,*,*", "2,*x"}) {
    EXPECT_THAT(message_of([&] {
                  parse_end("--to", text, {"x", "y"});
                }),
                AllOf(HasSubstr("--to '" + text + "'"), HasSubstr("or * for a free coordinate")));
  }
  EXPECT_THAT(message_of([] {
                parse_vector("--guess", "1,*", {"x", "y"});
              }),
              HasSubstr("'*' is not a finite number"));
}

TEST(ParseInteger, IsStrict) {
  EXPECT_EQ(parse_integer("--n", "42", 1, 100), 42);
  EXPECT_EQ(parse_integer("--n", "-3", -5, 100), -3);
  for (const std::string text :
       {"0", "101", "1.5", "1e1", "", "x", "1x", " 1", "99999999999999999999"}) {
    EXPECT_THAT(
        message_of([&] { parse_integer("--n", text, 1, 100); }),
        AllOf(HasSubstr("--n '" + text + "'"), HasSubstr("accepted: an integer from 1 to 100")));
  }
}

TEST(ParseSeed, TakesAll64Bits) {
  EXPECT_EQ(parse_seed("--seed", "18446744073709551615"),
            std::numeric_limits<std::uint64_t>::max());
  for (const char* text : {"-1", "18446744073709551616", "1.0", ""}) {
    EXPECT_THROW(parse_seed("--seed", text), std::invalid_argument) << text;
  }
}

TEST(Refuse, CutsVeryLongValues) {
  const std::string message =
      message_of([] { refuse("--x", std::string(100000, 'a'), "too long", "less"); });
  EXPECT_LT(message.size(), 300);
  EXPECT_THAT(message, HasSubstr("...': too long; accepted: less"));
}

}  // namespace
}  // namespace carnot::apps::numbers_test
