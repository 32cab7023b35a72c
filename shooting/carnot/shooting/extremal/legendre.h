// Legendre's condition: whether small wiggles of a path cost something.
//
// A minimum has L_vv >= 0 on the velocities that the constraints admit and, in optimal control,
// -H_uu >= 0; where it is less in some direction, quick wiggles in this direction lower the action,
// however short the path is (Agrachev & Sachkov, Control Theory from the Geometric Viewpoint, 2004,
// ch. 20). Systems of index 1 have no zero there but may have any sign: Lagrangians and costs can
// be written that are not convex. With y solved for, the derivative of v = H_p by p is
//
//   H_pp = B (B' L_vv B)^-1 B',   or   f_u (-H_uu)^-1 f_u',
//
// with B a basis of the kernel of g_v. So H_pp has the signs of what is asked about, but for
// controls that move nothing. Conjugate times are counted on the assumption that H_pp >= 0, too.
#pragma once

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// Whether H_pp >= 0 at equidistant times along the extremal through the knots; `steps` of the
// method in all. True without a look where M > 0 on the kernel of G makes it so.
bool satisfies_legendre(const BoundaryValueProblem& problem, const Knots& knots, long steps);

}  // namespace carnot::internal
