#include "carnot/shooting/search/discrete_list.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace carnot::internal {
namespace {

bool same_nodes(const Path& a, const Path& b) {
  constexpr double kSame = 1e-6;  // of the extent
  if (a.q.size() != b.q.size()) return false;
  double apart = 0;
  double extent = 0;
  for (std::size_t j = 0; j < a.q.size(); ++j) {
    apart = std::max(apart, std::abs(a.q[j] - b.q[j]));
    extent = std::max(extent, std::abs(a.q[j] - a.q[j % a.dof]));
  }
  return apart <= kSame * extent;
}

// Lowers what is known of the least action on the rung of this one.
void lower(std::map<int, double>& least, const DiscreteExtremal& extremal) {
  const auto [of_rung, first] = least.try_emplace(extremal.path.rung, extremal.action);
  if (!first) of_rung->second = std::min(of_rung->second, extremal.action);
}

}  // namespace

double DiscreteList::action_of(const Path& path) const {
  const BoundaryValueProblem& problem = ladder_.on(path.rung);
  return discrete_action(problem.dynamics, problem.time / path.intervals, path);
}

std::size_t DiscreteList::find(const Path& path, const ExtremalList& extremals) const {
  constexpr double kSame = 1e-6;  // relative
  std::vector<Path> images{path};
  for (const ProblemSymmetry& symmetry : symmetries_) {
    images.push_back(partner(ladder_.on(0).dynamics.info, symmetry, path));
  }
  const double action = action_of(path);
  const auto is_this = [&](const DiscreteExtremal& known, const Path& form, double of_form) {
    if (form.intervals != path.intervals || form.rung != path.rung) return false;
    if (std::abs(action - of_form) > kSame * std::abs(action)) return false;
    if (known.fate == Fate::kExtremal && extremals[known.extremal].singular) return true;
    return std::any_of(
        images.begin(), images.end(), [&](const Path& image) { return same_nodes(form, image); });
  };
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const DiscreteExtremal& known = list_[i];
    if (known.fate == Fate::kMerged) continue;
    if (is_this(known, known.path, known.action)) return i;
    for (const DiscretePath& other : known.others) {
      if (is_this(known, other.path, other.action)) return i;
    }
  }
  return list_.size();
}

std::size_t DiscreteList::add(const Path& path, const Hits& found) {
  DiscreteExtremal& added = list_.emplace_back();
  added.path = path;
  added.action = action_of(path);
  added.hits = found;
  return list_.size() - 1;
}

std::size_t DiscreteList::refine(std::size_t index,
                                 const std::vector<Path>& finer,
                                 const ExtremalList& extremals) {
  std::vector<DiscretePath> forms;
  std::size_t becomes = list_.size();
  for (const Path& path : finer) {
    becomes = find(path, extremals);
    if (becomes < list_.size()) break;
    forms.push_back({path, action_of(path)});
  }
  DiscreteExtremal& refined = list_[index];
  if (becomes < list_.size()) {
    forms.push_back({refined.path, refined.action});
    refined.fate = Fate::kMerged;
  } else {
    becomes = index;
  }
  DiscreteExtremal& known = list_[becomes];
  known.others.insert(known.others.end(), forms.begin(), forms.end());
  if (becomes == index && !forms.empty()) {
    const std::size_t last = forms.size() - 1;
    const bool after_one = last == 0;
    const int rung = after_one ? refined.path.rung : forms[last - 1].path.rung;
    if (rung > 0) return becomes;  // the actions are of two problems
    const double coarse = after_one ? refined.action : forms[last - 1].action;
    const double correction = (forms[last].action - coarse) / 3;
    refined.estimate = forms[last].action + correction;
    refined.uncertainty = std::abs(correction);
  }
  return becomes;
}

std::vector<std::size_t> DiscreteList::take_promising(std::vector<std::size_t>& pending) const {
  constexpr double kClearly = 0.2;  // above the least action, relative; grids err by less
  // On each rung, of extremals; of the pending ones where there are none.
  std::map<int, double> least;
  std::map<int, double> least_pending;
  for (const DiscreteExtremal& known : list_) {
    if (known.fate == Fate::kExtremal) lower(least, known);
  }
  for (const std::size_t i : pending) lower(least_pending, list_[i]);
  least.merge(least_pending);
  std::vector<std::size_t> promising;
  std::vector<std::size_t> rest;
  for (const std::size_t i : pending) {
    const double of_rung = least.at(list_[i].path.rung);
    const bool clearly_more = list_[i].action - of_rung > kClearly * std::abs(of_rung);
    (clearly_more ? rest : promising).push_back(i);
  }
  pending = rest;
  return promising;
}

std::vector<std::size_t> DiscreteList::perhaps_least(const std::vector<std::size_t>& refined,
                                                     double least) const {
  for (const std::size_t i : refined) {
    least = std::min(least, list_[i].estimate + list_[i].uncertainty);
  }
  std::vector<std::size_t> perhaps;
  std::copy_if(refined.begin(), refined.end(), std::back_inserter(perhaps), [&](std::size_t i) {
    return !(list_[i].estimate - list_[i].uncertainty > least);  // NaN may be
  });
  return perhaps;
}

std::vector<std::size_t> DiscreteList::beyond_rivals(const std::vector<std::size_t>& refined,
                                                     double least) const {
  // Of 214 discrete extremals of ten scenes, polished, 7 were off by more than half of what is
  // allowed for, and 3 by more than all of it; the medians are between 0.004 and 0.08. From grids
  // of grushin shooting leads elsewhere.
  constexpr double kOff = 0.5;
  const double highest = least + ExtremalList::kRival * std::abs(least);
  std::vector<std::size_t> beyond;
  std::copy_if(refined.begin(), refined.end(), std::back_inserter(beyond), [&](std::size_t i) {
    return list_[i].estimate - kOff * list_[i].uncertainty > highest;
  });
  return beyond;
}

Hits DiscreteList::give_up(const std::vector<std::size_t>& pending) {
  Hits hits;
  for (const std::size_t i : pending) {
    list_[i].fate = Fate::kGivenUp;
    hits += list_[i].hits;
  }
  return hits;
}

std::vector<Hits> DiscreteList::hits_given_up() const {
  std::map<std::pair<int, int>, std::vector<Hits>> hits;  // by intervals and rungs
  for (const DiscreteExtremal& known : list_) {
    if (known.fate != Fate::kGivenUp) continue;
    hits[{known.path.intervals, known.path.rung}].push_back(known.hits);
  }
  std::vector<Hits> most;
  for (auto& [grid, of_grid] : hits) {
    const auto total = [](const std::vector<Hits>& x) {
      return std::accumulate(
          x.begin(), x.end(), 0, [](int sum, const Hits& one) { return sum + one.starts; });
    };
    if (total(of_grid) > total(most)) most = std::move(of_grid);
  }
  return most;
}

const Path* DiscreteList::least() const {
  const Path* least = nullptr;
  double action = 0;
  const auto consider = [&](const Path& path, double of_path) {
    if (least != nullptr && std::pair(path.rung, of_path) >= std::pair(least->rung, action)) {
      return;
    }
    least = &path;
    action = of_path;
  };
  for (const DiscreteExtremal& known : list_) {
    consider(known.path, known.action);
    // On finer grids it is lower on the ladder.
    if (known.path.rung == 0) continue;
    for (const DiscretePath& other : known.others) consider(other.path, other.action);
  }
  return least;
}

std::vector<const Path*> DiscreteList::least(int count) const {
  std::vector<const DiscreteExtremal*> known;
  for (const DiscreteExtremal& extremal : list_) {
    const bool leads_on = extremal.fate == Fate::kExtremal || extremal.fate == Fate::kGivenUp;
    if (leads_on) known.push_back(&extremal);
  }
  std::stable_sort(known.begin(), known.end(), [](const auto* a, const auto* b) {
    return a->action < b->action;
  });
  if (known.size() > static_cast<std::size_t>(count)) known.resize(count);
  std::vector<const Path*> paths;
  paths.reserve(known.size());
  for (const DiscreteExtremal* extremal : known) paths.push_back(&extremal->path);
  return paths;
}

}  // namespace carnot::internal
