// Neighbours that were promised less, and wait to be reached side by side.
//
// A point that promises a neighbour less than it has (field_sweep.h) puts it on a wave. When the
// wave is full, Newton's method makes extremals of all of it (field_newton.h). The J of each must
// have a determinant of the same sign as that of the point it comes from: a change means that a
// conjugate time has passed T on the way. A neighbour that is on the wave already is asked again
// when that is done.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_newton.h"
#include "carnot/shooting/field/field_store.h"

namespace carnot::internal {

struct FieldCounts {
  long pushes = 0;    // that promised less
  long improved = 0;  // of these
  long flows = 0;     // tangent flows
  long sweeps = 0;    // of the longest spread
  FieldCounts& operator+=(const FieldCounts& other);
};

class FieldWave {
 public:
  // Keeps references. Only points that are pushed to change.
  FieldWave(const BoundaryValueProblem& problem,
            const FieldGrid& grid,
            FieldStore& points,
            FieldCounts& counts);

  // Asks the neighbour that lies a step away from the target of `from`.
  void push(const FieldPoint& from, std::size_t axis, const FieldGrid::Step& step);
  // Whether what waits may change point i.
  [[nodiscard]] bool awaits(long i) const;
  // Reaches all that waits.
  void run();

 private:
  struct Push {
    FieldPoint from;
    long to = -1;
    std::vector<int> windings;  // of the target there, next to this one
    SmallVector dq;
    double promise = 0;
    double slack = 0;  // by how much less it may turn out to be
  };
  // What a point promises another one at dq from it.
  static Push promised(const FieldPoint& from, long to, std::vector<int> windings, SmallVector dq);
  // Puts it on the wave where that is worth trying.
  void add(Push push);
  void reach();
  // Whether what is promised is worth trying.
  [[nodiscard]] bool tempts(const Push& push) const;
  // From `from` to a target at dq beside its own; p0 is empty where that is too far to try.
  static FieldAttempt attempt(const FieldPoint& from,
                              std::vector<double> target,
                              const SmallVector& dq);
  // By way of points between, which are nearer where Newton's method fails: grids are coarse beside
  // what some momenta turn in a step. With halves only 3,950 of 17,424 vehicles were doubted, and
  // 1,620 with sixteenths. What is known on the way tells sooner that there is no less, in a third
  // of all cases.
  enum class Parts { kThere, kNoLess, kNowhere };
  [[nodiscard]] Parts reach_in_parts(const Push& push, FieldPoint& point);
  // What came of a push that was attempted directly, which may have failed.
  void take(const Push& push, const FieldAttempt& attempt);

  const FieldGrid& grid_;
  FieldStore& points_;
  FieldCounts& counts_;
  FieldNewton newton_;
  std::vector<Push> wave_;   // to different points
  std::vector<Push> after_;  // to points that are on the wave
  std::vector<FieldAttempt> attempts_;
};

}  // namespace carnot::internal
