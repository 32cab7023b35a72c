// Many trajectories of one system, side by side in packs, packs on several threads.
//
// What goes into a pack depends on the order of the trajectories alone, so the answer has the same
// bits whatever the number of threads.
#pragma once

#include <atomic>

#include "carnot/flow/dop853_adaptive.h"
#include "carnot/flow/reports.h"
#include "carnot/numerics/parallel.h"

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

// Advances `count` phase points, rows of 2n numbers in `z`, with DOP853 and common steps for each
// pack; not symplectic. A pack that fails is tried again one by one. Cost: a fifth to a seventh of
// a trajectory alone, each. threads = 0: all cores.
BatchReport adaptive_batch(const AdaptiveFlow& flow, int count, double* z, int threads);

}  // namespace carnot
