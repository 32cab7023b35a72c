// Neighbours that were promised less, and wait to be reached side by side.
//
// A point that promises a neighbour less than it has (field_sweep.h) puts it on a wave. When the
// wave is run, Newton's method makes extremals of all of it (field_newton.h). The J of each must
// have a determinant of the same sign as that of the point it comes from: a change means that a
// conjugate time has passed T on the way. Who is not reached so is reached by way of points
// between, all of these side by side, too. A neighbour that is on the wave already is asked again
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
  // Whether it is better run before more is pushed.
  [[nodiscard]] bool full() const { return wave_.size() >= kFull; }
  [[nodiscard]] bool empty() const { return wave_.empty(); }
  // Reaches all that waits. Returns the slots that have news of it, in the order in which they were
  // filled.
  std::vector<FieldSlot> run();

 private:
  // So that packs are full to the end, when most of a wave is reached. A field of 69,696 vehicles
  // takes 1.2, 1 and 1.2 times as long with 64, 256 and 1024; with more, points tell their
  // neighbours what soon is no longer true.
  static constexpr std::size_t kFull = 256;
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
  // From `from` to a target at dq beside its own; without p0 where that is too far to try.
  static FieldAttempt attempt(const FieldPoint& from,
                              std::vector<double> target,
                              const SmallVector& dq);
  // By way of points between, which are nearer where Newton's method fails: grids are coarse beside
  // what some momenta turn in a step. Of 69,696 vehicles 2,732 are doubted in the end with parts
  // down to 1/16, and 2,366 with 1/32. What is known on the way tells sooner that there is no less,
  // in a third of all cases.
  struct Way {
    static constexpr double kLeast = 1.0 / 32;
    const Push* push = nullptr;
    FieldPoint point;  // as far as it has come
    double done = 0;
    double part = 0.5;  // of the whole, that is tried next
    enum class Fate { kOpen, kThere, kNoLess, kNowhere } fate = Fate::kOpen;
  };
  void follow(std::vector<Way>& ways);
  [[nodiscard]] FieldAttempt attempt(const Way& way) const;
  void go_on(Way& way, const FieldAttempt& attempt) const;
  // The extremal is one to the point that was pushed.
  void take(const Push& push, FieldPoint point);

  const FieldGrid& grid_;
  FieldStore& points_;
  FieldCounts& counts_;
  FieldNewton newton_;
  std::vector<Push> wave_;   // to different points
  std::vector<Push> after_;  // to points that are on the wave
  std::vector<FieldSlot> less_;
};

}  // namespace carnot::internal
