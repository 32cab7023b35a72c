#include "carnot/shooting/search/discrete_list.h"

#include <algorithm>
#include <cmath>
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

}  // namespace

double DiscreteList::action_of(const Path& path) const {
  return discrete_action(problem_.dynamics, problem_.time / path.intervals, path);
}

std::size_t DiscreteList::find(const Path& path, const ExtremalList& extremals) const {
  constexpr double kSame = 1e-6;  // relative
  std::vector<Path> images{path};
  for (const ProblemSymmetry& symmetry : symmetries_) {
    images.push_back(partner(problem_.dynamics.info, symmetry, path));
  }
  const double action = action_of(path);
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const DiscreteExtremal& known = list_[i];
    if (known.path.intervals != path.intervals) continue;
    if (std::abs(action - known.action) > kSame * std::abs(action)) continue;
    if (known.fate == Fate::kExtremal && extremals[known.extremal].singular) return i;
    for (const Path& image : images) {
      if (same_nodes(known.path, image)) return i;
    }
  }
  return list_.size();
}

std::size_t DiscreteList::add(const Path& path) {
  list_.push_back({path, action_of(path)});
  return list_.size() - 1;
}

std::vector<std::size_t> DiscreteList::take_promising(std::vector<std::size_t>& pending) const {
  constexpr double kClearly = 0.2;  // above the least action, relative; grids err by less
  double least = std::numeric_limits<double>::infinity();
  for (const DiscreteExtremal& known : list_) {
    if (known.fate == Fate::kExtremal) least = std::min(least, known.action);
  }
  const bool verified = std::any_of(list_.begin(), list_.end(), [](const DiscreteExtremal& known) {
    return known.fate == Fate::kExtremal;
  });
  for (const std::size_t i : pending) {
    if (!verified) least = std::min(least, list_[i].action);
  }
  std::vector<std::size_t> promising;
  std::vector<std::size_t> rest;
  for (const std::size_t i : pending) {
    const bool clearly_more = list_[i].action - least > kClearly * std::abs(least);
    (clearly_more ? rest : promising).push_back(i);
  }
  pending = rest;
  return promising;
}

int DiscreteList::give_up(const std::vector<std::size_t>& pending) {
  int hits = 0;
  for (const std::size_t i : pending) {
    list_[i].fate = Fate::kGivenUp;
    hits += list_[i].hits;
  }
  return hits;
}

std::vector<int> DiscreteList::hits_given_up() const {
  std::map<int, std::vector<int>> hits;  // by intervals
  for (const DiscreteExtremal& known : list_) {
    if (known.fate == Fate::kGivenUp) hits[known.path.intervals].push_back(known.hits);
  }
  std::vector<int> most;
  for (auto& [intervals, of_grid] : hits) {
    const auto total = [](const std::vector<int>& x) {
      return std::accumulate(x.begin(), x.end(), 0);
    };
    if (total(of_grid) > total(most)) most = std::move(of_grid);
  }
  return most;
}

const Path* DiscreteList::least() const {
  const auto least = std::min_element(
      list_.begin(), list_.end(), [](const DiscreteExtremal& a, const DiscreteExtremal& b) {
        return a.action < b.action;
      });
  return least == list_.end() ? nullptr : &least->path;
}

}  // namespace carnot::internal
