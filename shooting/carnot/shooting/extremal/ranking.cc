#include "carnot/shooting/extremal/ranking.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

namespace carnot::internal {

namespace {

const Geodesic& geodesic_of(const Extremal& extremal) { return extremal.geodesic; }
const Geodesic& geodesic_of(const Geodesic& geodesic) { return geodesic; }

template <class Item>
void rank_items(std::vector<Item>& list) {
  std::stable_sort(list.begin(), list.end(), [](const Item& a, const Item& b) {
    return geodesic_of(a).action < geodesic_of(b).action;
  });
  for (auto first = list.begin(); first != list.end();) {
    const double action = geodesic_of(*first).action;
    const auto last = std::find_if(first, list.end(), [&](const Item& item) {
      return geodesic_of(item).action - action > kSameAction * std::abs(action);
    });
    std::sort(first, last, [](const Item& a, const Item& b) {
      const auto key = [](const Geodesic& g) {
        // Normal ones before strictly abnormal ones, which have no p0; kSingle is first.
        return std::make_tuple(g.label == Label::kAbnormal, g.verification, std::cref(g.p0));
      };
      return key(geodesic_of(a)) < key(geodesic_of(b));
    });
    first = last;
  }
}

}  // namespace

void rank(std::vector<Extremal>& list) { rank_items(list); }
void rank(std::vector<Geodesic>& list) { rank_items(list); }

double missed_estimate(const std::vector<int>& hits) {
  const auto once = static_cast<double>(std::count(hits.begin(), hits.end(), 1));
  const auto twice = static_cast<double>(std::count(hits.begin(), hits.end(), 2));
  return twice > 0 ? once * once / (2 * twice) : once * std::max(0.0, once - 1) / 2;
}

double missed_estimate(const std::vector<int>& hits, const Geodesic& least) {
  const bool minimal = least.label != Label::kConjugatePassed && least.label != Label::kNotMinimal;
  return std::max(missed_estimate(hits), minimal && least.hits != 1 ? 0.0 : 1.0);
}

}  // namespace carnot::internal
