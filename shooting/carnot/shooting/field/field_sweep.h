// The least actions from one start to all points of a grid, spread from neighbour to neighbour.
//
// A point keeps one extremal, or a few: p(0), the action A, p(T), the inverse of J = dq(T)/dp(0),
// and S = (dp(T)/dp(0)) J^-1 of each. The latter is the second derivative of the action by its
// target, p(T) being the first. So for a neighbour at dq it says
//
//   p(0) + J^-1 dq     and     A + p(T).dq + dq'S dq / 2.
//
// Where that is less than the neighbour has, or it has room for one more, Newton's method on the
// end point makes an extremal of it (field_wave.h). Points tell their neighbours in the order of
// their actions, as in Dijkstra's algorithm, so that most are reached by their least way first; but
// many at once, and until nothing changes, since the model is not exact.
//
// The grid is cut into slabs across its first axis, which do not depend on the number of threads or
// processes. In each sweep all slabs, one on each thread, tell within themselves what has up to a
// level of action, then across borders: every second one, then the others. So the result does not
// depend on who does it either. The level rises when nothing below it is left. A slab is always
// swept by the same process, and the others are given what has changed after each of these steps.
#pragma once

#include <functional>
#include <queue>
#include <span>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_newton.h"
#include "carnot/shooting/field/field_partners.h"
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

  // Of a scene without drift or potential, whose action is H T, with so many extremals for each
  // point. Keeps references.
  FieldSweep(const BoundaryValueProblem& problem,
             const FieldGrid& grid,
             int branches,
             FieldPartners& partners);

  [[nodiscard]] const FieldStore& points() const { return points_; }
  [[nodiscard]] const FieldCounts& counts() const { return counts_; }
  [[nodiscard]] std::vector<double> target(long i, const std::vector<int>& windings) const {
    return grid_.target(i, windings);
  }
  // Takes an extremal to point i that was found otherwise, where it is wanted. False where it does
  // not lead there, or is not.
  bool seed(long i, const std::vector<double>& p0, const std::vector<int>& windings, int origin) {
    return seed(i, p0, windings, origin, counts_.flows);
  }
  // Sweeps until nothing changes, at most so often. `progress` is told by all threads, the fraction
  // that was known after the last sweep; where it returns false, the partners stop. `between` is
  // called between sweeps.
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
  // max |q(T) - target| in these units, of the least action of points that are known, by flows with
  // less tolerance, or twice as many steps, than those that made them; infinite where that fails.
  // Where it is not `allowed` the extremal is made again. Safe for different points at once.
  std::vector<double> verify(std::span<const long> points,
                             const std::vector<double>& units,
                             double allowed);
  // What has changed so far is known to the partners: all have done the same.
  void forget_changes() { points_.forget_changes(); }
  // Gives the partners what has changed here since then, and takes what has there.
  void share();

  // All that is known, between two sweeps or two spreads.
  void write(ByteWriter& out) const;
  // What the same sweep has written. Throws DamagedBytes.
  void read(ByteReader& in);

 private:
  // Of a spread.
  struct Course {
    long sweeps = 0;   // so far
    double level = 0;  // of the action up to which neighbours are told
  };
  // A slot that has news. It is out of date where the slot has less, or has told it, since.
  struct News {
    double action = 0;
    FieldSlot slot{-1};
    bool operator>(const News& other) const {
      return action != other.action ? action > other.action : slot > other.slot;
    }
  };
  // The least action first.
  using Queue = std::priority_queue<News, std::vector<News>, std::greater<>>;
  bool seed(long i,
            const std::vector<double>& p0,
            const std::vector<int>& windings,
            int origin,
            long& flows);
  // Takes the image of point `from` in a mirror to where it is, as seed() would.
  bool reflect(long from, const std::vector<double>& mirror, long& flows);
  // Of an end of an extremal.
  [[nodiscard]] double error_of(FieldSlot slot,
                                const SmallVector& end,
                                const std::vector<double>& units) const;
  // By flows of packs.
  [[nodiscard]] std::vector<double> packed_errors(std::span<const long> points,
                                                  const std::vector<double>& units) const;
  // By a flow of twice as many steps as a sweep takes, or more.
  double verify_by_steps(long i, const std::vector<double>& units, double allowed);
  [[nodiscard]] long begin_of(long slab) const { return slab * layers_ / slabs_; }  // a layer
  // Layers below a border between slabs. The last one is the last of all, which is below the first
  // one where the axis goes around.
  [[nodiscard]] std::vector<long> borders() const;
  // Calls visit(slot) for all slots of a layer.
  template <class Visit>
  void for_layer(long layer, const Visit& visit) const {
    for (long i = layer * layer_; i < (layer + 1) * layer_; ++i) {
      for (int b = 0; b < points_.branches(); ++b) visit(points_.slot(i, b));
    }
  }
  [[nodiscard]] long slab_of(FieldSlot slot) const;
  // Fills the queues of own slabs with all slots that have news for their slab.
  void gather();
  // The least action of what is still to be told, by any of the partners; infinite where there is
  // nothing.
  [[nodiscard]] double least_news();
  // Once, all slabs and all borders. Returns what all partners did; nothing where they stop.
  FieldCounts sweep(int threads, const std::function<bool()>& goes_on);
  // Tells the neighbours within a slab what an extremal promises them.
  void push_all(FieldSlot slot, long slab, FieldWave& wave);
  // Tells all within a slab up to the level. It ends early where `goes_on` says so, which is asked
  // before every wave.
  void sweep_slab(long slab, const std::function<bool()>& goes_on, FieldCounts& counts);
  // Tells points across the border above a layer, up and down.
  void cross(long layer, FieldCounts& counts);
  // Where its slab is an own one.
  void queue(FieldSlot slot);

  const BoundaryValueProblem& problem_;
  const FieldGrid& grid_;
  FieldPartners& partners_;
  FieldNewton newton_;
  int n_;
  long layer_;  // points of a layer across the first axis
  long layers_;
  long slabs_;
  FieldStore points_;
  FieldCounts counts_;
  Course course_;
  std::vector<Queue> queues_;  // of slabs
};

}  // namespace carnot::internal
