#include "text/interrupt.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <ctime>

namespace carnot::apps {
namespace {

// When the first signal came; 0: never. A handler can reach nothing but a global.
std::atomic<double> first_time{0};
static_assert(std::atomic<double>::is_always_lock_free);

double seconds_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Calls nothing but async-signal-safe functions.
void on_interrupt(int signal) {
  constexpr double kSameInterrupt = 0.5;  // seconds
  const double now = seconds_now();
  double before = 0;
  if (!first_time.compare_exchange_strong(before, now) && now - before > kSameInterrupt) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // takes effect when this handler returns
  }
}

}  // namespace

void watch_for_interrupts() {
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_handler = on_interrupt;
  action.sa_flags = SA_RESTART;
  sigaddset(&action.sa_mask, SIGINT);  // one at a time
  sigaddset(&action.sa_mask, SIGTERM);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void guard_streams() {
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    // The lowest free number is this one. Writing to it fails.
    (void)open("/dev/null", O_RDONLY);
  }
}

bool interrupted() { return first_time != 0; }

}  // namespace carnot::apps
