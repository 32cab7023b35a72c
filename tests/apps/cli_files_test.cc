// Files, streams and signals of the program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "command.h"

namespace carnot::apps::cli_files_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const Words kFlow{"flow",
                  "vehicle",
                  "--from",
                  "0,0,0,0",
                  "--momentum",
                  "1,0,0,0.5",
                  "--time",
                  "5",
                  "--steps",
                  "10",
                  "--samples",
                  "6"};

TEST(Files, JsonEqualsStdout) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run(with(kFlow, {"--json", "--output", "a.json"}));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(sandbox.files(), ElementsAre("a.json"));
  EXPECT_EQ(read_text(sandbox.directory() / "a.json"), outcome.out);
}

TEST(Files, CsvHasTheContractsColumns) {
  const Sandbox sandbox;
  EXPECT_EQ(sandbox.run(with(kFlow, {"--output", "a.csv"})).status, 0);
  const std::string csv = read_text(sandbox.directory() / "a.csv");
  EXPECT_THAT(csv,
              StartsWith("t,q_x,q_y,q_theta,q_phi,p_x,p_y,p_theta,p_phi,lambda_1,lambda_2,"
                         "hamiltonian\n0,0,0,0,0,1,0,0,0.5,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
}

TEST(Files, ExistingOnesAreReplacedOnlyOnSuccess) {
  const Sandbox sandbox;
  std::ofstream(sandbox.directory() / "a.csv") << "old";
  EXPECT_EQ(sandbox.run(with(kFlow, {"--samples", "3", "--output", "a.csv"})).status, 2);
  EXPECT_EQ(read_text(sandbox.directory() / "a.csv"), "old");
  EXPECT_EQ(sandbox.run(with(kFlow, {"--output", "a.csv"})).status, 0);
  EXPECT_NE(read_text(sandbox.directory() / "a.csv"), "old");
}

TEST(Files, PlotAppears) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run(with(kFlow, {"--plot", "a.svg"}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(sandbox.files(), ElementsAre("a.svg"));
}

TEST(Streams, AFullStdoutIsAFailure) {
  const Sandbox sandbox;
  const Outcome outcome =
      sandbox.run({"-c", "'" CARNOT_PROGRAM "' scenes > /dev/full"}, "sh -c 'exec sh \"$@\"'");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write to stdout"));
}

// A command line of the shell that runs the program as $CARNOT.
Outcome run_shell(const Sandbox& sandbox, const std::string& line) {
  return sandbox.run({"-c", "CARNOT='" CARNOT_PROGRAM "'; " + line}, "sh -c 'exec sh \"$@\"'");
}
const std::string kShortFlow =
    "\"$CARNOT\" flow vehicle --from 0,0,0,0 --momentum 1,0,0,0.5 --time 5 --steps 10";

TEST(Streams, ClosedOnesAreAFailureAndNoCrash) {
  const Sandbox sandbox;
  for (const std::string closed : {">&-", ">&- 2>&-", "<&- >&- 2>&-"}) {
    EXPECT_EQ(run_shell(sandbox, kShortFlow + " --output a.json " + closed).status, 1) << closed;
    EXPECT_THAT(read_text(sandbox.directory() / "a.json"), StartsWith("{"));
    EXPECT_EQ(run_shell(sandbox, "\"$CARNOT\" --help " + closed).status, 1) << closed;
  }
  EXPECT_EQ(run_shell(sandbox, kShortFlow + " 2>&-").status, 0);
  EXPECT_EQ(run_shell(sandbox, "\"$CARNOT\" flow 2>&-").status, 2);
}

TEST(Streams, HelpAndVersionMustArrive) {
  const Sandbox sandbox;
  for (const std::string option : {"--help", "--version", "flow --help"}) {
    EXPECT_EQ(run_shell(sandbox, "\"$CARNOT\" " + option + " > /dev/full").status, 1) << option;
    EXPECT_EQ(run_shell(sandbox, "\"$CARNOT\" " + option).status, 0) << option;
  }
}

TEST(Files, AreSaidToBeWrittenOnlyIfTheyAre) {
  const Sandbox sandbox;
  const std::string geodesic =
      "\"$CARNOT\" geodesic unicycle --from 0,0,0 --to 1,0,0 --quiet --plot a.svg --output a.csv";
  const Outcome missing = run_shell(sandbox, "PATH=/nowhere " + geodesic);
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("gnuplot could not draw 'a.svg'"));
  EXPECT_THAT(missing.out, HasSubstr("written: a.csv"));
  EXPECT_THAT(missing.out, ::testing::Not(HasSubstr("a.svg")));
  EXPECT_THAT(run_shell(sandbox, geodesic).out, HasSubstr("written: a.svg\nwritten: a.csv\n"));
}

TEST(Files, LeaveNothingWhereTheyMayNotGrow) {
  const Sandbox sandbox;
  const Outcome outcome =
      run_shell(sandbox, "ulimit -f 1; " + kShortFlow + " --samples 1000 --output a.json");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(sandbox.files(), IsEmpty());
}

TEST(Files, AreWrittenThroughLinksAndIntoPipes) {
  const Sandbox sandbox;
  const auto link = sandbox.directory() / "link.json";
  std::filesystem::create_directory(sandbox.directory() / "there");
  std::filesystem::create_symlink("there/a.json", link);
  EXPECT_EQ(run_shell(sandbox, kShortFlow + " --output link.json").status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_THAT(read_text(sandbox.directory() / "there" / "a.json"), StartsWith("{"));
  const Outcome piped = run_shell(
      sandbox, "mkfifo a.json; cat a.json > read & " + kShortFlow + " --output a.json; wait");
  EXPECT_EQ(piped.status, 0);
  EXPECT_THAT(read_text(sandbox.directory() / "read"), StartsWith("{"));
  EXPECT_TRUE(std::filesystem::is_fifo(sandbox.directory() / "a.json"));
}

TEST(Flow, NeedsATimeThatPasses) {
  const Outcome outcome = run(with(kFlow, {"--start-time", "1e300"}));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no time passes"));
}

TEST(Messages, StayShort) {
  const Outcome outcome = run({"flow", "vehicle", "--from", std::string(100000, 'x')});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_LT(outcome.err.size(), 1000U);
}

// A flow of hours.
const Words kLong{"flow",
                  "vehicle",
                  "--from",
                  "0,0,0,0",
                  "--momentum",
                  "1,0,0,0.5",
                  "--time",
                  "1e6",
                  "--steps",
                  "10000000000",
                  "--output",
                  "a.json"};

class Interrupts : public ::testing::TestWithParam<std::pair<std::string, Words>> {};

TEST_P(Interrupts, StopCleanly) {
  const auto& [signal, more] = GetParam();
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run(with(kLong, more), stopped_after("0.5", signal));
  EXPECT_EQ(outcome.status, 130);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "carnot: interrupted\n");
  EXPECT_THAT(sandbox.files(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Cli,
                         Interrupts,
                         ::testing::Values(std::pair("INT", Words{}),
                                           std::pair("TERM", Words{"--json"})));

TEST(Interrupts, StopTheChoiceOfSteps) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"flow",
                                       "vehicle",
                                       "--from",
                                       "0,0,0,0",
                                       "--momentum",
                                       "1,2,3,4",
                                       "--time",
                                       "3e4",
                                       "--method",
                                       "gauss4",
                                       "--tolerance",
                                       "1e-9",
                                       "--output",
                                       "a.json"},
                                      stopped_after("0.5"));
  EXPECT_EQ(outcome.status, 130);
  EXPECT_THAT(sandbox.files(), IsEmpty());
}

}  // namespace
}  // namespace carnot::apps::cli_files_test
