#include "carnot/plots/plot_file.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "plot_fixtures.h"

namespace carnot::plots::plot_file_test {
namespace {

using PictureFile = Directory;

Picture line() { return {300, 200, "plot [0:1] x\n", false}; }

TEST_F(PictureFile, EachEndingHasItsOwnMagicBytes) {
  const std::vector<std::pair<std::string, std::string>> magic = {{".png", "\x89PNG"},
                                                                  {".svg", "<?xml"},
                                                                  {".pdf", "%PDF"},
                                                                  {".gif", "GIF8"},
                                                                  {".PNG", "\x89PNG"}};
  for (const auto& [ending, bytes] : magic) {
    const std::string name = file("picture" + ending);
    write_picture(name, line());
    EXPECT_EQ(contents(name).substr(0, bytes.size()), bytes) << name;
  }
  EXPECT_EQ(entries(), 5);
}

TEST_F(PictureFile, OverwritesAnOlderFile) {
  std::ofstream(file("a.svg")) << "old";
  write_picture(file("a.svg"), line());
  EXPECT_EQ(contents(file("a.svg")).substr(0, 5), "<?xml");
}

TEST_F(PictureFile, UnknownEndingIsRefusedByName) {
  for (const std::string name : {"a.jpg", "a", "png", ".png", "a.png.txt"}) {
    try {
      validate_plot_file(file(name));
      ADD_FAILURE() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
      EXPECT_NE(std::string(error.what()).find(".png, .svg, .pdf or .gif"), std::string::npos);
    }
  }
}

TEST_F(PictureFile, PlacesThatCannotBeWrittenAreRefused) {
  EXPECT_THROW(validate_plot_file(file("missing/a.png")), std::invalid_argument);
  EXPECT_THROW(write_picture(file("missing/a.png"), line()), std::invalid_argument);
  std::filesystem::create_directory(file("directory.png"));
  EXPECT_THROW(validate_plot_file(file("directory.png")), std::invalid_argument);
  EXPECT_EQ(entries(), 1);
}

// Root may write everywhere, so another user tries it then, in a process of its own.
TEST_F(PictureFile, AWriteProtectedDirectoryIsRefused) {
  using std::filesystem::perms;
  constexpr uid_t kNobody = 65534;
  std::filesystem::permissions(
      path_, perms::owner_read | perms::owner_exec | perms::others_read | perms::others_exec);
  const auto refused = [&] {
    if (geteuid() == 0 && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) return false;
    try {
      write_picture(file("a.png"), line());
      return false;
    } catch (const std::invalid_argument& error) {
      return std::string(error.what()).find("writable") != std::string::npos;
    }
  };
  EXPECT_EXIT(std::_Exit(refused() ? 0 : 1), ::testing::ExitedWithCode(0), "");
  EXPECT_EQ(entries(), 0);
  std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
}

TEST_F(PictureFile, FailureCarriesTheMessageAndLeavesNothing) {
  std::ofstream(file("a.png")) << "old";
  Picture bad = line();
  bad.commands = "plot no_such_function(x)\n";
  // What comes after the error is not read, however long it is.
  for (int i = 0; i < 20000; ++i) bad.commands += "# a long comment after the error\n";
  try {
    write_picture(file("a.png"), bad);
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no_such_function"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(contents(file("a.png")), "old");
  EXPECT_EQ(entries(), 1);
}

// Ctrl-C is sent to the group of processes of the terminal, and gnuplot may hang when it comes.
TEST_F(PictureFile, GnuplotIsInAGroupOfItsOwn) {
  Picture asking = line();
  // The shell that gnuplot starts prints its parent's process and group, which gnuplot repeats.
  asking.commands = "print system('cut -d\" \" -f1,5 /proc/$PPID/stat')\n" + asking.commands;
  std::istringstream said(write_picture(file("a.png"), asking));
  pid_t process = 0;
  pid_t group = 0;
  ASSERT_TRUE(said >> process >> group);
  EXPECT_EQ(group, process);
  EXPECT_NE(group, getpgrp());
}

TEST_F(PictureFile, MissingGnuplotIsReported) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", path_.c_str(), 1);
  try {
    write_picture(file("a.png"), line());
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("gnuplot could not draw"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("cannot be started"), std::string::npos);
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(entries(), 0);
}

}  // namespace
}  // namespace carnot::plots::plot_file_test
