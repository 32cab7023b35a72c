// Conjugate times of a ray, fast and with multiplicity.
//
// X = dq/dp(0) and P = dp/dp(0) span a Lagrangian plane, and t is conjugate where X has a kernel.
// One step of the method is a symplectic matrix with the upper blocks A and B: X+ = A X + B P. As
// long as A is regular,
//
//   F = P'A^-1 X+ = P'X + P'(A^-1 B) P
//
// is a symmetric matrix with the kernel of X+. It begins with P'X, and A^-1 B is zero first and
// grows (H_pp >= 0). So the eigenvalues of F grow, and the step passes as many conjugate times as F
// loses negative ones, also where several of them vanish at once and det X keeps its sign. The j-th
// of these times is a simple zero of one eigenvalue, counted from below. A step at which A is not
// well regular is halved. With M symplectic, A^-1 B changes at the rate A^-1 H_pp A^-T, so the
// eigenvalue with the unit vector v changes at the rate w'H_pp w, w = A^-T P v, and its zero is
// found by inverse interpolation.
//
// Signs are those of D F D, with a diagonal D that makes the terms of F of one size: so dilations
// and units change nothing. Beside an abnormal extremal one eigenvalue is small like the square of
// the distance. On the flat Martinet problem, in coordinates that mix everything, it is told from
// round-off down to a distance of 3e-6; on the extremal itself it counts as zero.
#pragma once

#include <vector>

#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {

// A conjugate time, and the place there. The time is infinite where there is none up to the
// horizon, and NaN where the flow fails; then there is no place.
struct ConjugatePoint {
  double t = 0;
  std::vector<double> q;
};

// The one of this order, counted with multiplicity; order 1 is the first. Cost: on the unicycle
// some 13 steps with their tangents, of which 3 find the zero in the last one; and flows without
// tangents, which tell the number of steps.
ConjugatePoint conjugate_point(const Ray& ray, double horizon, int order = 1);
double conjugate_time(const Ray& ray, double horizon, int order = 1);

}  // namespace carnot::internal
