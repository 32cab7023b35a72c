// README.md is true: its console blocks are run and what they print is compared.
//
// In a ```console block a line `$ COMMAND` is followed by the output of COMMAND, stdout and stderr.
// The commands run by sh in one empty directory, with the built program as `carnot` and as
// scripts/run.sh, and the example, compiled from README.md itself, as ./coin. Their words must be
// the same, white space apart; numbers may differ by round-off.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace carnot::readme {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

// Numbers in these lines depend on the machine.
constexpr std::array kEffort{"starts converged", "evaluations", "seconds"};
// Below this, the tolerance of a geodesic, a number is round-off; its digits mean nothing.
constexpr double kRoundOff = 1e-10;
// Of numbers that are printed with more digits than this.
constexpr double kRelative = 1e-9;
// A number with fewer digits than this may be one printed in full, such as 0.5.
constexpr std::size_t kRoundedDigits = 3;

// The parking manoeuvre and its mirror image have the same action; round-off may swap them.
const std::pair<std::string, std::string> kMirrorImages{
    "(-5.3631314, 16.184377, -9.3116147, -4.0807579)",
    "(5.3631314, 16.184377, -14.674746, -4.0807579)"};

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Without blank lines.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(' ') != std::string::npos) lines.push_back(line);
  }
  return lines;
}

// Words, numbers and signs: "p0 (-1.5, 2e-3)" is p0 ( -1.5 , 2e-3 ).
std::vector<std::string> tokens_of(const std::string& line) {
  static const std::regex kToken(R"([A-Za-z_]\w*|[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[^\s])");
  return {std::sregex_token_iterator(line.begin(), line.end(), kToken),
          std::sregex_token_iterator()};
}

bool is_number(const std::string& token) {
  return std::any_of(token.begin(), token.end(), [](unsigned char c) { return std::isdigit(c); }) &&
         std::isalpha(static_cast<unsigned char>(token[0])) == 0 && token[0] != '_';
}

// One unit in the last place that is printed; 0 for a number that may have been printed in full.
double last_place(const std::string& token) {
  const std::string mantissa = token.substr(0, token.find_first_of("eE"));
  const std::size_t point = mantissa.find('.');
  if (point == std::string::npos) return 0;
  const std::size_t first = mantissa.find_first_of("123456789");
  const std::size_t digits =
      first == std::string::npos ? 0 : mantissa.size() - first - (first < point ? 1 : 0);
  if (digits < kRoundedDigits) return 0;
  const double unit = std::pow(10.0, -static_cast<double>(mantissa.size() - point - 1));
  const double scale = mantissa.size() < token.size()
                           ? std::pow(10.0, std::stod(token.substr(mantissa.size() + 1)))
                           : 1.0;
  return unit * scale;
}

bool same_number(const std::string& expected, const std::string& actual) {
  constexpr double kSlack = 1.01;  // the difference is rounded, too
  const double a = std::strtod(expected.c_str(), nullptr);
  const double b = std::strtod(actual.c_str(), nullptr);
  const double larger = std::max(std::abs(a), std::abs(b));
  return larger < kRoundOff ||
         std::abs(a - b) <= std::max(kRelative * larger, kSlack * last_place(expected));
}

bool same_line(const std::string& expected, const std::string& actual) {
  const bool effort = std::any_of(kEffort.begin(), kEffort.end(), [&](const char* words) {
    return expected.find(words) != std::string::npos;
  });
  const auto a = tokens_of(expected);
  const auto b = tokens_of(actual);
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(), [&](const std::string& x, const std::string& y) {
        if (!is_number(x) || !is_number(y)) return x == y;
        return effort || same_number(x, y);
      });
}

bool same_text(const std::string& expected, const std::string& actual) {
  const auto a = lines_of(expected);
  const auto b = lines_of(actual);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_line);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

bool agrees(const std::string& expected, const std::string& actual) {
  const auto& [one, other] = kMirrorImages;
  return same_text(expected, actual) || same_text(replaced(expected, one, other), actual) ||
         same_text(replaced(expected, other, one), actual);
}

struct Transcript {
  std::string command;
  std::string output;
};

std::vector<Transcript> transcripts(const std::string& readme) {
  std::vector<Transcript> list;
  bool inside = false;
  std::istringstream in(readme);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("```", 0) == 0) {
      inside = line == "```console";
    } else if (inside && line.rfind("$ ", 0) == 0) {
      list.push_back({line.substr(2), ""});
    } else if (inside && !list.empty()) {
      list.back().output += line + '\n';
    }
  }
  return list;
}

// An empty directory to run the commands in, removed at the end.
class Workplace {
 public:
  Workplace() {
    std::string name = (std::filesystem::temp_directory_path() / "carnot-XXXXXX").string();
    root_ = mkdtemp(name.data());
    std::filesystem::create_directories(root_ / "bin");
    std::filesystem::create_directories(root_ / "work" / "scripts");
    std::filesystem::create_symlink(CARNOT_PROGRAM, root_ / "bin" / "carnot");
    std::filesystem::create_symlink(CARNOT_PROGRAM, root_ / "work" / "scripts" / "run.sh");
    std::filesystem::create_symlink(COIN_PROGRAM, root_ / "work" / "coin");
  }
  ~Workplace() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  [[nodiscard]] std::string output_of(const std::string& command) const {
    std::ofstream(root_ / "command") << command << '\n';
    const std::string root = root_.string();
    const std::string line =
        "cd '" + root + "/work' && PATH='" + root +
        "/bin':\"$PATH\" LC_ALL=C.UTF-8 sh ../command > ../out 2>&1 < /dev/null";
    const int status = std::system(line.c_str());
    return read_text(root + "/out") + (status == 0 ? "" : "(the command failed)\n");
  }

 private:
  std::filesystem::path root_;
};

TEST(ReadmeTest, CommandsPrintWhatItSays) {
  const auto list = transcripts(read_text(README_FILE));
  ASSERT_GT(list.size(), 5);
  const Workplace workplace;
  for (const auto& [command, output] : list) {
    const std::string actual = workplace.output_of(command);
    EXPECT_TRUE(agrees(output, actual)) << "$ " << command << "\nREADME.md says\n"
                                        << output << "\nand it prints\n"
                                        << actual;
  }
}

TEST(ReadmeTest, LinkedFilesExist) {
  const std::string readme = read_text(README_FILE);
  const std::regex link(R"(\]\(([^):]+)\))");
  std::vector<std::string> missing;
  std::size_t found = 0;
  for (std::sregex_iterator i(readme.begin(), readme.end(), link), end; i != end; ++i, ++found) {
    const auto path = std::filesystem::path(README_FILE).parent_path() / (*i)[1].str();
    if (!std::filesystem::exists(path)) missing.push_back(path);
  }
  EXPECT_GE(found, 2);
  EXPECT_THAT(missing, IsEmpty());
}

TEST(ReadmeTest, FindsTheCommands) {
  const auto list = transcripts("$ no\n```console\n$ one\n1\n\n2\n$ two\n```\n```sh\n$ no\n```\n");
  ASSERT_THAT(list, SizeIs(2));
  EXPECT_EQ(list[0].command, "one");
  EXPECT_EQ(list[0].output, "1\n\n2\n");
  EXPECT_EQ(list[1].command, "two");
  EXPECT_EQ(list[1].output, "");
}

TEST(ReadmeTest, AcceptsRoundOff) {
  EXPECT_TRUE(agrees("action   22.7078818\n\n", "action 22.7078817\n"));
  EXPECT_TRUE(agrees("drift 4.48e-05", "drift 4.47e-05"));
  EXPECT_TRUE(agrees("error 1.7e-13", "error 0"));
  EXPECT_TRUE(agrees("p (1, -0.2499999999999)", "p (0.99999999999998, -0.25)"));
  EXPECT_TRUE(agrees("19 of 24 starts converged, gauss16, 0.2 s",
                     "18 of 24 starts converged, gauss16, 11 s"));
}

TEST(ReadmeTest, NoticesADifference) {
  EXPECT_FALSE(agrees("action 22.7078818", "action 22.7078828"));
  EXPECT_FALSE(agrees("action 22.7078818", "action -22.7078818"));
  EXPECT_FALSE(agrees("drift 4.48e-05", "drift 4.48e-06"));
  EXPECT_FALSE(agrees("error 1.7e-13", "error 1.7e-09"));
  EXPECT_FALSE(agrees("step 0.1", "step 0.2"));
  EXPECT_FALSE(agrees("100 steps", "101 steps"));
  EXPECT_FALSE(agrees("gauss16", "gauss12"));
  EXPECT_FALSE(agrees("p (1, 2)", "p (1, 2, 3)"));
  EXPECT_FALSE(agrees("one\ntwo", "one"));
  EXPECT_FALSE(agrees("19 of 24 starts converged, gauss16, 0.2 s",
                      "19 of 24 starts converged, gauss4, 0.2 s"));
}

}  // namespace
}  // namespace carnot::readme
