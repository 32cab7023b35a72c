// Files, streams and signals of the program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

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
