// From a discrete extremal, or a guess of knots, to a verified extremal.
#pragma once

#include <optional>

#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// Refines the path (refinement.h) and joins the knots on it (multiple_shooting.h): as many of them,
// and as many steps, as the tangent flow asks for; where that fails, shoots along it. Nothing when
// no extremal is near: `reason` says how far it came.
std::optional<Extremal> polish(const BoundaryValueProblem& problem,
                               const GeodesicOptions& options,
                               const Path& path,
                               Reason* reason = nullptr);

// The same from knots that may be far from joined.
std::optional<Extremal> polish(const BoundaryValueProblem& problem,
                               const GeodesicOptions& options,
                               const Knots& knots,
                               Reason* reason = nullptr);

// By single shooting from the velocity at the start, without multipliers. Where a path is abnormal
// as well as normal, a grid that only nearly satisfies the constraints along it has large ones,
// which lead nowhere, or no discrete extremal at all. Cost: a few tangent flows.
std::optional<Extremal> shoot_along(const BoundaryValueProblem& problem,
                                    const GeodesicOptions& options,
                                    const Path& path);

}  // namespace carnot::internal
