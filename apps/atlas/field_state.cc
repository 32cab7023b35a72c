#include "atlas/field_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "carnot/plots/replace_file.h"

namespace carnot::apps {
namespace {

constexpr std::chrono::milliseconds kShortest{500};

}  // namespace

FieldState::FieldState(const std::string& path)
    : path_(path + ".state"), temporary_(path_ + ".part"), pause_(kShortest) {}

std::istream* FieldState::earlier() {
  earlier_.open(path_, std::ios::binary);
  return earlier_.is_open() ? &earlier_ : nullptr;
}

void FieldState::keep(const std::function<void(std::ostream&)>& write) {
  constexpr int kShare = 20;
  const Clock::time_point begin = Clock::now();
  if (begin - last_ < pause_) return;
  std::ofstream file(temporary_, std::ios::binary);
  write(file);
  file.close();
  if (!file) {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    throw std::runtime_error(
        fmt::format("cannot write '{}': make room, and go on with --resume", path_));
  }
  plots::replace_file(temporary_, path_);
  last_ = Clock::now();
  pause_ = std::max<Clock::duration>(kShortest, kShare * (last_ - begin));
}

bool FieldState::exists() const {
  std::error_code ignored;
  return std::filesystem::exists(path_, ignored);
}

void FieldState::remove() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  std::filesystem::remove(temporary_, ignored);
}

}  // namespace carnot::apps
