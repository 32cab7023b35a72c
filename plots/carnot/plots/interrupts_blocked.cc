#include "carnot/plots/interrupts_blocked.h"

namespace carnot::plots {

InterruptsBlocked::InterruptsBlocked() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, &before_);
}

InterruptsBlocked::~InterruptsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

}  // namespace carnot::plots
