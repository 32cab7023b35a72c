// The least actions from one start to all points of a grid, spread from neighbour to neighbour.
//
// A point keeps one extremal: p(0), the action A, p(T), the inverse of J = dq(T)/dp(0), and
// S = (dp(T)/dp(0)) J^-1. The latter is the second derivative of the action by its target, p(T)
// being the first. So for a neighbour at dq it says
//
//   p(0) + J^-1 dq     and     A + p(T).dq + dq'S dq / 2.
//
// Where that is less than the neighbour has, Newton's method on the end point makes an extremal of
// it (field_newton.h), for several neighbours at once. Its J must have a determinant of the same
// sign: a change means that a conjugate time has passed T on the way. Sweeps over all points,
// forward and back, go on until nothing changes.
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

namespace carnot::internal {

struct FieldCounts {
  long pushes = 0;    // that promised less
  long improved = 0;  // of these
  long flows = 0;     // tangent flows
  long sweeps = 0;    // of the longest spread
  FieldCounts& operator+=(const FieldCounts& other);
};

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
  [[nodiscard]] std::vector<double> target(long i, const std::vector<int>& windings) const;
  // Takes an extremal to point i that was found otherwise, where it is better. False where it
  // does not lead there, or is no better.
  bool seed(long i, const std::vector<double>& p0, const std::vector<int>& windings, int origin);
  // Sweeps until nothing changes, at most so often. `progress` is told by all threads, the fraction
  // that was known after the last sweep.
  Spread spread(int threads, const Progress& progress, int most_sweeps = kMostSweeps);
  // Points that neighbours promised less than they have, in vain, or which have nothing.
  [[nodiscard]] std::vector<long> doubtful() const;
  // max |q(T) - target| of a flow of twice as many steps, in these units; infinite where it fails.
  // Where it is not `allowed` the extremal is made again with more steps. Safe for different points
  // at once.
  double verify(long i, const std::vector<double>& units, double allowed);

 private:
  struct Neighbour {
    long index = -1;
    std::vector<int> windings;  // of the target there, next to this one
    SmallVector dq;
  };
  // The neighbour along an axis, one step up or down; index -1 where there is none.
  [[nodiscard]] Neighbour neighbour(long i,
                                    const FieldPoint& point,
                                    std::size_t axis,
                                    int direction) const;
  [[nodiscard]] double promised(const FieldPoint& from, const SmallVector& dq) const;
  [[nodiscard]] double error_of(long i, const std::vector<double>& units, int factor) const;
  // A neighbour that was promised less, and how much.
  struct Push {
    Neighbour to;
    double promise = 0;
  };
  // Whether what `from` promises is worth trying.
  [[nodiscard]] bool tempts(const FieldPoint& from, const Push& push) const;
  // From `from` to a target at dq beside its own; p0 is empty where that is too far to try.
  [[nodiscard]] FieldAttempt attempt(const FieldPoint& from,
                                     std::vector<double> target,
                                     const SmallVector& dq) const;
  // By way of the point half-way.
  [[nodiscard]] bool reach_by_half(const FieldPoint& from,
                                   const Neighbour& to,
                                   FieldPoint& point,
                                   FieldCounts& counts) const;
  // What came of a push that was attempted directly, which may have failed.
  void take(const FieldPoint& from,
            const Push& push,
            const FieldAttempt& attempt,
            FieldCounts& counts);
  // Tells these neighbours what `from` promises them.
  void push(const FieldPoint& from, const std::vector<Neighbour>& neighbours, FieldCounts& counts);
  void push_all(long i, long first, long last, FieldCounts& counts);
  // One sweep over the layers first to last, forward or back. It ends early where `goes_on` says
  // so, which is asked before every layer.
  void sweep_slab(long first,
                  long last,
                  bool forward,
                  const std::function<bool()>& goes_on,
                  FieldCounts& counts);
  void cross(long layer, FieldCounts& counts);

  const BoundaryValueProblem& problem_;
  const FieldGrid& grid_;
  FieldNewton newton_;
  int n_;
  long layer_;  // points of a layer across the first axis
  long layers_;
  FieldStore points_;
  FieldCounts counts_;
};

}  // namespace carnot::internal
