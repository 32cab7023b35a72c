// Which points of a field are searched, and what a sample says of all.
#pragma once

#include <vector>

#include "carnot/shooting/field/field_grid.h"

namespace carnot::internal {

// About `count` points that are spread evenly over the grid, by additive recurrences with powers of
// the root of x^(d + 1) = x + 1, for d axes. Ascending.
std::vector<long> evenly_spread_points(const FieldGrid& grid, long count);

// With at most `found` of `tried` trials a success, the share of successes is less than this with
// 95 per cent confidence (Clopper and Pearson, Biometrika 26, 1934).
double upper_share(long found, long tried);

}  // namespace carnot::internal
