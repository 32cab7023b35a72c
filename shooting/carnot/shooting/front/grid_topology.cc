#include "carnot/shooting/front/grid_topology.h"

#include <vector>

namespace carnot::internal {
namespace {

class Pieces {
 public:
  Pieces(const FieldGrid& grid, const std::function<bool(long)>& belongs)
      : grid_(grid), inside_(grid.size()), all_ways_(1 << grid.axes.size()) {
    for (long i = 0; i < grid.size(); ++i) inside_[i] = belongs(i) ? 1 : 0;
  }

  GridTopology topology() {
    GridTopology result;
    std::vector<char> seen(inside_.size(), 0);
    for (long i = 0; i < grid_.size(); ++i) {
      if (inside_[i] == 0) continue;
      result.euler += alternating_sum(i, 0);
      if (seen[i] != 0) continue;
      ++result.pieces;
      fill(i, seen);
    }
    return result;
  }

 private:
  // The place one step along each axis of a way, or against each; -1 where it is not in the set.
  [[nodiscard]] long along(long i, int way, int direction) const {
    for (std::size_t axis = 0; axis < grid_.axes.size() && i >= 0; ++axis) {
      if ((way >> axis & 1) != 0) i = grid_.step(i, axis, direction).index;
    }
    return i >= 0 && inside_[i] != 0 ? i : -1;
  }
  // Of the simplices that begin here and go on along other axes than those `used`: corners, less
  // edges, and so on.
  [[nodiscard]] int alternating_sum(long i, int used) const {
    int sum = 1;
    for (int way = 1; way < all_ways_; ++way) {
      if ((way & used) != 0) continue;
      const long next = along(i, way, 1);
      if (next >= 0) sum -= alternating_sum(next, used | way);
    }
    return sum;
  }
  void fill(long first, std::vector<char>& seen) const {
    std::vector<long> open{first};
    seen[first] = 1;
    while (!open.empty()) {
      const long i = open.back();
      open.pop_back();
      for (int way = 1; way < all_ways_; ++way) {
        for (const int direction : {1, -1}) {
          const long next = along(i, way, direction);
          if (next < 0 || seen[next] != 0) continue;
          seen[next] = 1;
          open.push_back(next);
        }
      }
    }
  }

  const FieldGrid& grid_;
  std::vector<char> inside_;
  int all_ways_;
};

}  // namespace

GridTopology grid_topology(const FieldGrid& grid, const std::function<bool(long)>& belongs) {
  return Pieces(grid, belongs).topology();
}

}  // namespace carnot::internal
