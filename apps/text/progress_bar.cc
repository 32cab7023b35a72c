#include "text/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "text/interrupt.h"

namespace carnot::apps {
namespace {

std::string with_prefix(double rate) {
  if (rate >= 1e6) return fmt::format("{:.3g} M ", rate / 1e6);
  if (rate >= 1e3) return fmt::format("{:.3g} k ", rate / 1e3);
  return fmt::format("{:.3g} ", rate);
}

}  // namespace

Progress part_of(const Progress& whole, double begin, double share) {
  if (!whole) return {};
  return [whole, begin, share](double done) { return whole(begin + share * done); };
}

std::string progress_line(double fraction, double seconds, double total, const std::string& unit) {
  constexpr int kWidth = 30;
  fraction = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(fraction * kWidth);
  std::string line = fmt::format("[{}{}] {:3.0f} %",
                                 std::string(filled, '#'),
                                 std::string(kWidth - filled, '.'),
                                 100 * fraction);
  if (fraction > 0 && seconds > 0) {
    const long left = std::lround(seconds * (1 - fraction) / fraction);
    line += fmt::format("  {}{}/s  {}:{:02} left",
                        with_prefix(fraction * total / seconds),
                        unit,
                        left / 60,
                        left % 60);
  }
  return line;
}

ProgressBar::ProgressBar(std::string unit, double total, bool quiet)
    : unit_(std::move(unit)), total_(total), shown_(!quiet && isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

Progress ProgressBar::callback() {
  return [this](double fraction) {
    if (shown_) draw(fraction);
    return !interrupted();
  };
}

void ProgressBar::draw(double fraction) {
  constexpr auto kInterval = std::chrono::milliseconds(100);
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (now - last_ < kInterval) return;
  last_ = now;
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  fmt::print(stderr, "\r\033[K{}", progress_line(fraction, seconds, total_, unit_));
  std::fflush(stderr);
}

}  // namespace carnot::apps
