#include "carnot/dynamics.h"

#include <algorithm>
#include <cmath>

#include "carnot/flow/batch.h"

namespace carnot {

BatchReport Dynamics::flow_batch(const StepPlan& plan, int count, double* z, int threads) const {
  return batch_of(count, threads, [&](int i, BatchReport& report) {
    double* const point = z + i * 2 * dof;
    const FlowReport run = flow(plan, point);
    report.evaluations += run.evaluations;
    ++(run.completed() ? report.completed : report.failed);
    if (!run.completed()) std::fill_n(point, 2 * dof, std::nan(""));
  });
}

}  // namespace carnot
