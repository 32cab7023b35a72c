// carnot atlas: many problems, resumable.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "carnot/shooting/distance_field.h"
#include "command.h"

namespace carnot::apps::cli_atlas_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

const Words kRandom{"atlas", "unicycle", "--random", "24", "--seed", "3", "--no-times", "--quiet"};

// The cells of a CSV file, line by line.
std::vector<Words> cells_of(const std::string& text) {
  std::vector<Words> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines.emplace_back(1);
    for (const char c : line) {
      if (c == ',') {
        lines.back().emplace_back();
      } else {
        lines.back().back() += c;
      }
    }
  }
  return lines;
}

struct AtlasTest : testing::Test {
  Sandbox sandbox;
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(sandbox.directory() / name, std::ios::binary) << text;
  }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    return read_text(sandbox.directory() / name);
  }
  // Interrupts `call` once it has solved something. A slow build takes longer to do so.
  [[nodiscard]] Outcome stop_with_a_journal(const Words& call, const std::string& output) const {
    constexpr double kFirst = 0.3;
    constexpr double kLongest = 30;
    Outcome outcome;
    for (double seconds = kFirst; seconds < kLongest; seconds *= 2) {
      outcome = sandbox.run(call, stopped_after(std::to_string(seconds)));
      if (std::filesystem::exists(sandbox.directory() / (output + ".journal"))) break;
    }
    return outcome;
  }
};

TEST_F(AtlasTest, SolvesEachProblemOfAFileAsGeodesicDoes) {
  put("p.csv",
      "\xef\xbb\xbf"
      "from_x,from_y,from_theta,from_phi,to_x,to_y,to_theta,to_phi,time,set_length\r\n"
      "0,0,0,0,0,1,0,0,1,1\r\n"
      "0, 0,\"0\",0,0,1,0,*,2,1\r\n"
      "\r\n"
      "0,0,0,pi/2,1,1,-pi/4,0,1,2\r\n");
  const Outcome atlas =
      sandbox.run({"atlas", "vehicle", "--problems", "p.csv", "--output", "a.csv", "--json"});
  ASSERT_EQ(atlas.status, 0) << atlas.err;
  EXPECT_EQ(atlas.json()["problems"], 3);
  EXPECT_EQ(atlas.json()["solved"], 3);
  EXPECT_THAT(sandbox.files(), UnorderedElementsAre("p.csv", "a.csv"));
  const std::vector<Words> lines = cells_of(text_of("a.csv"));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_THAT(text_of("a.csv"),
              StartsWith("index,from_x,from_y,from_theta,from_phi,to_x,to_y,to_theta,to_phi,status,"
                         "reason,action,length,p0_x,p0_y,p0_theta,p0_phi,label,morse_index,"
                         "endpoint_error,knot_defect,seconds,"));
  const auto column = [&](const std::string& name) {
    return std::find(lines[0].begin(), lines[0].end(), name) - lines[0].begin();
  };
  const std::vector<Words> alone{
      {"geodesic", "vehicle", "--from", "0,0,0,0", "--to", "0,1,0,0", "--json"},
      {"geodesic", "vehicle", "--from", "0,0,0,0", "--to", "0,1,0,*", "--time", "2", "--json"},
      {"geodesic",
       "vehicle",
       "--from",
       "0,0,0,pi/2",
       "--to",
       "1,1,-pi/4,0",
       "--set",
       "length=2",
       "--json"}};
  for (std::size_t i = 0; i < alone.size(); ++i) {
    const auto geodesic = run(alone[i]).json()["geodesics"][0];
    const Words& row = lines[i + 1];
    EXPECT_EQ(row[0], std::to_string(i));
    EXPECT_EQ(std::stod(row[column("action")]), geodesic["action"].get<double>());
    EXPECT_EQ(std::stod(row[column("p0_phi")]), geodesic["p0"][3].get<double>());
    EXPECT_EQ(row[column("label")], geodesic["label"].get<std::string>());
  }
  EXPECT_EQ(lines[2][column("to_phi")], "*");
  EXPECT_LT(std::stod(lines[2][column("to_found_phi")]), -1);
}

TEST_F(AtlasTest, HasARowForWhatIsNotFound) {
  put("p.csv", "from_x,from_y,from_z,to_x,to_y,to_z\n0,0,1,0,0,1\n0,0,2,0,0,-1\n");
  const Outcome atlas = sandbox.run({"atlas",
                                     "spherical-pendulum",
                                     "--problems",
                                     "p.csv",
                                     "--output",
                                     "a.csv",
                                     "--json",
                                     "--starts",
                                     "8"});
  ASSERT_EQ(atlas.status, 0) << atlas.err;
  EXPECT_EQ(atlas.json()["reasons"]["irregular-end"], 1);
  EXPECT_EQ(cells_of(text_of("a.csv")).size(), 3U);
}

TEST_F(AtlasTest, IsTheSameOnAnyNumberOfThreads) {
  ASSERT_EQ(sandbox.run(with(kRandom, {"--output", "a.jsonl", "--threads", "1"})).status, 0);
  ASSERT_EQ(sandbox.run(with(kRandom, {"--output", "b.jsonl", "--threads", "3"})).status, 0);
  EXPECT_EQ(text_of("a.jsonl"), text_of("b.jsonl"));
  // Number i does not depend on how many there are.
  Words fewer = with(kRandom, {"--output", "c.jsonl"});
  fewer[3] = "5";
  ASSERT_EQ(sandbox.run(fewer).status, 0);
  EXPECT_THAT(text_of("a.jsonl"), StartsWith(text_of("c.jsonl")));
}

// However often it is killed, in the end the file is the same.
class Killed : public AtlasTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(Killed, AtlasGoesOn) {
  const std::string ending = GetParam();
  ASSERT_EQ(sandbox.run(with(kRandom, {"--output", "whole" + ending})).status, 0);
  const std::string name = "a" + ending;
  const std::string journal = (sandbox.directory() / (name + ".journal")).string();
  int kills = 0;
  Outcome outcome;
  do {
    Words call = with(kRandom, {"--output", name, "--threads", kills % 2 == 0 ? "2" : "1"});
    if (std::filesystem::exists(journal)) call.emplace_back("--resume");
    const bool asked = kills % 3 == 2;
    const std::string seconds = std::to_string(0.02 + 0.015 * kills);
    outcome = sandbox.run(
        call,
        "timeout --preserve-status -s " + std::string(asked ? "TERM" : "KILL") + " " + seconds);
    ++kills;
  } while (outcome.status != 0 && kills < 100);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(text_of(name), text_of("whole" + ending));
  EXPECT_FALSE(std::filesystem::exists(journal));
}

INSTANTIATE_TEST_SUITE_P(Endings,
                         Killed,
                         ::testing::Values(".csv", ".jsonl", ".h5"),
                         [](const auto& ending) { return std::string(ending.param).substr(1); });

TEST_F(AtlasTest, LeavesAJournalThatItTellsFromOthers) {
  Words call{"atlas", "unicycle", "--random", "3000", "--output", "a.csv", "--quiet"};
  const Outcome stopped = stop_with_a_journal(call, "a.csv");
  EXPECT_EQ(stopped.status, 130);
  EXPECT_THAT(stopped.err, HasSubstr("--resume goes on"));
  ASSERT_THAT(sandbox.files(), ElementsAre("a.csv.journal"));
  expect_refused(call, HasSubstr("--resume to go on"), sandbox);
  expect_refused(with(call, {"--resume", "--count", "2"}),
                 HasSubstr("options.count is \"\" there and \"2\" here"),
                 sandbox);
  call[1] = "vehicle";
  expect_refused(with(call, {"--resume"}), HasSubstr("scene is"), sandbox);
}

// Lines that were added since an interruption are solved, too, as if they had always been there.
TEST_F(AtlasTest, GoesOnWithAFileThatHasGrown) {
  std::string text = "from_x,from_y,from_theta,to_x,to_y,to_theta\n";
  const auto add = [&](int first, int last) {
    for (int i = first; i < last; ++i) text += fmt::format("0,0,0,1,{},0.5\n", i % 7);
    put("p.csv", text);
  };
  const auto call = [](const char* output, const Words& more) {
    return with({"atlas",
                 "unicycle",
                 "--problems",
                 "p.csv",
                 "--starts",
                 "2",
                 "--no-times",
                 "--quiet",
                 "--output",
                 output},
                more);
  };
  add(0, 511);  // chunks of 1, and of 2 later
  ASSERT_EQ(stop_with_a_journal(call("a.jsonl", {}), "a.jsonl").status, 130);
  ASSERT_TRUE(std::filesystem::exists(sandbox.directory() / "a.jsonl.journal"));
  const std::string before = text;
  text.replace(text.find("1,3,0.5"), 7, "1,4,0.5");
  put("p.csv", text);
  expect_refused(call("a.jsonl", {"--resume"}), HasSubstr("problems.file.checksum is"), sandbox);
  text = before;
  add(511, 515);
  const Outcome outcome = sandbox.run(call("a.jsonl", {"--resume", "--json"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["problems"], 515);
  EXPECT_GT(outcome.json()["resumed"], 0);
  ASSERT_EQ(sandbox.run(call("whole.jsonl", {})).status, 0);
  EXPECT_EQ(text_of("a.jsonl"), text_of("whole.jsonl"));
}

TEST_F(AtlasTest, StopsWhereFilesMayNotGrow) {
  const Words call = with(kRandom, {"--output", "a.jsonl"});
  ASSERT_EQ(sandbox.run(with(kRandom, {"--output", "whole.jsonl"})).status, 0);
  const Outcome full = sandbox.run(call, "ulimit -f 8;");
  EXPECT_EQ(full.status, 1);
  EXPECT_THAT(full.err, HasSubstr("make room"));
  ASSERT_EQ(sandbox.run(with(call, {"--resume"})).status, 0);
  EXPECT_EQ(text_of("a.jsonl"), text_of("whole.jsonl"));
}

std::vector<double> numbers_of(const std::string& file, const char* name) {
  const hid_t in = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(in, name, H5P_DEFAULT);
  const hid_t space = H5Dget_space(set);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(in);
  return values;
}

TEST_F(AtlasTest, ShapesArraysLikeTheGrid) {
  const Words grid{"atlas",
                   "unicycle",
                   "--from",
                   "0,0,0",
                   "--to",
                   "0,1,0",
                   "--grid",
                   "theta=-pi:pi:4, x=0:2:3",
                   "--trajectories",
                   "3",
                   "--output"};
  ASSERT_EQ(sandbox.run(with(grid, {"a.h5"})).status, 0);
  ASSERT_EQ(sandbox.run(with(grid, {"a.csv"})).status, 0);
  const std::string file = (sandbox.directory() / "a.h5").string();
  constexpr double kPi = std::numbers::pi;
  EXPECT_THAT(numbers_of(file, "theta"), ElementsAre(-kPi, -kPi / 2, 0, kPi / 2));
  EXPECT_THAT(numbers_of(file, "x"), ElementsAre(0, 1, 2));
  const std::vector<Words> lines = cells_of(text_of("a.csv"));
  const std::vector<double> action = numbers_of(file, "action");
  const std::vector<double> path = numbers_of(file, "trajectory_q");
  ASSERT_EQ(action.size(), 12U);
  ASSERT_EQ(lines.size(), 13U);
  ASSERT_EQ(path.size(), 12U * 3 * 3);
  for (std::size_t i = 0; i < action.size(); ++i) {
    EXPECT_EQ(std::stod(lines[i + 1][9]), action[i]);
    EXPECT_NEAR(path[9 * i + 6], static_cast<double>(i % 3), 1e-9);  // x at the end
    EXPECT_NEAR(path[9 * i + 8], -kPi + kPi / 6 * static_cast<double>(i - i % 3), 1e-9);  // theta
  }
}

TEST_F(AtlasTest, FieldsAgreeWithSearches) {
  const Words grid{"atlas",
                   "unicycle",
                   "--from",
                   "0,0,0",
                   "--grid",
                   "x=0:1:3, y=-1:1:5, theta=-pi:pi:12",
                   "--mod-angles",
                   "--quiet",
                   "--json",
                   "--output"};
  const Outcome outcome = sandbox.run(with(grid, {"field.csv", "--field", "--check", "20"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = outcome.json()["field"];
  EXPECT_EQ(report["checked"], 20);
  EXPECT_EQ(report["lower"], 0);
  EXPECT_EQ(report["triangles"], 20);
  EXPECT_EQ(report["violations"], 0);
  EXPECT_EQ(report["settled"], true);
  EXPECT_EQ(outcome.json()["solved"], 3 * 5 * 12);
  const Outcome two = sandbox.run(with(grid, {"two.csv", "--field", "--branches", "2"}));
  ASSERT_EQ(two.status, 0) << two.err;
  EXPECT_GT(two.json()["field"]["improved"], report["improved"].get<long>() + 3 * 5 * 12 / 2);
  ASSERT_EQ(sandbox.run(with(grid, {"a.csv"})).status, 0);
  const std::vector<Words> field = cells_of(text_of("field.csv"));
  const std::vector<Words> searched = cells_of(text_of("a.csv"));
  ASSERT_EQ(field.size(), searched.size());
  EXPECT_EQ(field[0], searched[0]);
  for (std::size_t i = 1; i < field.size(); ++i) {
    const double action = std::stod(searched[i][9]);
    EXPECT_NEAR(std::stod(field[i][9]), action, 1e-8 * action) << i;
  }
}

// A field that was killed goes on from the state that it has kept, and becomes the same.
TEST_F(AtlasTest, FieldsGoOn) {
  const Words grid{"atlas",
                   "unicycle",
                   "--from",
                   "0,0,0",
                   "--grid",
                   "x=-3:3:37, y=-3:3:37, theta=-pi:pi:36",
                   "--mod-angles",
                   "--field",
                   "--check",
                   "20",
                   "--quiet",
                   "--output"};
  ASSERT_EQ(sandbox.run(with(grid, {"whole.jsonl"})).status, 0);
  const auto exists = [&](const char* name) {
    return std::filesystem::exists(sandbox.directory() / name);
  };
  for (int k = 0; k < 100 && !exists("a.jsonl.journal.state"); ++k) {
    ASSERT_FALSE(exists("a.jsonl")) << "it is done before anything is kept";
    Words call = with(grid, {"a.jsonl"});
    if (exists("a.jsonl.journal")) call.emplace_back("--resume");
    (void)sandbox.run(call, "timeout -s KILL " + std::to_string(0.6 + 0.1 * k));
  }
  // A state that is damaged is as good as none.
  put("b.jsonl.journal", text_of("a.jsonl.journal"));
  put("b.jsonl.journal.state", text_of("a.jsonl.journal.state").replace(1000, 1, "?"));
  const Outcome repaired = sandbox.run(with(grid, {"b.jsonl", "--resume", "--json"}));
  ASSERT_EQ(repaired.status, 0) << repaired.err;
  EXPECT_EQ(repaired.json()["repaired"], 1);
  EXPECT_EQ(repaired.json()["resumed"], 0);
  EXPECT_EQ(text_of("b.jsonl"), text_of("whole.jsonl"));
  expect_refused(with(grid, {"a.jsonl"}), HasSubstr("--resume to go on"), sandbox);
  expect_refused(with(grid, {"a.jsonl", "--resume", "--seed", "1"}), HasSubstr("seed is"), sandbox);
  expect_refused(
      with(grid, {"a.jsonl", "--resume", "--branches", "2"}), HasSubstr("branches is"), sandbox);
  const Outcome stopped = sandbox.run(with(grid, {"a.jsonl", "--resume"}), stopped_after("0.2"));
  EXPECT_EQ(stopped.status, 130);
  EXPECT_THAT(stopped.err, HasSubstr("--resume goes on"));
  const Outcome outcome = sandbox.run(with(grid, {"a.jsonl", "--resume", "--json"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(outcome.json()["resumed"], 0);
  EXPECT_EQ(outcome.json()["repaired"], 0);
  EXPECT_EQ(text_of("a.jsonl"), text_of("whole.jsonl"));
  EXPECT_THAT(sandbox.files(), UnorderedElementsAre("a.jsonl", "b.jsonl", "whole.jsonl"));
}

TEST_F(AtlasTest, WritesDistancesForPlanners) {
  const Outcome outcome = sandbox.run({"atlas",
                                       "unicycle",
                                       "--from",
                                       "0,0,0",
                                       "--time",
                                       "2",
                                       "--grid",
                                       "x=0:1:3, y=-1:1:5, theta=-pi:pi:12",
                                       "--mod-angles",
                                       "--field",
                                       "--check",
                                       "0",
                                       "--output",
                                       "left.field"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(sandbox.files(), ElementsAre("left.field"));
  const auto field = DistanceField::read((sandbox.directory() / "left.field").string());
  EXPECT_EQ(field.scene(), "unicycle");
  // A quarter of the unit circle leads there, and whole turns do not count.
  const double pi = std::numbers::pi;
  const double bound = field.lower_bound(std::vector<double>{1, 1, 5 * pi / 2});
  EXPECT_LE(bound, std::sqrt(2) * pi / 2);
  EXPECT_GE(bound, 1);
}

// Slices of a field, in three of which two geodesics are equally short somewhere.
TEST_F(AtlasTest, DrawsSlicesOfAGrid) {
  const Words grid{"atlas",
                   "unicycle",
                   "--from",
                   "0,0,0",
                   "--grid",
                   "x=-3:3:25, y=-3:3:25, theta=-1:1:3",
                   "--field",
                   "--check",
                   "0",
                   "--output",
                   "f.csv",
                   "--plot",
                   "f.svg"};
  const Outcome outcome = sandbox.run(grid);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("written: f.svg"));
  const std::string picture = text_of("f.svg");
  EXPECT_THAT(picture, HasSubstr("a line every 0.5"));
  EXPECT_THAT(picture, HasSubstr("cut locus"));
  const Outcome smooth = sandbox.run({"atlas",
                                      "unicycle",
                                      "--from",
                                      "0,0,0",
                                      "--to",
                                      "0,0,0.3",
                                      "--grid",
                                      "x=1:2:9, y=-0.5:0.5:9",
                                      "--output",
                                      "s.csv",
                                      "--plot",
                                      "s.svg"});
  ASSERT_EQ(smooth.status, 0) << smooth.err;
  EXPECT_THAT(text_of("s.svg"), Not(HasSubstr("cut locus")));
}

TEST_F(AtlasTest, RefusesBadInput) {
  const Words atlas{"atlas", "unicycle", "--output", "a.csv"};
  const auto refused = [&](const Words& more, const char* why) {
    expect_refused(with(atlas, more), HasSubstr(why), sandbox);
  };
  refused({}, "--problems '': is missing");
  refused({"--random", "3", "--grid", "x=0:1:2"}, "given besides another");
  refused({"--random", "0"}, "out of range");
  refused({"--from", "0,0,0", "--grid", "x=0:1:2"}, "nothing says what y is");
  refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "z=0:1:2"}, "no coordinate 'z'");
  refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "x=0:1"}, "START:STOP:COUNT");
  refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "x=0:1:2,x=0:1:2"}, "given twice");
  refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "x=-1e308:1e308:3"}, "too wide");
  refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "x=0:1:100000001"}, "10000000");
  refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "x=0:1:40000,y=0:1:40000"}, "too many");
  refused({"--to", "0,0,0", "--grid", "x=0:1:2"}, "--from '': is missing");
  refused({"--problems", "none.csv"}, "No such file");
  refused({"--random", "3", "--field"}, "--grid");
  refused({"--random", "3", "--plot", "a.png"}, "two axes");
  refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "x=0:1:2", "--field", "--count", "2"},
          "one geodesic");
  for (const char* counted : {"--branches", "--check"}) {
    refused({"--from", "0,0,0", "--to", "0,0,0", "--grid", "x=0:1:2", "--field", counted, "-1"},
            counted);
  }
  expect_refused({"atlas", "unicycle", "--random", "3", "--output", "a.field"},
                 HasSubstr("unknown ending"),
                 sandbox);
  expect_refused({"atlas",
                  "unicycle",
                  "--from",
                  "0,0,0",
                  "--to",
                  "0,0,0",
                  "--grid",
                  "x=0:1:3",
                  "--field",
                  "--output",
                  "a.field"},
                 HasSubstr("the whole space"),
                 sandbox);
  expect_refused({"atlas", "unicycle", "--random", "3"}, HasSubstr("--output"), sandbox);
  expect_refused({"atlas", "unicycle", "--random", "3", "--output", "a.txt"},
                 HasSubstr("unknown ending"),
                 sandbox);
  expect_refused({"atlas", "unicycle", "--random", "3", "--output", "a.h5", "--all"},
                 HasSubstr("--all"),
                 sandbox);
  const auto bad = [&](const std::string& text, const char* why) {
    put("p.csv", text);
    refused({"--problems", "p.csv"}, why);
  };
  const std::string header = "from_x,from_y,from_theta,to_x,to_y,to_theta";
  bad("", "no header");
  bad(header + "\n", "no problems");
  bad("from_x,to_x\n0,1\n", "column 'from_y': is missing");
  bad(header + ",tmie\n", "'tmie': not expected");
  bad(header + ",to_x\n", "given twice");
  bad(header + "\n0,0,0,0,1\n", "p.csv:2 '0,0,0,0,1': 5 values");
  bad(header + "\n0,0,0,0,1,0\n0,0,0,0,one,0\n", "p.csv:3: column to_y 'one'");
  bad(header + ",time\n0,0,0,0,1,0,-1\n", "not positive");
  bad(header + ",set_beta\n0,0,0,0,1,0,-1\n", "beta");
}

// As those of stress: what is drawn keeps to the limits.
TEST_F(AtlasTest, DrawsTargetsThatKeepToLimits) {
  const Outcome outcome = sandbox.run({"atlas",
                                       "vehicle",
                                       "--random",
                                       "5",
                                       "--limit",
                                       "phi-theta in -0.3:0.3",
                                       "--output",
                                       "limited.csv",
                                       "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["solved"], 5);
}

}  // namespace
}  // namespace carnot::apps::cli_atlas_test
