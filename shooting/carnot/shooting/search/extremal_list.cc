#include "carnot/shooting/search/extremal_list.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/extremal/ranking.h"

namespace carnot::internal {

std::size_t ExtremalList::add(const Extremal& extremal) { return add(extremal, kNone); }

std::size_t ExtremalList::add(const Extremal& extremal, std::size_t partner_of) {
  for (std::size_t i = 0; i < list_.size(); ++i) {
    if (!same(list_[i], extremal) && !same_family(list_[i], extremal)) continue;
    const bool simpler = list_[i].geodesic.verification == Verification::kKnots &&
                         extremal.geodesic.verification == Verification::kSingle;
    if (simpler) list_[i] = extremal;
    return i;
  }
  const std::size_t index = list_.size();
  list_.push_back(extremal);
  hits_.emplace_back();
  partner_of_.push_back(partner_of);
  if (!partners_) return index;
  for (const Extremal& partner : partners_(extremal)) add(partner, index);
  return index;
}

std::size_t ExtremalList::best() const {
  const auto least =
      std::min_element(list_.begin(), list_.end(), [](const Extremal& a, const Extremal& b) {
        return a.geodesic.action < b.geodesic.action;
      });
  return static_cast<std::size_t>(least - list_.begin());
}

Competition ExtremalList::competition() const {
  const double least = least_action();
  Competition competition;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const double above = list_[i].geodesic.action - least;
    if (above <= kSameAction * std::abs(least)) competition.hits += hits_[i];
    if (above <= kRival * std::abs(least)) ++competition.rivals;
  }
  return competition;
}

std::vector<Hits> ExtremalList::hits() const {
  std::vector<Hits> hits;
  std::copy_if(hits_.begin(), hits_.end(), std::back_inserter(hits), [](const Hits& of_one) {
    return of_one.all() > 0;
  });
  return hits;
}

std::vector<Extremal> ExtremalList::up_to(double max_length) const {
  std::vector<Extremal> list;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    if (list_[i].geodesic.length.value_or(0) > max_length) continue;
    list.push_back(list_[i]);
    list.back().geodesic.hits = hits_[root(i)].all();
  }
  return list;
}

}  // namespace carnot::internal
