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
// well regular is halved.
#pragma once

#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {

// The one of this order, counted with multiplicity; order 1 is the first. Infinite where there are
// fewer up to `horizon`, NaN where the flow fails.
double conjugate_time(const Ray& ray, double horizon, int order = 1);

}  // namespace carnot::internal
