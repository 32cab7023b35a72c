// From a discrete extremal, or a guess of knots, to a verified extremal.
#pragma once

#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// The first half of polishing: the path on grids that are fine enough for shooting.
Refinement refine_to_polish(const MassLadder& ladder, const Path& path, const Stop& stop = {});

// The second half: joins the knots on the refined path (multiple_shooting.h). There are as many
// knots, and as many steps, as the tangent flow asks for. Where that fails, refines further, and at
// last shoots along the path.
Outcome polish(const MassLadder& ladder,
               const GeodesicOptions& options,
               const Path& path,
               const Refinement& refined,
               const Stop& stop = {});

// Both halves.
Outcome polish(const MassLadder& ladder, const GeodesicOptions& options, const Path& path);

// The same from knots that may be far from joined.
Outcome polish(const BoundaryValueProblem& problem,
               const GeodesicOptions& options,
               const Knots& knots,
               const Stop& stop = {});

// Single shooting from the velocity at the start of a path, without its multipliers. This is for
// paths that are abnormal as well as normal. A grid that only nearly satisfies the constraints
// along such a path has large multipliers, which lead nowhere, or no discrete extremal at all.
// Cost: a few tangent flows.
Outcome shoot_along(const BoundaryValueProblem& problem,
                    const GeodesicOptions& options,
                    const Path& path);

// The same from the unknowns of a start (ends.h).
Outcome shoot_from(const BoundaryValueProblem& problem,
                   const GeodesicOptions& options,
                   std::vector<double> x);

}  // namespace carnot::internal
