// A progress bar with rate and time left, on stderr, drawn only on a terminal and erased at the
// end.
//
// It is also where work learns of Ctrl-C: the callback returns false once interrupted.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "carnot/dynamics.h"

namespace carnot::apps {

class ProgressBar {
 public:
  // `total` units of work make fraction 1; the rate is told in "unit/s".
  ProgressBar(std::string unit, double total, bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Valid as long as this object lives; may be called from any thread.
  [[nodiscard]] Progress callback();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(double fraction);

  std::string unit_;
  double total_;
  bool shown_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
  std::mutex mutex_;
};

// The progress of a part of some work: the share `share` of it, from `begin` on. Empty where the
// whole has none.
Progress part_of(const Progress& whole, double begin, double share);

// "[####......]  40 %  12.3 k steps/s  0:07 left".
std::string progress_line(double fraction, double seconds, double total, const std::string& unit);

}  // namespace carnot::apps
