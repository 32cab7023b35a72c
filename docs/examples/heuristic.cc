// A* among obstacles, with the distance without obstacles as its heuristic.
//
// A unicycle goes through a gap in a wall. Its planner knows four motions: to the next point of a
// lattice, forward or backward, and to turn on the spot by 45 degrees to either side. The field of
// distances never tells more than what is left, so the path that A* finds is the shortest of these
// motions; and it knows what the straight line does not, that a unicycle cannot move sideways.
#include <carnot/make_dynamics.h>
#include <carnot/scenes/unicycle.h>
#include <carnot/shooting/distance_field.h>

#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <numbers>
#include <queue>
#include <tuple>
#include <vector>

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStep = 0.25;

using Node = std::array<int, 3>;  // x, y in steps, the heading in eighths of a turn
using Bound = std::function<double(const Node&)>;

bool is_free(const Node& at) {
  const bool inside = std::abs(at[0]) <= 12 && std::abs(at[1]) <= 12;
  const bool gap = at[1] >= 4 && at[1] <= 5;
  return inside && (at[0] != 4 || gap);
}

// Prints the length of the shortest path to the origin, and of how many nodes it was looked for.
void plan(const Node& start, const Bound& left) {
  constexpr std::array<int, 8> kX{1, 1, 0, -1, -1, -1, 0, 1};
  std::priority_queue<std::tuple<double, double, Node>> open;  // minus the least length, minus ...
  std::map<Node, double> driven{{start, 0}};
  open.emplace(-left(start), 0, start);
  for (int nodes = 0; !open.empty(); ++nodes) {
    const auto [estimate, minus_length, at] = open.top();
    open.pop();
    if (at == Node{0, 0, 0}) {
      std::cout << "length " << -minus_length << ", " << nodes << " nodes\n";
      return;
    }
    if (-minus_length > driven[at]) continue;  // there is a shorter way by now
    const auto go = [&, length = -minus_length](const Node& next, double cost) {
      const double there = length + cost;
      const auto [known, is_new] = driven.emplace(next, there);
      if (!is_free(next) || (!is_new && known->second <= there)) return;
      known->second = there;
      open.emplace(-there - left(next), -there, next);
    };
    const int dx = kX[at[2]];
    const int dy = kX[(at[2] + 6) % 8];  // sine
    for (const int sign : {1, -1}) {
      go({at[0] + sign * dx, at[1] + sign * dy, at[2]}, kStep * std::hypot(dx, dy));
      go({at[0], at[1], (at[2] + sign + 8) % 8}, kPi / 4);
    }
  }
}

std::vector<double> values(double first, double step, int count) {
  std::vector<double> x(count);
  for (int i = 0; i < count; ++i) x[i] = first + i * step;
  return x;
}

}  // namespace

int main() {
  const carnot::BoundaryValueProblem origin(
      carnot::make_dynamics(carnot::scenes::Unicycle{}), {0, 0, 0}, {0, 0, 0});
  const std::vector<carnot::FieldAxis> axes{
      {0, values(-3, 0.5, 13)}, {1, values(-3, 0.5, 13)}, {2, values(-kPi, kPi / 8, 16)}};
  carnot::FieldOptions options;
  options.search.mod_angles = true;
  options.check = 30;
  const carnot::Field field = carnot::solve_field(origin, axes, options);
  std::cout << field.action.size() << " distances; " << field.lower << " of " << field.checked
            << " were too large, " << field.violations << " violate a triangle\n";
  const carnot::DistanceField distance(origin, axes, options.search.mod_angles, field);

  const auto pose = [](const Node& at) {
    return std::array<double, 3>{kStep * at[0], kStep * at[1], kPi / 4 * at[2]};
  };
  const Node start{8, -2, 2};
  plan(start, [&](const Node& at) { return distance.lower_bound(pose(at)); });
  plan(start, [&](const Node& at) { return std::hypot(pose(at)[0], pose(at)[1]); });
}
