// Many trajectories of one system, side by side in packs, packs on several threads.
//
// What goes into a pack depends on the order of the trajectories alone, so the answer has the same
// bits whatever the number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>

#include "carnot/flow/dop853_adaptive.h"
#include "carnot/flow/reports.h"
#include "carnot/numerics/parallel.h"
#include "carnot/system/phase_space.h"
#include "carnot/system/system_functions.h"

namespace carnot {

// Calls work(i, report) for i in [0, count), on threads, and adds up the reports.
template <class Work>
BatchReport batch_of(int count, int threads, const Work& work) {
  std::atomic<long> completed{0};
  std::atomic<long> failed{0};
  std::atomic<long> evaluations{0};
  parallel_for(count, thread_count(threads), [&](int i) {
    BatchReport one;
    work(i, one);
    completed += one.completed;
    failed += one.failed;
    evaluations += one.evaluations;
  });
  return {completed, failed, evaluations};
}

// Advances `count` phase points, rows of 2n numbers in `z`, by `duration` with DOP853 and common
// steps for each pack; error of about `tolerance` each, not symplectic. A pack that fails is tried
// again one by one. Cost: a fifth to a seventh of a trajectory alone, each. threads = 0: all cores.
template <class System>
BatchReport adaptive_batch(const System& system,
                           double start,
                           double duration,
                           double tolerance,
                           int count,
                           double* z,
                           int threads) {
  constexpr int kLanes = IsErased<System> ? kErasedLanes : kPackInFlight;
  constexpr int kFewer = IsErased<System> ? kErasedLanes : kPackInFlight / 2;
  constexpr int size = 2 * System::kDof;
  using Rows = std::array<double, size * kLanes>;
  const auto advance = [&](int first, int lanes, BatchReport& report) {
    alignas(64) Rows rows;
    const int width = lanes > kFewer ? kLanes : kFewer;
    for (int l = 0; l < width; ++l) {
      const double* const from = z + (first + std::min(l, lanes - 1)) * size;
      for (int k = 0; k < size; ++k) rows[k * width + l] = from[k];
    }
    const AdaptiveReport run =
        width == kLanes ? dop853_adaptive<kLanes>(system, start, duration, tolerance, rows.data())
                        : dop853_adaptive<kFewer>(system, start, duration, tolerance, rows.data());
    report.evaluations += run.evaluations * lanes;
    if (!run.completed && lanes > 1) return false;
    for (int l = 0; l < lanes; ++l) {
      for (int k = 0; k < size; ++k) {
        z[(first + l) * size + k] = run.completed ? rows[k * width + l] : std::nan("");
      }
    }
    (run.completed ? report.completed : report.failed) += lanes;
    return true;
  };
  return batch_of((count + kLanes - 1) / kLanes, threads, [&](int pack, BatchReport& report) {
    const int first = pack * kLanes;
    const int lanes = std::min(kLanes, count - first);
    if (advance(first, lanes, report)) return;
    for (int l = 0; l < lanes; ++l) (void)advance(first + l, 1, report);
  });
}

}  // namespace carnot
