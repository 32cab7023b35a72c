// Families of geodesics and the laboratory are in programs of their own: carnot becomes them, or
// says that they are not there.
#include "run/deferred.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "command.h"

namespace carnot::apps::deferred_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The words of `scripts/run.sh` before the line's `)`.
std::set<std::string> words_before_target(const std::string& target) {
  std::ifstream file(CARNOT_SOURCE_DIR "/scripts/run.sh");
  std::string line;
  while (std::getline(file, line) && line.find(target) == std::string::npos) {
  }
  std::istringstream words(line.substr(0, line.find(')')));
  std::set<std::string> names;
  for (std::string word; words >> word;) {
    if (word != "|") names.insert(word);
  }
  return names;
}

// run.sh builds a program where one of its subcommands is asked for, and only then.
TEST(Deferred, RunShKnowsTheSubcommands) {
  for (const Program program : {Program::kFamilies, Program::kLaboratory}) {
    std::set<std::string> expected;
    for (const DeferredCommand& command : kDeferred) {
      if (command.program == program) expected.insert(command.name);
    }
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(words_before_target(program_name(program)), expected);
  }
}

TEST(Deferred, CarnotListsTheSubcommands) {
  const std::string help = run({"--help"}).out;
  for (const DeferredCommand& command : kDeferred) {
    EXPECT_THAT(help, AllOf(HasSubstr(command.name), HasSubstr(command.description)));
    EXPECT_EQ(program_of(command.name), command.program);
    EXPECT_NE(command.program, Program::kCarnot);
  }
  EXPECT_EQ(program_of("geodesic"), Program::kCarnot);
  EXPECT_EQ(program_of("--help"), Program::kCarnot);
}

std::string beside_carnot(Program program) {
  return std::filesystem::path(CARNOT_PROGRAM).replace_filename(program_name(program));
}

// A user who knows only one of the programs sees what carnot has, in the same order.
TEST(Deferred, EveryProgramListsTheSame) {
  const std::string help = run({"--help"}).out;
  const Sandbox sandbox;
  for (const Program program : {Program::kFamilies, Program::kLaboratory}) {
    EXPECT_EQ(sandbox.run({"--help"}, "", beside_carnot(program)).out, help);
  }
}

// Its arguments, output and exit status pass through.
TEST(Deferred, CarnotBecomesTheProgram) {
  const Outcome good = run({"methods", "--json"});
  EXPECT_EQ(good.status, 0);
  EXPECT_EQ(good.json()["arguments"], (Words{"methods", "--json"}));
  for (const DeferredCommand& command : kDeferred) {
    const Outcome bad = run({command.name, "--bad"});
    EXPECT_EQ(bad.status, 2);
    EXPECT_THAT(bad.err, HasSubstr("--bad"));
  }
}

// So does each program for those that come after it.
TEST(Deferred, FamiliesBecomeTheLaboratory) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"methods", "--json"}, "", beside_carnot(Program::kFamilies));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.json()["arguments"], (Words{"methods", "--json"}));
}

TEST(Deferred, WhereAProgramIsNotBuiltCarnotSaysSo) {
  for (const char* const name : {"atlas", "verify"}) {
    const Sandbox sandbox;
    std::filesystem::copy_file(CARNOT_PROGRAM, sandbox.directory() / "carnot");
    const Outcome outcome = sandbox.run({}, fmt::format("sh -c './carnot {}'", name));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr(name), HasSubstr("target " + program_name(program_of(name)))));
  }
}

}  // namespace
}  // namespace carnot::apps::deferred_test
