// The laboratory is a program of its own: carnot becomes it, or says that it is not there.
#include "run/laboratory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "command.h"

namespace carnot::apps::laboratory_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// run.sh builds the laboratory where one of these is asked for, and only then.
TEST(Laboratory, RunShKnowsItsSubcommands) {
  std::ifstream file(CARNOT_SOURCE_DIR "/scripts/run.sh");
  std::string line;
  while (std::getline(file, line) && line.find("carnot_laboratory") == std::string::npos) {
  }
  std::istringstream words(line.substr(0, line.find(')')));
  std::set<std::string> names;
  for (std::string word; words >> word;) {
    if (word != "|") names.insert(word);
  }
  std::set<std::string> expected;
  for (const LaboratoryCommand& command : kLaboratory) expected.insert(command.name);
  EXPECT_EQ(names, expected);
}

TEST(Laboratory, CarnotListsItsSubcommands) {
  const std::string help = run({"--help"}).out;
  for (const LaboratoryCommand& command : kLaboratory) {
    EXPECT_THAT(help, AllOf(HasSubstr(command.name), HasSubstr(command.description)));
    EXPECT_TRUE(is_laboratory_command(command.name));
  }
  EXPECT_FALSE(is_laboratory_command("geodesic"));
}

// Its arguments, output and exit status pass through.
TEST(Laboratory, CarnotBecomesIt) {
  const Outcome good = run({"methods", "--json"});
  EXPECT_EQ(good.status, 0);
  EXPECT_EQ(good.json()["arguments"], (Words{"methods", "--json"}));
  const Outcome bad = run({"methods", "--bad"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.err, HasSubstr("--bad"));
}

TEST(Laboratory, WhereItIsNotBuiltCarnotSaysSo) {
  const Sandbox sandbox;
  std::filesystem::copy_file(CARNOT_PROGRAM, sandbox.directory() / "carnot");
  const Outcome outcome = sandbox.run({}, "sh -c './carnot verify'");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("verify"), HasSubstr("target carnot_laboratory")));
}

}  // namespace
}  // namespace carnot::apps::laboratory_test
