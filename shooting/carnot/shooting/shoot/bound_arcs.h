// Extremals that keep to bounds for a while: pieces of flows, joined.
//
// On a bound s(q) = 0 the velocity keeps ds.q' = 0, one more row of the velocity constraints, so an
// arc is a flow of a system of index 1 itself (Limit::held). With a multiplier nu >= 0 of the bound
// L - nu s is stationary instead of L. With eta' = nu it differs from L + eta ds.q' by the
// derivative of eta s only, and eta is the multiplier of that row. So on an arc with the momentum p
//
//   p(t) - eta(t) ds
//
// is the momentum of L - nu s. It is continuous: eta begins with zero, and at the end of the arc p
// jumps by -eta ds to what flows on without the bound. There the velocity, which is continuous as
// well, still satisfies ds.q' = 0. So every arc brings three unknowns, its two times and eta at its
// end, and as many equations:
//
//   s = 0 and ds.H_p = 0 where it begins,   ds.H_p = 0 for the momentum after the jump.
//
// A limit whose rate no velocity changes where the path meets it, such as an obstacle that is
// passed tangentially, is touched at a point. There p jumps by -eta ds, and s = 0 and ds.H_p = 0
// hold.
//
// An arc may last to the end, where coordinates are free. There is no jump then, and the momenta of
// free coordinates are not zero but those of the force with which the wall stops the end, a
// multiple kappa >= 0 of ds. With the momentum on the arc p = (eta + kappa) ds in these
// coordinates, so the unknown at the end is eta + kappa.
//
// They are solved together with those of multiple shooting (shooting_equations.h) by Newton's
// method with exact derivatives. Arcs are for limits of first order: ds.H_p must depend on p there.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/problem/walls.h"

namespace carnot::internal {

// A piece of an extremal, free or on a wall. It begins where the one before ends.
struct Piece {
  int wall = -1;          // the wall that it keeps to; -1: free
  int touches = -1;       // the wall that a free piece touches at its end; -1: none
  double end = 0;         // when it ends
  int segments = 1;       // flows that it is made of, equally long
  double release = 0;     // eta at its end; eta + kappa where that is the end of the path
  std::vector<double> z;  // where the segments start, segments x 2n

  // The wall that p jumps along at its end; -1: none.
  [[nodiscard]] int leaves() const { return wall >= 0 ? wall : touches; }
};

struct BoundExtremal {
  std::vector<Piece> pieces;
  double residual = 0;  // Euclidean norm of all equations, relative
};

// Joins the pieces in place; `steps` of the method over the whole time. False where Newton's method
// does not converge, or the scene cannot be held on a wall.
bool join_pieces(const BoundaryValueProblem& problem,
                 const Walls& walls,
                 long steps,
                 BoundExtremal& extremal);

// How many steps each segment of a piece takes, when the whole time takes so many.
long steps_of(const BoundaryValueProblem& problem, const Piece& piece, double start, long steps);

}  // namespace carnot::internal
