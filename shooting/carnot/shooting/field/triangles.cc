#include "carnot/shooting/field/triangles.h"

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "carnot/shooting/field/cold_searches.h"

namespace carnot::internal {
namespace {

struct Pair {
  long a = 0;
  long b = 0;
};

// The neighbour of a point in one of the directions of the grid, all equally likely.
std::vector<Pair> drawn_pairs(const FieldGrid& grid,
                              const std::function<double(long)>& action,
                              const std::vector<long>& points,
                              std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Pair> pairs;
  for (const long a : points) {
    std::vector<long> neighbours;
    for (std::size_t axis = 0; axis < grid.axes.size(); ++axis) {
      for (const int direction : {-1, 1}) {
        const long b = grid.step(a, axis, direction).index;
        if (b >= 0) neighbours.push_back(b);
      }
    }
    if (neighbours.empty()) continue;
    const long b = neighbours[random() % neighbours.size()];
    if (std::isfinite(action(a)) && std::isfinite(action(b))) pairs.push_back({a, b});
  }
  return pairs;
}

// The least action from one to the other of each pair, NaN where none was found.
std::vector<double> actions_between(const BoundaryValueProblem& problem,
                                    const FieldGrid& grid,
                                    const std::vector<Pair>& pairs,
                                    const GeodesicOptions& search,
                                    int threads,
                                    FieldPartners& partners) {
  std::vector<std::size_t> own;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (partners.has(static_cast<long>(k))) own.push_back(k);
  }
  const auto reports = cold_searches(
      own.size(),
      [&](std::size_t k) {
        BoundaryValueProblem between = problem;
        between.from = grid.target(pairs[own[k]].a);
        between.to = grid.target(pairs[own[k]].b);
        return between;
      },
      search,
      threads);
  std::vector<double> actions(pairs.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < own.size(); ++k) {
    if (!reports[k].geodesics.empty()) actions[own[k]] = reports[k].geodesics[0].action;
  }
  partners.share([&actions](ByteWriter& out) { out.add(actions); },
                 [&actions](ByteReader& in) {
                   const auto theirs = in.take_all<double>(actions.size());
                   for (std::size_t k = 0; k < theirs.size(); ++k) {
                     if (std::isfinite(theirs[k])) actions[k] = theirs[k];
                   }
                 });
  return actions;
}

}  // namespace

Triangles check_triangles(const BoundaryValueProblem& problem,
                          const FieldGrid& grid,
                          const std::function<double(long)>& action,
                          const std::vector<long>& points,
                          const GeodesicOptions& search,
                          std::uint64_t seed,
                          int threads,
                          FieldPartners& partners) {
  constexpr double kBeyond = 1e-8;  // relative; as of points that are searched again
  const std::vector<Pair> pairs = drawn_pairs(grid, action, points, seed);
  const std::vector<double> actions =
      actions_between(problem, grid, pairs, search, threads, partners);
  const auto distance = [&](double of) { return std::sqrt(2 * of * problem.time); };
  Triangles result;
  std::set<long> beyond;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (std::isnan(actions[k])) continue;
    ++result.tried;
    const auto& [a, b] = pairs[k];
    const double between = distance(actions[k]);
    const double to_a = distance(action(a));
    const double to_b = distance(action(b));
    if (to_b > (1 + kBeyond) * (to_a + between)) beyond.insert(b);
    if (to_a > (1 + kBeyond) * (to_b + between)) beyond.insert(a);
  }
  result.beyond.assign(beyond.begin(), beyond.end());
  return result;
}

}  // namespace carnot::internal
