#include "carnot/shooting/reason.h"

namespace carnot {

const char* name_of(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "none";
    case Reason::kInterrupted:
      return "interrupted";
    case Reason::kIrregularEnd:
      return "irregular-end";
    case Reason::kLimitAtEnd:
      return "limit-at-end";
    case Reason::kLimitsInfeasible:
      return "limits-infeasible";
    case Reason::kNoStartConverged:
      return "no-start-converged";
    case Reason::kSingularCoordinates:
      return "singular-coordinates";
    case Reason::kGuessFailed:
      return "guess-failed";
    case Reason::kNotRefined:
      return "not-refined";
    case Reason::kFlowFailed:
      return "flow-failed";
    case Reason::kNotJoined:
      return "not-joined";
    case Reason::kNotVerified:
      return "not-verified";
    case Reason::kBeyondDouble:
      return "beyond-double";
    case Reason::kMethodTooCoarse:
      return "method-too-coarse";
    case Reason::kTooLong:
      return "too-long";
    case Reason::kOnlyAbnormal:
      return "only-abnormal";
  }
  return "none";
}

}  // namespace carnot
