#include "text/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "carnot/plots/replace_file.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

namespace fs = std::filesystem;

fs::path directory_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// Refuses unless the directory of `path` takes a new file.
void check_output_directory(std::string_view option, const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) refuse(option, path, "is a directory", "the name of a file");
  const fs::path directory = directory_of(plots::followed(path));
  if (!fs::is_directory(directory, ignored)) {
    const std::string why = fmt::format("there is no directory '{}'", directory.string());
    refuse(option, path, why, "a file in an existing directory");
  }
  if (access(directory.c_str(), W_OK | X_OK) != 0) {
    const std::string why = fmt::format("no permission to write in '{}'", directory.string());
    refuse(option, path, why, "a file in a writable directory");
  }
}

}  // namespace

bool has_ending(const std::string& path, std::string_view ending) {
  return fs::path(path).extension() == ending;
}

void check_output_file(std::string_view option,
                       const std::string& path,
                       const std::vector<std::string>& endings) {
  if (std::none_of(endings.begin(), endings.end(), [&](const std::string& ending) {
        return has_ending(path, ending);
      })) {
    const auto accepted = fmt::format("a file name that ends in {}", fmt::join(endings, " or "));
    refuse(option, path, "unknown ending", accepted);
  }
  check_output_directory(option, path);
}

NewFile::NewFile(const std::string& path) : path_(path) {
  const fs::path target(plots::followed(path));
  temporary_ =
      directory_of(target) / fmt::format(".{}.{}.part", target.filename().string(), getpid());
}

NewFile::~NewFile() {
  std::error_code ignored;
  if (!finished_) fs::remove(temporary_, ignored);
}

void NewFile::finish() {
  plots::replace_file(temporary_, path_);
  finished_ = true;
}

void write_file(const std::string& path, std::string_view text) {
  NewFile target(path);
  std::ofstream file(target.temporary(), std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(fmt::format("cannot write '{}'", path));
  target.finish();
}

}  // namespace carnot::apps
