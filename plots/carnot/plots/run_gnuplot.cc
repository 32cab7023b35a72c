#include "carnot/plots/run_gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

namespace carnot::plots {
namespace {

void check(int error) {
  if (error != 0) {
    throw std::runtime_error("it cannot be started: " + std::generic_category().message(error));
  }
}

// What the process has open and where it works.
class FileActions {
 public:
  FileActions() { check(posix_spawn_file_actions_init(&actions_)); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  void work_in(const std::string& directory) {
    check(posix_spawn_file_actions_addchdir_np(&actions_, directory.c_str()));
  }
  void open(int stream, const std::string& file, int flags) {
    constexpr mode_t kMode = 0600;
    check(posix_spawn_file_actions_addopen(&actions_, stream, file.c_str(), flags, kMode));
  }
  void copy(int from, int to) { check(posix_spawn_file_actions_adddup2(&actions_, from, to)); }
  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

// A process group of its own. Ctrl-C reaches every process of the terminal's group, and gnuplot
// answers by a jump out of whatever it does: from within Cairo the jump leaves a lock behind that
// gnuplot then waits for without end. Of 445 runs that were interrupted at random times nine hung.
class OwnGroup {
 public:
  OwnGroup() {
    check(posix_spawnattr_init(&attributes_));
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP);  // of its own where none is set
  }
  ~OwnGroup() { posix_spawnattr_destroy(&attributes_); }
  OwnGroup(const OwnGroup&) = delete;
  OwnGroup& operator=(const OwnGroup&) = delete;

  [[nodiscard]] const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

// Numbers with a point and text in UTF-8, whatever the user's language is.
std::vector<std::string> environment() {
  constexpr std::string_view kLocale = "LC_ALL=";
  std::vector<std::string> variables{std::string(kLocale) + "C.UTF-8"};
  for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    if (text.substr(0, kLocale.size()) != kLocale) variables.emplace_back(text);
  }
  return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

bool run_gnuplot(const std::string& directory, const std::string& script, const std::string& log) {
  FileActions files;
  files.work_in(directory);
  files.open(STDIN_FILENO, "/dev/null", O_RDONLY);
  files.open(STDOUT_FILENO, log, O_WRONLY | O_CREAT | O_TRUNC);
  files.copy(STDOUT_FILENO, STDERR_FILENO);
  const OwnGroup group;
  std::vector<std::string> words{"gnuplot", "-d", script};
  std::vector<std::string> variables = environment();
  pid_t process = 0;
  check(posix_spawnp(&process,
                     "gnuplot",
                     files.get(),
                     group.get(),
                     pointers_to(words).data(),
                     pointers_to(variables).data()));
  int status = 0;
  while (waitpid(process, &status, 0) != process) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace carnot::plots
