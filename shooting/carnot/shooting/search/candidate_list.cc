#include "carnot/shooting/search/candidate_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace carnot::internal {
namespace {

int rung_of(const Candidate& candidate) { return candidate.limited.path.rung; }

// Grids may differ: nodes are compared at the times that both have.
bool are_alike(const Candidate& a, const Candidate& b) {
  constexpr double kSame = 2e-2;        // of the extent of the path
  constexpr double kSameOnGrid = 2e-2;  // of the action
  if (rung_of(a) != rung_of(b)) return false;
  if (std::abs(a.action - b.action) > kSameOnGrid * std::abs(b.action)) return false;
  const bool a_is_coarse = a.limited.path.intervals <= b.limited.path.intervals;
  const Path& coarse = (a_is_coarse ? a : b).limited.path;
  const Path& fine = (a_is_coarse ? b : a).limited.path;
  const int stride = fine.intervals / coarse.intervals;
  double apart = 0;
  double extent = 0;
  for (int i = 0; i <= coarse.intervals; ++i) {
    for (int j = 0; j < coarse.dof; ++j) {
      const double q = coarse.configuration(i)[j];
      apart = std::max(apart, std::abs(q - fine.configuration(stride * i)[j]));
      extent = std::max(extent, std::abs(q - coarse.configuration(0)[j]));
    }
  }
  return apart <= kSame * extent;
}

}  // namespace

std::size_t CandidateList::note(Candidate candidate) {
  const auto known = std::find_if(list_.begin(), list_.end(), [&](const Entry& entry) {
    return !entry.candidate.tried && are_alike(candidate, entry.candidate);
  });
  const auto place = static_cast<std::size_t>(known - list_.begin());
  if (known == list_.end()) {
    list_.push_back({std::move(candidate), false, std::nullopt});
    return place;
  }
  for (Entry* entry = &*known;; entry = &list_[*entry->to]) {
    entry->candidate.hits += candidate.hits;
    if (!entry->to) break;
  }
  const int finer = candidate.limited.path.intervals - known->candidate.limited.path.intervals;
  if (finer > 0 || (finer == 0 && candidate.action < known->candidate.action)) {
    candidate.hits = known->candidate.hits;
    known->candidate = std::move(candidate);
  }
  return place;
}

std::vector<std::size_t> CandidateList::waiting_on(int rung, bool all) const {
  constexpr double kClearly = 0.2;  // above the least action, relative; grids err by less
  double least = std::numeric_limits<double>::infinity();
  for (const Entry& entry : list_) {
    if (rung_of(entry.candidate) == rung) least = std::min(least, entry.candidate.action);
  }
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const Entry& entry = list_[i];
    if (rung_of(entry.candidate) != rung || entry.gone) continue;
    const bool clearly_more = entry.candidate.action - least > kClearly * std::abs(least);
    if (all || !clearly_more) waiting.push_back(i);
  }
  return waiting;
}

void CandidateList::went_down(std::size_t place, std::optional<std::size_t> to) {
  list_[place].gone = true;
  list_[place].to = to;
}

int CandidateList::hits_of_least() const {
  const Candidate* least = nullptr;
  for (const Entry& entry : list_) {
    const Candidate& candidate = entry.candidate;
    if (rung_of(candidate) > 0) continue;
    if (least == nullptr || candidate.action < least->action) least = &candidate;
  }
  return least == nullptr ? 0 : least->hits;
}

std::vector<Candidate*> CandidateList::open() {
  std::vector<Candidate*> open;
  for (Entry& entry : list_) {
    if (rung_of(entry.candidate) == 0 && !entry.candidate.tried) open.push_back(&entry.candidate);
  }
  std::stable_sort(open.begin(), open.end(), [](const Candidate* a, const Candidate* b) {
    return a->action < b->action;
  });
  return open;
}

}  // namespace carnot::internal
