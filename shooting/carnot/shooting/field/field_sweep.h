// The least actions from one start to all points of a grid, spread from neighbour to neighbour.
//
// A point keeps one extremal: p(0), the action A, p(T), the inverse of J = dq(T)/dp(0), and
// S = (dp(T)/dp(0)) J^-1. The latter is the second derivative of the action by its target, p(T)
// being the first. So for a neighbour at dq it says
//
//   p(0) + J^-1 dq     and     A + p(T).dq + dq'S dq / 2.
//
// Where that is less than the neighbour has, Newton's method on the end point makes an extremal of
// it (field_wave.h). Sweeps over all points, forward and back, go on until nothing changes.
//
// The grid is cut into slabs across its first axis, which do not depend on the number of threads:
// each is swept by one thread, then borders of every second pair, then the others. So the result
// does not depend on the number of threads either.
#pragma once

#include <functional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_newton.h"
#include "carnot/shooting/field/field_store.h"
#include "carnot/shooting/field/field_wave.h"

namespace carnot::internal {

// How a spread ended.
enum class Spread {
  kSettled,  // nothing changes any more
  kTired,    // it still changes after the most sweeps that were allowed
  kStopped,  // by its caller
};

class FieldSweep {
 public:
  static constexpr int kMostSweeps = 200;

  // Of a scene without drift or potential, whose action is H T. Keeps references.
  FieldSweep(const BoundaryValueProblem& problem, const FieldGrid& grid);

  [[nodiscard]] const FieldStore& points() const { return points_; }
  [[nodiscard]] const FieldCounts& counts() const { return counts_; }
  [[nodiscard]] std::vector<double> target(long i, const std::vector<int>& windings) const {
    return grid_.target(i, windings);
  }
  // Takes an extremal to point i that was found otherwise, where it is better. False where it
  // does not lead there, or is no better.
  bool seed(long i, const std::vector<double>& p0, const std::vector<int>& windings, int origin) {
    return seed(i, p0, windings, origin, counts_.flows);
  }
  // Sweeps until nothing changes, at most so often. `progress` is told by all threads, the fraction
  // that was known after the last sweep. `between` is called between sweeps.
  Spread spread(int threads,
                const Progress& progress,
                const std::function<void()>& between = {},
                int most_sweeps = kMostSweeps);
  // Whether the last spread was not ended: the next one goes on with it.
  [[nodiscard]] bool is_spreading() const { return course_.sweeps > 0; }
  // Gives each point the image of what its mirror images know where that is less; of the mirrors of
  // the scene that keep the start. How many points that improved.
  long reflect(int threads);
  // Points that neighbours promised less than they have, in vain, or which have nothing.
  [[nodiscard]] std::vector<long> doubtful() const;
  // max |q(T) - target| of a flow of twice as many steps, in these units; infinite where it fails.
  // Where it is not `allowed` the extremal is made again with more steps. Safe for different points
  // at once.
  double verify(long i, const std::vector<double>& units, double allowed);

  // All that is known, between two sweeps or two spreads.
  void write(ByteWriter& out) const;
  // What the same sweep has written. Throws DamagedBytes.
  void read(ByteReader& in);

 private:
  // Of a spread.
  struct Course {
    int sweeps = 0;  // so far
    int quiet = 0;   // of these, the last ones without an improvement
  };
  bool seed(long i,
            const std::vector<double>& p0,
            const std::vector<int>& windings,
            int origin,
            long& flows);
  // Takes the image of point `from` in a mirror to where it is, as seed() would.
  bool reflect(long from, const std::vector<double>& mirror, long& flows);
  [[nodiscard]] double error_of(long i, const std::vector<double>& units, int factor) const;
  // Tells the neighbours of point i within [first, last) what it promises them.
  void push_all(long i, long first, long last, FieldWave& wave);
  // One sweep over the layers first to last, forward or back. It ends early where `goes_on` says
  // so, which is asked before every layer.
  void sweep_slab(long first,
                  long last,
                  bool forward,
                  const std::function<bool()>& goes_on,
                  FieldCounts& counts);
  // Tells points across the border above a layer, up and down.
  void cross(long layer, FieldCounts& counts);

  const BoundaryValueProblem& problem_;
  const FieldGrid& grid_;
  FieldNewton newton_;
  int n_;
  long layer_;  // points of a layer across the first axis
  long layers_;
  FieldStore points_;
  FieldCounts counts_;
  Course course_;
};

}  // namespace carnot::internal
