// The order of a method, found from its coefficients.
#pragma once

#include <algorithm>
#include <limits>

#include "carnot/tableau/order_conditions.h"
#include "carnot/tableau/rooted_trees.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// Up to here all trees are looked at. There are 1,205 of up to 10 vertices, and 12,157 in two
// colours of up to 8.
inline constexpr int kMostTreeOrder = 10;
inline constexpr int kMostColouredOrder = 8;

// Higher orders follow from B(p), C(q) and D(r) of order_conditions.h: at least
// min(p, q + r + 1, 2 q + 2) (Butcher 1964; Hairer, Norsett & Wanner, Solving ODEs I, II.7,
// Theorem 7.4). That is the order itself of all collocation methods, since no order exceeds p.
template <class T>
int order_by_simplifying_assumptions(const Tableau<T>& tableau, long double tolerance) {
  const int most = 2 * tableau.stages();
  const auto largest = [&](const auto& defect) {
    int k = 0;
    while (k < most && defect(k + 1) <= static_cast<long double>(k + 1) * tolerance) ++k;
    return k;
  };
  const int p = largest([&](int k) { return quadrature_defect(tableau, k); });
  const int q = largest([&](int k) { return stage_defect(tableau, k); });
  const int r = largest([&](int k) { return transposed_defect(tableau, k); });
  return std::min({p, q + r + 1, 2 * q + 2});
}

// The order up to which the conditions hold to `roundings` units of round-off of T. Of a
// partitioned method at most kMostColouredOrder. Costs some milliseconds.
template <class T>
int order_of(const Tableau<T>& tableau, int roundings) {
  const int most = tableau.partitioned ? kMostColouredOrder : kMostTreeOrder;
  const int order = RootedTrees<T>(tableau, most).order(roundings);
  if (order < most || tableau.partitioned) return order;
  const long double tolerance =
      static_cast<long double>(roundings) * std::numeric_limits<T>::epsilon();
  return std::max(order, order_by_simplifying_assumptions(tableau, tolerance));
}

}  // namespace carnot
