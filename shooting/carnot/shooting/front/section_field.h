// The distances of the places of a section, on a grid that fits the sphere.
//
// A section by a condition on the ends (front/end_condition.h) of a scene with four coordinates has
// three. Its places as near as R are in a box about the start, which coarse fields fit to them, and
// a finer one has the grid that is asked for.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_solver.h"
#include "carnot/shooting/front/end_condition.h"

namespace carnot::internal {

using GridPlace = long;  // its number on a grid

struct SectionOptions {
  EndCondition condition;
  double length = 1;  // R
  double edge = 0.1;  // the longest, in coordinates that are 1 wide
  std::uint64_t seed = 0;
  int threads = 0;
  Progress progress;  // may be called by several threads
};

class SectionField {
 public:
  // Keeps references.
  SectionField(const Dynamics& dynamics,
               const std::vector<double>& from,
               const SectionOptions& options);

  // False when stopped. Cost: some six fields of 12^3 places, and one of (1.73 / edge)^3 or, where
  // the sphere is thin, up to 64 times as many.
  bool fit();

  [[nodiscard]] const FieldGrid& grid() const { return grid_; }
  // The coordinates without that of the condition.
  [[nodiscard]] const std::array<int, 3>& seen() const { return seen_; }
  // The distance of a place, relative to R, less 1; 1 where it is not known.
  [[nodiscard]] double beyond(GridPlace i) const { return beyond_[i]; }
  [[nodiscard]] bool is_inside(GridPlace i) const { return beyond_[i] < 0; }
  [[nodiscard]] bool is_known(GridPlace i) const;
  // Of the shortest extremal to a place that is known, at the start, where it takes the time R.
  [[nodiscard]] Eigen::VectorXd momentum(GridPlace i) const;
  [[nodiscard]] Eigen::VectorXd place(GridPlace i) const;
  // How wide the box is in each coordinate, more or less.
  [[nodiscard]] Eigen::VectorXd widths() const;
  [[nodiscard]] long searches() const { return searches_; }
  [[nodiscard]] long unknown() const;

 private:
  static constexpr int kCoarse = 12;  // places along each axis, to fit the box
  static constexpr double kCell = 2.0 / (kCoarse - 1);

  // The coordinates that the axes have, which others follow.
  [[nodiscard]] std::array<double, 3> on_axes(const std::vector<double>& q) const;
  [[nodiscard]] FieldGrid grid_of(const std::array<int, 3>& counts) const;
  // False when stopped, as of those that follow.
  bool solve(FieldGrid grid, long check);
  // As far as one gets along each axis alone, and along others half the most of that, in the
  // natural scales of the scene.
  void begin_box();
  // Fits the box to the sphere, roughly.
  bool settle_box();
  // Turns the box along a thin sphere. Whether it did so.
  bool shear();
  // On a grid that is fine enough for the sphere to have no handles, if that helps.
  bool solve_finely();
  // Widens the box until its border is outside.
  bool solve_within(const std::array<int, 3>& counts);
  // Where a place is in the box: from -1 to 1 along each axis.
  [[nodiscard]] std::array<double, 3> in_box(GridPlace i) const;
  // How far out places within the distance are.
  [[nodiscard]] std::array<double, 3> reaches() const;
  // Places inside that follow each other along an axis: the lower quartile of such rows.
  [[nodiscard]] int thickness(int axis) const;
  [[nodiscard]] std::array<int, 3> fine_counts() const;

  const Dynamics& dynamics_;
  const std::vector<double>& from_;
  const SectionOptions& options_;
  std::array<int, 3> seen_{};
  std::array<double, 3> half_{};  // of the box along each axis
  std::vector<FieldGrid::Follower> shear_;
  FieldGrid grid_;
  Field field_;
  std::vector<double> beyond_;
  long searches_ = 0;
};

}  // namespace carnot::internal
