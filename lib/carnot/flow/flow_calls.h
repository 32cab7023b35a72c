// The runs of a kernel behind function pointers, on plain numbers.
//
// `system` is what the functions of the scene take (system_functions.h), `method` is the kernel's
// own. z = (q, p) has 2n entries.
#pragma once

#include <memory>

#include "carnot/flow/reports.h"

namespace carnot {

struct FlowCalls {
  FlowReport (*flow)(const void* system, const void* method, const StepPlan&, double* z) = nullptr;
  // m: the derivative of the end by the start, row-major 2n x 2n. Or with `nodes`: there each z
  // after a step, and in m the derivative of each step, one after the other.
  FlowReport (*tangent_flow)(const void* system,
                             const void* method,
                             const StepPlan&,
                             double* z,
                             double* m,
                             double* nodes) = nullptr;
  FlowSummary (*monitored_flow)(const void* system,
                                const void* method,
                                const StepPlan&,
                                double* z,
                                const MonitorOptions&) = nullptr;
  // Null where the method is no Gauss method of kLeastSampled stages.
  AutomaticFlow (*automatic_flow)(const void* system,
                                  const void* method,
                                  double start,
                                  double duration,
                                  double tolerance,
                                  double* z) = nullptr;
};

// Calls, and the `method` that they take.
struct Kernel {
  std::shared_ptr<const void> method;
  FlowCalls calls;
  // Its stages, and the rates of its system, run side by side and fill a pack.
  bool fills_packs = false;
};

}  // namespace carnot
