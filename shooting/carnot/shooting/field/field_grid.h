// The targets of a field: a grid of some coordinates, all others those of one target.
#pragma once

#include <cstddef>
#include <vector>

namespace carnot::internal {

struct FieldGrid {
  struct Axis {
    int coordinate = 0;
    std::vector<double> values;  // equidistant
    bool around = false;         // the last is a neighbour of the first one, a period away
    double period = 0;           // of the coordinate; 0: none
  };
  // To a neighbour.
  struct Step {
    long index = -1;    // of the neighbour; -1 where there is none
    int turns = 0;      // whole periods that its target lies beyond the one of its index
    double length = 0;  // of the coordinate, from here to there
  };
  // Of a point in a mirror.
  struct Image {
    long index = -1;  // -1 where the grid has none
    std::vector<int> windings;
  };
  std::vector<double> to;
  std::vector<Axis> axes;  // the first one slowest

  [[nodiscard]] long size() const;
  // The target of point i, without windings.
  [[nodiscard]] std::vector<double> target(long i) const;
  // The same with whole periods of the axes added.
  [[nodiscard]] std::vector<double> target(long i, const std::vector<int>& windings) const;
  // One value up (direction 1) or down (-1) along an axis.
  [[nodiscard]] Step step(long i, std::size_t axis, int direction) const;
  // Where the target of point i with its windings is in a mirror, 1 or -1 for each coordinate.
  [[nodiscard]] Image image(long i,
                            const std::vector<int>& windings,
                            const std::vector<double>& mirror) const;
};

}  // namespace carnot::internal
