// Holds Ctrl-C and SIGTERM back for a while.
#pragma once

#include <csignal>

namespace carnot::plots {

// As long as it lives, in this thread; what came meanwhile is delivered at the end.
class InterruptsBlocked {
 public:
  InterruptsBlocked();
  ~InterruptsBlocked();
  InterruptsBlocked(const InterruptsBlocked&) = delete;
  InterruptsBlocked& operator=(const InterruptsBlocked&) = delete;

 private:
  sigset_t before_;
};

}  // namespace carnot::plots
