// The triangle inequality between neighbours of a grid.
//
// Distances are sqrt(2 A T), the length of the path, and do not change when it is turned round. So
// for two points a and b, with a path between them that was found without the field,
//
//   d(from, b) <= d(from, a) + length of a path from a to b,
//
// and the same with a and b exchanged. Where that does not hold the farther one is not the least.
// It is no proof that a field is right: a value that is wrong by less than the path between
// neighbours passes.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_partners.h"
#include "carnot/shooting/find_geodesics.h"

namespace carnot::internal {

struct Triangles {
  long tried = 0;            // pairs between which a path was found
  std::vector<long> beyond;  // points that are too far, in ascending order
};

// A cold search from each of `points` to a neighbour that is drawn with `seed`. `problem`, `grid`
// and `action` are in the units of the scene; an action that is not finite is not known, and its
// pair is left out. Cost: a search for each point, on so many threads of each of the partners.
// Where `search.progress` stops the searches, the rest is left out.
Triangles check_triangles(const BoundaryValueProblem& problem,
                          const FieldGrid& grid,
                          const std::function<double(long)>& action,
                          const std::vector<long>& points,
                          const GeodesicOptions& search,
                          std::uint64_t seed,
                          int threads,
                          FieldPartners& partners);

}  // namespace carnot::internal
