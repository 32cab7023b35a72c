// Runs the built program as a user does: arguments in; exit status, stdout and stderr out.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace carnot::apps {

using Words = std::vector<std::string>;

struct Outcome {
  int status = -1;
  std::string out;
  std::string err;

  [[nodiscard]] nlohmann::ordered_json json() const {
    return nlohmann::ordered_json::parse(out, nullptr, false);
  }
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::string shell_quoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// An empty directory to run in, removed at the end; stdout and stderr are kept beside it.
class Sandbox {
 public:
  Sandbox() {
    std::string name = (std::filesystem::temp_directory_path() / "carnot-XXXXXX").string();
    root_ = mkdtemp(name.data());
    std::filesystem::create_directory(directory());
  }
  ~Sandbox() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  Sandbox(const Sandbox&) = delete;
  Sandbox& operator=(const Sandbox&) = delete;

  [[nodiscard]] std::filesystem::path directory() const { return root_ / "work"; }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory())) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }

  // `prefix` goes before the program, e.g. `timeout`.
  [[nodiscard]] Outcome run(const std::vector<std::string>& arguments,
                            const std::string& prefix = "",
                            const std::string& program = CARNOT_PROGRAM) const {
    std::string command =
        "cd " + shell_quoted(directory().string()) + " && " + prefix + " " + shell_quoted(program);
    for (const std::string& argument : arguments) command += " " + shell_quoted(argument);
    command += " > ../out 2> ../err < /dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
            read_text(root_ / "out"),
            read_text(root_ / "err")};
  }

 private:
  std::filesystem::path root_;
};

inline Outcome run(const Words& arguments) { return Sandbox().run(arguments); }

inline Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// A prefix for Sandbox::run(): sends the signal after so many seconds.
inline std::string stopped_after(const std::string& seconds, const std::string& signal = "INT") {
  return "timeout --preserve-status -k 20 -s " + signal + " " + seconds;
}

// Bad input: exit status 2, one line on stderr, and nothing else is written.
inline void expect_refused(const Words& arguments,
                           const ::testing::Matcher<std::string>& message,
                           const Sandbox& sandbox = {}) {
  const Words before = sandbox.files();
  const Outcome outcome = sandbox.run(arguments);
  SCOPED_TRACE("carnot " + ::testing::PrintToString(arguments));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("carnot: ") && outcome.err.ends_with('\n')) << outcome.err;
  EXPECT_THAT(outcome.err, message);
  EXPECT_EQ(sandbox.files(), before);
}

// The keys of an object, in order.
inline std::vector<std::string> keys(const nlohmann::ordered_json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items()) names.push_back(key);
  return names;
}

}  // namespace carnot::apps
