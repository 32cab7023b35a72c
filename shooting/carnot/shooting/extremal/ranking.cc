#include "carnot/shooting/extremal/ranking.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace carnot::internal {

void rank(std::vector<Extremal>& list) {
  std::stable_sort(list.begin(), list.end(), [](const Extremal& a, const Extremal& b) {
    return a.geodesic.action < b.geodesic.action;
  });
  for (auto first = list.begin(); first != list.end();) {
    const double action = first->geodesic.action;
    const auto last = std::find_if(first, list.end(), [&](const Extremal& extremal) {
      return extremal.geodesic.action - action > kSameAction * std::abs(action);
    });
    std::sort(first, last, [](const Extremal& a, const Extremal& b) {
      const auto key = [](const Geodesic& g) {
        return std::tie(g.verification, g.p0);  // kSingle is first
      };
      return key(a.geodesic) < key(b.geodesic);
    });
    first = last;
  }
}

double missed_estimate(const std::vector<int>& hits) {
  const auto once = static_cast<double>(std::count(hits.begin(), hits.end(), 1));
  const auto twice = static_cast<double>(std::count(hits.begin(), hits.end(), 2));
  return twice > 0 ? once * once / (2 * twice) : once * std::max(0.0, once - 1) / 2;
}

}  // namespace carnot::internal
