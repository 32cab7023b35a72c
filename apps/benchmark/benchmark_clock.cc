#include "benchmark/benchmark_clock.h"

#include <algorithm>
#include <ctime>
#include <fstream>

namespace carnot::apps {
namespace {

double seconds_of(const std::function<void()>& call, long times) {
  const double begin = thread_seconds();
  for (long i = 0; i < times; ++i) call();
  return thread_seconds() - begin;
}

// How many calls make a block; the calls before are the warm-up.
long calls_per_block(const std::function<void()>& call, double block) {
  constexpr long kMost = 1L << 30;
  for (long times = 1;; times *= 2) {
    const double seconds = seconds_of(call, times);
    if (seconds >= block || times >= kMost) return times;
  }
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "";
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

PinnedThread::PinnedThread() {
  const int processor = sched_getcpu();
  if (processor < 0 || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  pinned_ = sched_setaffinity(0, sizeof one, &one) == 0;
}

PinnedThread::~PinnedThread() {
  if (pinned_) sched_setaffinity(0, sizeof before_, &before_);
}

std::vector<double> median_seconds(const std::vector<std::function<void()>>& calls,
                                   const TimingOptions& options,
                                   const Progress& progress) {
  const PinnedThread pinned;
  const double parts = static_cast<double>(calls.size()) * (options.rounds + 1);
  double done = 0;
  const auto go_on = [&] { return !progress || progress(done++ / parts); };
  std::vector<long> times;
  for (const auto& call : calls) {
    if (!go_on()) return {};
    times.push_back(calls_per_block(call, options.block));
  }
  std::vector<std::vector<double>> seconds(calls.size());
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t i = 0; i < calls.size(); ++i) {
      if (!go_on()) return {};
      seconds[i].push_back(seconds_of(calls[i], times[i]) / static_cast<double>(times[i]));
    }
  }
  std::vector<double> medians;
  medians.reserve(seconds.size());
  for (const auto& of_call : seconds) medians.push_back(median(of_call));
  return medians;
}

}  // namespace carnot::apps
