// The same work for many indices on a few threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace carnot {

inline int thread_count(int requested) {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return requested > 0 ? requested : cores;
}

// Calls work(i) once for each i in [0, count). `work` must not throw.
template <class Work>
void parallel_for(int count, int threads, const Work& work) {
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> helpers;
  for (int t = 1; t < std::min(threads, count); ++t) helpers.emplace_back(run);
  run();
  for (std::thread& helper : helpers) helper.join();
}

}  // namespace carnot
