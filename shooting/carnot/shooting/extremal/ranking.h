// The list of extremals in its order, and how sure it is.
#pragma once

#include <vector>

#include "carnot/shooting/extremal/verification.h"

namespace carnot::internal {

// Least action first; equal ones in the order of p0, not of round-off, and those that need knots
// last.
void rank(std::vector<Extremal>& list);
void rank(std::vector<Geodesic>& list);

// How many distinct extremals, up to symmetry, the starts have missed, by how often those found
// were hit: f1^2 / (2 f2) with f_k the number of those hit k times, f1 (f1 - 1) / 2 where f2 = 0. A
// lower bound in the mean, whatever the chances of each are. Source: Chao, Nonparametric estimation
// of the number of classes in a population, Scand. J. Statist. 11 (1984).
double missed_estimate(const std::vector<int>& hits);

// The same where `least` has the least action of them. At least one where `least` is no minimum,
// for then there is less; and where it was hit once only, of which the estimate makes nothing. When
// bicycles were searched for in poor scales, 14 of 800 searches did not find the least known
// action. The estimate warned of seven of them, and with this of 13.
double missed_estimate(const std::vector<int>& hits, const Geodesic& least);

}  // namespace carnot::internal
