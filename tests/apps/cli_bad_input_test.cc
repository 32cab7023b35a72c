// Every bad input: exit status 2, exactly one line on stderr that names the value, an empty stdout,
// no file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "command.h"

namespace carnot::apps::cli_bad_input_test {
namespace {

using ::testing::HasSubstr;

struct BadInput {
  std::string line;      // words separated by blanks; '' is an empty word
  std::string expected;  // in the message
};

// For GoogleTest.
void PrintTo(const BadInput& input, std::ostream* out) { *out << input.line; }

std::vector<std::string> words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word == "''" ? "" : word);
  return words;
}

class BadInputTest : public ::testing::TestWithParam<std::vector<BadInput>> {};

TEST_P(BadInputTest, IsRefusedInOneLine) {
  for (const auto& [line, expected] : GetParam()) {
    SCOPED_TRACE("carnot " + line);
    const Sandbox sandbox;
    std::filesystem::create_directory(sandbox.directory() / "d.json");
    expect_refused(words(line), HasSubstr(expected), sandbox);
  }
}

const std::vector<BadInput> kProgram{
    {"", "geodesic, flow, scenes, atlas, continue, front"},
    {"''", "SUBCOMMAND ''"},
    {"fly", "'fly'"},
    {"flwo", "did you mean flow?"},
    {"--json", "'--json'"},
    {"--", "'--'"},
    {"-1", "'-1'"},
    {"scenes nowhere", "SCENE 'nowhere'"},
    {"scenes vehicel", "did you mean vehicle?"},
    {"scenes vehicle heisenberg", "'heisenberg'"},
    {"scenes --output a.csv", "a.csv"},
    {"scenes --output", "--output"},
    {"scenes --set a=1", "--set"},
    {"methods gauss16", "'gauss16'"},
    {"methods --output missing/a.json", "missing"},
};

// Each line after the same beginning.
std::vector<BadInput> with_base(const std::string& base, const std::vector<BadInput>& endings) {
  std::vector<BadInput> cases;
  for (const auto& [line, expected] : endings) cases.push_back({base + " " + line, expected});
  return cases;
}

const std::vector<BadInput> kFlowData{
    {"flow", "SCENE ''"},
    {"geodesic spherical-pendulum --from 0,0,-1 --to 1,0,*", "ties to the others"},
    {"geodesic vehicle --from 0,0,0,0 --to 0,1,0,x", "or * for a free coordinate"},
    {"flow vehicle --from 0,0,0,* --momentum 1,0,0,0 --time 1 --steps 9", "'*' is not"},
    {"geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --disc 1,2", "--disc '1,2'"},
    {"geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --limit phi:1", "there is no ' in '"},
    {"geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --disc 1,2,0", "not positive"},
    {"geodesic pendulum --from 0,0 --to 1,0 --disc 1,2,1", "a disc needs points"},
    {"flow car --from 0,0,0,0", "'car'"},
    {"flow --from 0,0,0,0 --momentum 1,0,0,0 --time 1 --steps 10", "SCENE ''"},
    {"flow vehicle --momentum 1,0,0,0 --time 1 --steps 10", "--from ''"},
    {"flow vehicle --from 0,0,0 --momentum 1,0,0,0 --time 1 --steps 9", "--from '0,0,0'"},
    {"flow vehicle --from 0,0,0,0,0 --momentum 1,0,0,0 --time 1 --steps 9", "'0,0,0,0,0'"},
    {"flow vehicle --from 0,0,nan,0 --momentum 1,0,0,0 --time 1 --steps 9", "'0,0,nan,0'"},
    {"flow vehicle --from 0,0,inf,0 --momentum 1,0,0,0 --time 1 --steps 9", "'0,0,inf,0'"},
    {"flow vehicle --from 0,0,1e999,0 --momentum 1,0,0,0 --time 1 --steps 9", "1e999"},
    {"flow vehicle --from 0,,0,0 --momentum 1,0,0,0 --time 1 --steps 9", "'0,,0,0'"},
    {"flow vehicle --from \xe2\x88\x92"
     "1,0,0,0 --momentum 1,0,0,0 --time 1 --steps 9",
     "'\xe2\x88\x92"
     "1'"},
    {"flow vehicle --from= --momentum 1,0,0,0 --time 1 --steps 9", "--from ''"},
    {"flow vehicle --from '' --momentum 1,0,0,0 --time 1 --steps 9", "--from ''"},
    {"flow vehicle --from --momentum 1,0,0,0 --time 1 --steps 9", "--from ''"},
    {"flow vehicle --from 0, 0,0,0 --momentum 1,0,0,0 --time 1 --steps 9", "'0,0,0'"},
    {"flow vehicle --from 0,0,0,0 --time 1 --steps 9", "--momentum ''"},
    {"flow vehicle --from 0,0,0,0 --momentum 1,0 --time 1 --steps 9", "--momentum '1,0'"},
    {"flow vehicle --from 0,0,0,0 --momentum x --time 1 --steps 9", "--momentum 'x'"},
    {"flow vehicle --from 0,0,0,0 --momentum 1,0,0,0 --velocity 1,0,0,0 --time 1 --steps 9",
     "--velocity '1,0,0,0'"},
    {"flow vehicle --from 0,0,0,0 --momentum 1,0,0,0 --lambda 0,0 --time 1 --steps 9",
     "--lambda '0,0'"},
    {"flow vehicle --from 0,0,0,0 --velocity 1,0,0,0 --lambda 0 --time 1 --steps 9",
     "--lambda '0'"},
    {"flow vehicle --from 0,0,0,0 --velocity 1,1e-6,0,0 --time 1 --steps 9", "residual"},
    {"flow vehicle --from 0,0,0,0 --velocity 0,1,0,0 --time 1 --steps 9", "'0,1,0,0'"},
    {"flow vehicle --from 0,0,0,0 --velocity 0,1e-300,0,0 --time 1 --steps 9", "residual"},
    {"flow vehicle --from 0,0,0,0 --velocity 0,1e300,0,0 --time 1 --steps 9", "residual"},
    {"flow vehicle --from 0,0,0,0 --velocity nan,0,0,0 --time 1 --steps 9", "'nan,0,0,0'"},
};

const std::vector<BadInput> kFlowTime =
    with_base("flow vehicle --from 0,0,0,0 --momentum 1,0,0,0",
              {{"--steps 9", "--time ''"},
               {"--steps 9 --time 0", "--time '0'"},
               {"--steps 9 --time -1", "--time '-1'"},
               {"--steps 9 --time nan", "--time 'nan'"},
               {"--steps 9 --time inf", "--time 'inf'"},
               {"--steps 9 --time 1,2", "--time '1,2'"},
               {"--steps 9 --time 1 --time 2", "--time '2'"},
               {"--steps 9 --time 1e308 --start-time 1e308", "--time '1e308'"},
               {"--steps 9 --time 1 --start-time x", "--start-time 'x'"},
               {"--time 1", "--steps ''"},
               {"--time 1 --steps 0", "--steps '0'"},
               {"--time 1 --steps 1.5", "--steps '1.5'"},
               {"--time 1 --steps -3", "--steps '-3'"},
               {"--time 1 --steps 1e30", "--steps '1e30'"},
               {"--time 1 --steps 99999999999999", "--steps '99999999999999'"},
               {"--time 1 --step 0", "--step '0'"},
               {"--time 1 --step -0.1", "--step '-0.1'"},
               {"--time 1 --step nan", "--step 'nan'"},
               {"--time 1 --step 1e-300", "--step '1e-300'"},
               {"--time 1 --step 0.1 --steps 9", "--steps '9'"},
               {"--time 1 --steps 9 --tolerance 1e-9", "--tolerance '1e-9'"},
               {"--time 1 --step 0.1 --steps 9 --tolerance 1e-9", "exactly one of"},
               {"--time 1 --tolerance 0", "--tolerance '0'"},
               {"--time 1 --tolerance -1e-9", "--tolerance '-1e-9'"},
               {"--time 1 --tolerance 1e-30", "--tolerance '1e-30'"},
               {"--time 1 --tolerance 5", "--tolerance '5'"}});

const std::vector<BadInput> kRun =
    with_base("flow vehicle --from 0,0,0,0 --momentum 1,0,0,0 --time 1 --steps 9",
              {{"--set alpha", "--set 'alpha'"},
               {"--set alpha=", "--set alpha ''"},
               {"--set =1", "--set '=1'"},
               {"--set gamma=1", "--set 'gamma=1'"},
               {"--set lenght=1", "did you mean length?"},
               {"--set length=0", "--set 'length=0'"},
               {"--set alpha=-1", "--set 'alpha=-1'"},
               {"--set alpha=nan", "'nan'"},
               {"--set alpha=1 --set alpha=2", "--set 'alpha=2'"},
               {"--set", "--set ''"},
               {"--method foo", "--method 'foo'"},
               {"--method gauss26", "midpoint, gauss4"},
               {"--method gauss3", "--method 'gauss3'"},
               {"--method guass16", "did you mean gauss16?"},
               {"--samples 1", "--samples '1'"},
               {"--samples 0", "--samples '0'"},
               {"--samples -5", "--samples '-5'"},
               {"--samples 1e12", "--samples '1e12'"},
               {"--samples 1000000000000", "--samples '1000000000000'"},
               {"--threads 0", "--threads '0'"},
               {"--threads -1", "--threads '-1'"},
               {"--seed -1", "--seed '-1'"},
               {"--seed 0.5", "--seed '0.5'"},
               {"--plot file.xyz", "file.xyz"},
               {"--plot a.png --figure pie", "pie"},
               {"--figure", "--figure"},
               {"--plot file", "'file'"},
               {"--plot missing/file.png", "missing/file.png"},
               {"--output file.txt", "--output 'file.txt'"},
               {"--output file", "--output 'file'"},
               {"--output missing/file.json", "--output 'missing/file.json'"},
               {"--output d.json", "--output 'd.json'"},
               {"--output a.csv --no-trajectory", "--output 'a.csv'"},
               {"--output a.json --output b.json", "--output 'b.json'"},
               {"--output a.json --time x", "'x'"},
               {"--output a.json --plot a.png --samples 0", "'0'"},
               {"--tangent=maybe", "maybe"},
               {"--json=maybe", "--json 'maybe': takes no value"},
               {"--fron 1", "did you mean --from?"},
               {"-from 1", "-from"},
               {"extra", "'extra'"},
               {"--to 1,2,3,4", "--to"},
               {"-- -1", "'-1'"}});

const std::vector<BadInput> kGeodesic =
    with_base("geodesic vehicle --output a.json",
              {{"--to 0,1,0,0", "--from ''"},
               {"--from 0,0,0,0", "--to ''"},
               {"--from 0,0,0,0 --to 0,1,0", "--to '0,1,0'"},
               {"--from 0,0,0,0 --to 0,1,0,x", "--to '0,1,0,x'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --time 0", "--time '0'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --time -1", "--time '-1'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --count 0", "--count '0'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --count -1", "--count '-1'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --count 2.5", "--count '2.5'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --count 2 --all", "--count '2'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --max-length 0", "--max-length '0'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --max-length -2", "--max-length '-2'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --starts 0", "--starts '0'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --starts -1", "--starts '-1'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --tolerance 0", "--tolerance '0'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --tolerance 1e-30", "--tolerance '1e-30'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --minimiser foo", "--minimiser 'foo'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --minimiser nlopt:", "--minimiser 'nlopt:'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --guess 1,2", "--guess '1,2'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --guess 1,2,nan,0", "--guess '1,2,nan,0'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --plot x.bmp", "x.bmp"},
               {"--from 0,0,0,0 --to 0,1,0,0 --set beta=0", "--set 'beta=0'"},
               {"--from 0,0,0,0 --to 0,1,0,0 --momentum 1,0,0,0", "--momentum"}});

std::string name_of(const ::testing::TestParamInfo<std::vector<BadInput>>& info) {
  const std::vector<std::string> names{"Program", "FlowData", "FlowTime", "Run", "Geodesic"};
  return names[info.index];
}

INSTANTIATE_TEST_SUITE_P(Cli,
                         BadInputTest,
                         ::testing::Values(kProgram, kFlowData, kFlowTime, kRun, kGeodesic),
                         name_of);

TEST(BadInput, EndsMustBeRegular) {
  const std::string singular = "the coordinates are singular here";
  expect_refused({"geodesic", "bicycle", "--from", "0,0,0,0", "--to", "0,0,0,pi/2"},
                 HasSubstr("--to '0,0,0,pi/2': " + singular));
  expect_refused({"geodesic", "satellite", "--from", "0,pi/2,0", "--to", "0,0,0"},
                 HasSubstr("--from '0,pi/2,0': " + singular));
  const Words line{"continue", "satellite", "--from", "0,0,0", "--to", "0,1,0", "--along"};
  expect_refused(with(line, {"to=0,pi/2,0"}), HasSubstr("--along to '0,pi/2,0': " + singular));
}

TEST(BadInput, WithLineBreaksStillMakesOneLine) {
  expect_refused({"flow", "vehicle", "--from", "1\n2\x1b"}, HasSubstr("'1\\n2\\x1b'"));
}

}  // namespace
}  // namespace carnot::apps::cli_bad_input_test
