#include "carnot/flow/batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace carnot {
namespace {

// A pack in memory.
struct alignas(64) Row : std::array<double, kErasedLanes> {};

// The first points of `z`, one for each of `lanes`; lanes that are idle repeat the last. False,
// with z as it was, where several fail together.
bool advance(const AdaptiveFlow& flow, int lanes, double* z, BatchReport& report) {
  const int size = 2 * flow.functions.dof;
  std::vector<Row> memory(size + adaptive_rows(flow.functions));
  double* const rows = memory.front().data();
  for (int l = 0; l < kErasedLanes; ++l) {
    const double* const from = z + std::min(l, lanes - 1) * size;
    for (int k = 0; k < size; ++k) rows[k * kErasedLanes + l] = from[k];
  }
  const AdaptiveReport run = dop853_adaptive(flow, rows, rows + size * kErasedLanes);
  report.evaluations += run.evaluations * lanes;
  if (!run.completed && lanes > 1) return false;
  for (int l = 0; l < lanes; ++l) {
    for (int k = 0; k < size; ++k) {
      z[l * size + k] = run.completed ? rows[k * kErasedLanes + l] : std::nan("");
    }
  }
  (run.completed ? report.completed : report.failed) += lanes;
  return true;
}

}  // namespace

BatchReport adaptive_batch(const AdaptiveFlow& flow, int count, double* z, int threads) {
  const auto go = [&](int first, int lanes, BatchReport& report) {
    return advance(flow, lanes, z + first * 2 * flow.functions.dof, report);
  };
  return batch_of(
      (count + kErasedLanes - 1) / kErasedLanes, threads, [&](int pack, BatchReport& report) {
        const int first = pack * kErasedLanes;
        const int lanes = std::min(kErasedLanes, count - first);
        if (go(first, lanes, report)) return;
        for (int l = 0; l < lanes; ++l) (void)go(first + l, 1, report);
      });
}

}  // namespace carnot
