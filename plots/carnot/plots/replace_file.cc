#include "carnot/plots/replace_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace carnot::plots {

namespace fs = std::filesystem;

std::string followed(const std::string& path) {
  constexpr int kMostLinks = 40;  // as Linux counts them
  std::error_code error;
  fs::path target(path);
  for (int i = 0; i < kMostLinks && fs::is_symlink(target, error); ++i) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

void replace_file(const std::string& finished, const std::string& path) {
  std::error_code error;
  const fs::path target(followed(path));
  if (fs::exists(target, error) && !fs::is_regular_file(target, error)) {
    std::ifstream in(finished, std::ios::binary);
    std::ofstream out(target, std::ios::binary);
    out << in.rdbuf();
    out.close();
    if (!in || !out) throw std::runtime_error("cannot write '" + path + "'");
    fs::remove(finished, error);
    return;
  }
  fs::rename(finished, target, error);
  if (error) throw std::runtime_error("cannot write '" + path + "': " + error.message());
}

}  // namespace carnot::plots
