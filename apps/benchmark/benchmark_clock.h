// CPU times that can be compared within one run, on a machine that others use too.
//
// Each contestant runs in blocks, long against the clock; a round is a block of each of them, and
// what counts is the median over the rounds. So a disturbance, or a clock rate that changes, meets
// all of them alike.
#pragma once

#include <sched.h>

#include <functional>
#include <string>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::apps {

// As the machine calls itself; empty where it does not tell.
[[nodiscard]] std::string processor_name();

// CPU time of the calling thread.
[[nodiscard]] double thread_seconds();

// Keeps the calling thread on the processor that it is on, as long as this object lives.
class PinnedThread {
 public:
  PinnedThread();
  ~PinnedThread();
  PinnedThread(const PinnedThread&) = delete;
  PinnedThread& operator=(const PinnedThread&) = delete;

 private:
  cpu_set_t before_{};
  bool pinned_ = false;
};

struct TimingOptions {
  double block = 2e-3;  // seconds, at least
  int rounds = 11;
};

// Median seconds of one call of each. Empty when stopped.
std::vector<double> median_seconds(const std::vector<std::function<void()>>& calls,
                                   const TimingOptions& options,
                                   const Progress& progress);

}  // namespace carnot::apps
