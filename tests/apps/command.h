// Runs the built program as a user does: arguments in; exit status, stdout and stderr out.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace carnot::apps {

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
                            const std::string& prefix = "") const {
    std::string command = "cd " + shell_quoted(directory().string()) + " && " + prefix + " " +
                          shell_quoted(CARNOT_PROGRAM);
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

inline Outcome run(const std::vector<std::string>& arguments) { return Sandbox().run(arguments); }

// The keys of an object, in order.
inline std::vector<std::string> keys(const nlohmann::ordered_json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items()) names.push_back(key);
  return names;
}

}  // namespace carnot::apps
