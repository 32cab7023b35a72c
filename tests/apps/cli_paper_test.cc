// The subcommand `carnot paper` as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "command.h"

namespace carnot::apps::cli_paper_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::set<std::string> kFigures{"vehicle",
                                     "convergence",
                                     "symplectic_form",
                                     "energy",
                                     "straight_line",
                                     "circle",
                                     "circle_returns",
                                     "heisenberg"};

TEST(PaperCommand, DrawsEveryFigureAndTellsEveryNumber) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"paper", "--json", "--output", "new/figures"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = outcome.json();
  EXPECT_THAT(keys(json),
              ElementsAre("version",
                          "arguments",
                          "status",
                          "message",
                          "rows",
                          "tables",
                          "figures",
                          "elapsed_seconds"));
  EXPECT_EQ(json["status"], "completed");
  std::set<std::string> sections;
  for (const auto& row : json["rows"]) {
    EXPECT_THAT(
        keys(row),
        ElementsAre("part", "what", "paper", "here", "value", "expected", "verdict", "note"));
    EXPECT_TRUE(row["verdict"] == "holds" || row["verdict"] == "misprint") << row.dump();
    sections.insert(row["part"].get<std::string>().substr(0, 9));
  }
  EXPECT_THAT(sections, ElementsAre("Section 5", "Section 6"));
  for (const auto& table : json["tables"]) {
    EXPECT_THAT(keys(table), ElementsAre("title", "columns", "rows"));
    for (const auto& row : table["rows"]) EXPECT_EQ(row.size(), table["columns"].size());
  }
  const fs::path directory = sandbox.directory() / "new" / "figures";
  std::set<std::string> figures;
  for (const auto& figure : json["figures"]) {
    const std::string name = figure["name"];
    figures.insert(name);
    const std::string picture = read_text(directory / (name + ".png"));
    EXPECT_EQ(picture.substr(0, 4), "\x89PNG") << name;
    EXPECT_GT(picture.size(), 10000U) << name;
  }
  EXPECT_EQ(figures, kFigures);
  EXPECT_EQ(read_text(directory / "paper.json"), outcome.out);
  EXPECT_EQ(std::distance(fs::directory_iterator(directory), {}),
            static_cast<std::ptrdiff_t>(kFigures.size()) + 1);
}

TEST(PaperCommand, PrintsATable) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"paper"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("paper"),
                    HasSubstr("here"),
                    HasSubstr("order of the midpoint rule"),
                    HasSubstr("misprint"),
                    HasSubstr("1.618")));
  EXPECT_THAT(sandbox.files(), IsEmpty());
}

TEST(PaperCommand, HasHelp) {
  const Outcome outcome = run({"paper", "--help"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("Examples"), HasSubstr("Exit status")));
}

void expect_refusal(const Sandbox& sandbox, const std::string& directory, const std::string& why) {
  expect_refused({"paper", "--output", directory},
                 AllOf(HasSubstr("--output '" + directory + "'"),
                       HasSubstr(why),
                       HasSubstr("accepted: a directory")),
                 sandbox);
}

TEST(PaperCommand, RefusesAPlaceThatIsNoDirectory) {
  const Sandbox sandbox;
  std::ofstream(sandbox.directory() / "taken") << "text";
  expect_refusal(sandbox, "taken", "is not a directory");
  expect_refusal(sandbox, "taken/figures", "is not a directory");
  EXPECT_EQ(read_text(sandbox.directory() / "taken"), "text");
  expect_refusal(sandbox, "/dev/null", "is not a directory");
}

TEST(PaperCommand, RefusesADirectoryItMayNotWriteIn) {
  if (geteuid() == 0) return;  // root may write everywhere
  const Sandbox sandbox;
  const fs::path locked = sandbox.directory() / "locked";
  fs::create_directory(locked);
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  expect_refusal(sandbox, "locked", "no permission");
  expect_refusal(sandbox, "locked/figures", "no permission");
  fs::permissions(locked, fs::perms::owner_all);
}

TEST(PaperCommand, LeavesNothingWhenInterrupted) {
  for (const char* delay : {"0.5", "2.5"}) {  // in the runs; among the figures, perhaps
    const Sandbox sandbox;
    const Outcome outcome = sandbox.run({"paper", "--output", "a/b"}, stopped_after(delay));
    if (outcome.status == 0) continue;  // a fast machine was done
    EXPECT_EQ(outcome.status, 130);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, "carnot: interrupted\n");
    EXPECT_THAT(sandbox.files(), IsEmpty());
  }
}

TEST(PaperCommand, FailsWithoutGnuplot) {
  const Sandbox sandbox;
  const Outcome outcome = sandbox.run({"paper", "--output", "figures"}, "env PATH=/nonexistent");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("gnuplot"));
  EXPECT_THAT(outcome.out, HasSubstr("order of the midpoint rule"));
  EXPECT_THAT(sandbox.files(), IsEmpty());
}

}  // namespace
}  // namespace carnot::apps::cli_paper_test
