// The targets of a field: a grid of some coordinates, all others those of one target.
#pragma once

#include <Eigen/Core>
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
  // A coordinate that changes with one that has an axis: q_coordinate += ratio q_leader.
  struct Follower {
    int coordinate = 0;
    int leader = 0;
    double ratio = 1;
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
  std::vector<Axis> axes;             // the first one slowest
  std::vector<Follower> followers{};  // one after the other

  [[nodiscard]] long size() const;
  // The target of point i, without windings.
  [[nodiscard]] std::vector<double> target(long i) const;
  // The same with whole periods of the axes added.
  [[nodiscard]] std::vector<double> target(long i, const std::vector<int>& windings) const;
  // By how much the target changes when the coordinate of an axis does so by `length`.
  [[nodiscard]] Eigen::VectorXd change(std::size_t axis, double length) const;
  // One value up (direction 1) or down (-1) along an axis.
  [[nodiscard]] Step step(long i, std::size_t axis, int direction) const;
  // Where the target of point i with its windings is in a mirror, 1 or -1 for each coordinate.
  [[nodiscard]] Image image(long i,
                            const std::vector<int>& windings,
                            const std::vector<double>& mirror) const;
};

}  // namespace carnot::internal
