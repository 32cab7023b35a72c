// Symmetries of a boundary-value problem: maps of the scene that keep or swap its ends.
//
// A scene declares mirrors D (H(Dq, Dp) = H(q, p)) and whether rigid motions of the plane are
// symmetries; reversing time always is. Of their products those are kept that map the ends to
// themselves, or, with time reversed, to each other. Each maps an extremal to a partner of equal
// action, which may be the same one.
#pragma once

#include <vector>

#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// q -> R D q + b with R the rotation of the plane by `turn`; p -> R D p, and with `reverses` the
// path is run backwards and p changes its sign.
struct ProblemSymmetry {
  std::vector<double> mirror;
  double turn = 0;
  std::vector<double> shift;
  bool reverses = false;
};

// Turns the coordinates x, y of the plane, where the scene has them; angles are not touched.
void turn_plane(const Symmetries& of, double angle, double* x);

std::vector<ProblemSymmetry> symmetries_of(const BoundaryValueProblem& problem);

// The same, of maps that keep the start and take `to` to another place, such as an image of it on
// the cover. Without free ends. Ends are known to `tolerance`, relative to one plus the
// coordinates.
std::vector<ProblemSymmetry> symmetries_onto(const BoundaryValueProblem& problem,
                                             const std::vector<double>& place,
                                             double tolerance);

// The partner of the extremal through `knots`.
Knots partner(const SceneInfo& info, const ProblemSymmetry& symmetry, const Knots& knots);

// The nodes of the partner of a path; without momenta and multipliers.
Path partner(const SceneInfo& info, const ProblemSymmetry& symmetry, const Path& path);

}  // namespace carnot::internal
