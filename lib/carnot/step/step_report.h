// What one step did.
#pragma once

#include "carnot/system/rate_status.h"

namespace carnot {

enum class StepStatus { kOk, kRateFailed, kStagesDiverged };

struct StepReport {
  StepStatus status = StepStatus::kOk;
  RateStatus rate = RateStatus::kOk;
  int evaluations = 0;
  bool newton = false;
};

}  // namespace carnot
