// What is said of an extremal that is going to be returned: samples, conjugate times, label.
#pragma once

#include <vector>

#include "carnot/shooting/extremal/verification.h"

namespace carnot::internal {

// The largest |value(q)| along a smooth path, for each extreme of the scene, at and between equally
// spaced nodes: of the polynomial through the nodes around the largest.
void set_extremes(const BoundaryValueProblem& problem,
                  const std::vector<std::vector<double>>& nodes,
                  Geodesic& geodesic);

// Fills trajectory (`samples` times), extremes, conjugate times, Morse index, label, abnormal and
// family dimension, as far as they can be known. A strictly abnormal curve has them already.
void complete(const BoundaryValueProblem& problem, long samples, Extremal& extremal);

// The same without samples. Conjugate times are counted and not located, which is faster where
// there are many.
void label(const BoundaryValueProblem& problem, Extremal& extremal);

// The conjugate times of the extremal, computed once.
const ConjugateTimes& conjugate_times_of(const BoundaryValueProblem& problem, Extremal& extremal);

}  // namespace carnot::internal
