#include "carnot/shooting/field/triangles.h"

#include <cmath>
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

}  // namespace

Triangles check_triangles(const BoundaryValueProblem& problem,
                          const FieldGrid& grid,
                          const std::function<double(long)>& action,
                          const std::vector<long>& points,
                          const GeodesicOptions& search,
                          std::uint64_t seed,
                          int threads) {
  constexpr double kBeyond = 1e-8;  // relative; as of points that are searched again
  const std::vector<Pair> pairs = drawn_pairs(grid, action, points, seed);
  const auto reports = cold_searches(
      pairs.size(),
      [&](std::size_t k) {
        BoundaryValueProblem between = problem;
        between.from = grid.target(pairs[k].a);
        between.to = grid.target(pairs[k].b);
        return between;
      },
      search,
      threads);
  const auto distance = [&](double of) { return std::sqrt(2 * of * problem.time); };
  Triangles result;
  std::set<long> beyond;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (reports[k].geodesics.empty()) continue;
    ++result.tried;
    const auto& [a, b] = pairs[k];
    const double between = distance(reports[k].geodesics[0].action);
    const double to_a = distance(action(a));
    const double to_b = distance(action(b));
    if (to_b > (1 + kBeyond) * (to_a + between)) beyond.insert(b);
    if (to_a > (1 + kBeyond) * (to_b + between)) beyond.insert(a);
  }
  result.beyond.assign(beyond.begin(), beyond.end());
  return result;
}

}  // namespace carnot::internal
