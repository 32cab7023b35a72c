// Lower bounds of the distance from one configuration, from a field on a grid: a heuristic for
// planners, in some tens of nanoseconds.
//
// The scenes of fields have no drift and no potential, so a path may be driven back: the distance
// from the start of the field to q is that from q to it, too. A* with such a bound finds the
// shortest of its paths.
//
// Between the points of the grid the distance d is interpolated linearly in each coordinate. That
// is too much where d bends upwards, by at most
//
//   sum over the axes of  h^2 C / 8,     C >= the second derivatives along the axis, h its step,
//
// and only there: where geodesics meet at a cut locus d has a concave kink, the least of several
// functions. (An error in one coordinate after the other; mixed derivatives do not count.) From
// where no geodesic is abnormal and but for the start, d has such a C: it is semiconcave (Cannarsa
// & Rifford, Ann. IHP 25, 2008). Lipschitz constants, largest slopes, would serve as well, but cost
// an error of the order of h. C comes from the second differences of the field: twice the largest
// of those around the points of a cell and of their neighbours. At 600,000 points of the Heisenberg
// group on grids of 21^3 and 41^3 this was never too little, nor were the differences themselves
// instead of twice as much; nothing in the place of C was too little at half of them.
// At 150,000 poses of unicycles, a field on a grid twice as fine, it was never too little either.
//
// The bound is as true as the field: what the three figures of the latter say counts here, too.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "carnot/shooting/solve_field.h"

namespace carnot {

class DistanceField {
 public:
  static constexpr int kMostCoordinates = 8;

  // Of a field that `solve_field` gave for these arguments. Throws std::invalid_argument where it
  // was stopped or an axis is missing: every coordinate has one, of at least 3 values. Points that
  // are not known have the bound 0. Memory: 8 bytes a point.
  DistanceField(const BoundaryValueProblem& problem,
                const std::vector<FieldAxis>& axes,
                bool mod_angles,
                const Field& field);

  // A file that `write` or `carnot atlas --field --output FILE.field` wrote: lines of text, then
  // numbers of 32 bits and their checksum. Throws std::runtime_error that names the file.
  static DistanceField read(const std::string& path);
  // Writes such a file. Throws std::runtime_error that names the file where it cannot.
  void write(const std::string& path) const;

  // At most the length of every path between `from()` and q, an integral of sqrt(2 L); 0 beyond the
  // grid. q has an entry for each coordinate. Safe to call from many threads, allocates nothing.
  [[nodiscard]] double lower_bound(std::span<const double> q) const;

  // The name of the scene whose paths are bounded.
  [[nodiscard]] const std::string& scene() const { return scene_; }
  // Where these paths start: n coordinates in the scene's units.
  [[nodiscard]] const std::vector<double>& from() const { return from_; }

 private:
  struct Axis {
    int coordinate = 0;
    double first = 0;
    double step = 0;  // negative on a falling axis
    long count = 0;
    double period = 0;  // in steps; 0: the coordinate has none
    bool around = false;
    long stride = 0;
  };

  DistanceField() = default;
  // From first, step, count and period in the coordinate's unit.
  void add_axis(Axis axis);
  void set_strides();
  void find_deficits();

  std::string scene_;
  std::vector<double> from_;
  std::vector<Axis> axes_;
  std::vector<float> distance_;  // at the points, rounded down
  std::vector<float> deficit_;   // of the cell above each point, rounded up
};

}  // namespace carnot
