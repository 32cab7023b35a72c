// Files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "carnot/plots/interrupts_blocked.h"

namespace carnot::apps {

// Throws std::invalid_argument unless a file with one of these endings could be made at `path`.
void check_output_file(std::string_view option,
                       const std::string& path,
                       const std::vector<std::string>& endings);

[[nodiscard]] bool has_ending(const std::string& path, std::string_view ending);

// A file that is written under a temporary name in the same directory and then takes the place of
// `path`. Unless it is finished nothing stays behind. While it lives signals wait.
class NewFile {
 public:
  explicit NewFile(const std::string& path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  [[nodiscard]] const std::string& temporary() const { return temporary_; }
  // Throws std::runtime_error where it cannot be done.
  void finish();

 private:
  plots::InterruptsBlocked blocked_;
  std::string path_;
  std::string temporary_;
  bool finished_ = false;
};

// A NewFile with this text. Throws std::runtime_error.
void write_file(const std::string& path, std::string_view text);

}  // namespace carnot::apps
