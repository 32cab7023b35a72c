#include "atlas/field_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "carnot/plots/replace_file.h"

namespace carnot::apps {
namespace {

constexpr std::chrono::milliseconds kShortest{500};

}  // namespace

FieldState::FieldState(const std::string& path)
    : path_(path + ".state"), temporary_(path_ + ".part"), pause_(kShortest) {}

Field FieldState::solve(const BoundaryValueProblem& problem,
                        const std::vector<FieldAxis>& axes,
                        FieldOptions options) {
  options.keep = [this](const auto& write) { keep(write); };
  std::ifstream earlier(path_, std::ios::binary);
  if (earlier.is_open()) options.state = &earlier;
  try {
    return solve_field(problem, axes, options);
  } catch (const DamagedState&) {
    ++repaired_;
    options.state = nullptr;
    return solve_field(problem, axes, options);
  }
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
