// Abnormal curves from the start of a problem to its target.
//
// They are followed from the start, both ways, at speed 1 along the field of singular_field.h, and
// those that come by the target are made to arrive: their covectors are few, so nothing but the
// length, and in more than four dimensions perhaps the covector, is left to be found. Whether a
// momentum drives the same curve, so that it is a normal extremal as well, is a linear question
// about that momentum. Where none does the curve is strictly abnormal.
#pragma once

#include <optional>
#include <vector>

#include "carnot/shooting/extremal/verification.h"

namespace carnot::internal {

struct AbnormalCurve {
  std::vector<double> covector;  // at the start; it annihilates the admissible directions
  double sign = 1;               // of the velocity of singular_field.h
  double length = 0;
  long steps = 0;             // of the method, over the whole length
  double endpoint_error = 0;  // max-norm of what twice as many steps miss the target by
};

// Whether an abnormal curve may start where the problem does: rank two, no free end, no potential.
// Cost: some evaluations of the scene.
bool may_have_abnormal_curves(const BoundaryValueProblem& problem);

// The shortest one that arrives and is not longer than `longest`; it is looked for as far as some
// times the distance of the ends. Nothing where there is none.
std::optional<AbnormalCurve> abnormal_curve(const BoundaryValueProblem& problem,
                                            double longest,
                                            double tolerance);

// The momentum p(0) of a normal extremal along the curve; nothing where there is none, to about six
// digits.
std::optional<std::vector<double>> normal_momentum(const BoundaryValueProblem& problem,
                                                   const AbnormalCurve& curve);

// What is told of it: a path without a momentum, `samples` times of it in the trajectory.
Extremal extremal_of(const BoundaryValueProblem& problem, const AbnormalCurve& curve, long samples);

}  // namespace carnot::internal
