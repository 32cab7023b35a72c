// Why there is no geodesic, as a code. Advice and figures are in the message beside it.
#pragma once

namespace carnot {

// How far the best attempt came, in this order.
enum class Reason {
  kNone,                 // there is one
  kInterrupted,          // the caller stopped the search
  kIrregularEnd,         // refused: an end is no regular configuration
  kLimitAtEnd,           // refused: an end is beyond a limit
  kLimitsInfeasible,     // no path was found that keeps to the limits
  kNoStartConverged,     // no start led to a discrete extremal or, from momenta, to knots that join
  kSingularCoordinates,  // the same, and most met a singularity of the coordinates
  kGuessFailed,          // the guess did not lead to knots that join
  kNotRefined,           // discrete extremals have no counterpart on finer grids
  kFlowFailed,           // the flow along discrete extremals cannot be integrated
  kNotJoined,            // shooting from discrete extremals did not converge
  kNotVerified,          // an independent integration misses the target, by more than round-off
  kBeyondDouble,         // round-off is larger than the tolerance, or than the target is far
  kMethodTooCoarse,      // it misses by the error of the method, with the most steps, too
  kTooLong,              // all that were found are longer than max_length
  kOnlyAbnormal,         // nothing but a strictly abnormal curve, which has no momentum
};

// "no-start-converged" and so on; "none".
const char* name_of(Reason reason);

}  // namespace carnot
