// When a search has to end.
#pragma once

#include <chrono>
#include <cmath>
#include <optional>

namespace carnot::internal {

class Deadline {
 public:
  // In so many seconds; never where they are infinite.
  explicit Deadline(double seconds) {
    constexpr double kMost = 1e9;  // a lifetime, and no overflow
    if (!(seconds < kMost)) return;
    const std::chrono::duration<double> left(seconds);
    end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(left);
  }
  [[nodiscard]] bool passed() const { return end_ && Clock::now() >= *end_; }
  // Seconds that are left, at least zero.
  [[nodiscard]] double left() const {
    if (!end_) return HUGE_VAL;
    const std::chrono::duration<double> left = *end_ - Clock::now();
    return left.count() > 0 ? left.count() : 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> end_;
};

}  // namespace carnot::internal
