#include "text/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "command.h"
#include "text/progress_bar.h"
#include "text/text_table.h"

namespace carnot::apps::output_file_test {
namespace {

using ::testing::ElementsAre;

TEST(WriteFile, ReplacesAndLeavesNothingElse) {
  const Sandbox sandbox;
  const std::string path = sandbox.directory() / "a.json";
  write_file(path, "first");
  write_file(path, "second");
  EXPECT_EQ(read_text(path), "second");
  EXPECT_THAT(sandbox.files(), ElementsAre("a.json"));
}

TEST(WriteFile, LeavesNothingWhenItFails) {
  const Sandbox sandbox;
  EXPECT_THROW(write_file(sandbox.directory() / "no" / "a.json", "x"), std::runtime_error);
  std::filesystem::create_directory(sandbox.directory() / "full");
  std::filesystem::create_directory(sandbox.directory() / "full" / "inside");
  EXPECT_THROW(write_file(sandbox.directory() / "full", "x"), std::runtime_error);
  EXPECT_THAT(sandbox.files(), ElementsAre("full"));
}

TEST(CheckOutputFile, WantsAKnownEndingInADirectory) {
  const Sandbox sandbox;
  const auto check = [&](const std::string& name) {
    check_output_file("--output", sandbox.directory() / name, {".json", ".csv"});
  };
  EXPECT_NO_THROW(check("a.json"));
  EXPECT_NO_THROW(check("a.b.csv"));
  std::filesystem::create_directory(sandbox.directory() / "d.json");
  for (const char* name : {"a.txt", "a", ".json", "json", "no/a.json", "d.json", ""}) {
    EXPECT_THROW(check(name), std::invalid_argument) << name;
  }
  EXPECT_THAT(sandbox.files(), ElementsAre("d.json"));
}

TEST(ProgressLine, TellsRateAndTimeLeft) {
  EXPECT_EQ(progress_line(0, 0, 100, "steps"), "[..............................]   0 %");
  EXPECT_EQ(progress_line(0.5, 65, 2e6, "steps"),
            "[###############...............]  50 %  15.4 k steps/s  1:05 left");
  EXPECT_EQ(progress_line(2, 1, 10, "starts"),
            "[##############################] 100 %  10 starts/s  0:00 left");
}

TEST(TextTable, AlignsColumns) {
  EXPECT_EQ(text_table({{"a", "long"}, {"wide", "x"}, {"b"}}), "a     long\nwide  x\nb\n");
  EXPECT_EQ(text_table({}), "");
  EXPECT_EQ(text_vector({1, -0.5}), "(1, -0.5)");
}

}  // namespace
}  // namespace carnot::apps::output_file_test
