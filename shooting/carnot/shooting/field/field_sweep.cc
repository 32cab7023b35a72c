#include "carnot/shooting/field/field_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/problem/ends.h"

namespace carnot::internal {
namespace {

constexpr double kBetter = 1e-10;  // relative; less is round-off

// Whether an extremal was found without a conjugate time on the way.
bool leads_on(const FieldPoint& from, const FieldAttempt& attempt) {
  return attempt.found && attempt.point.sign == from.sign;
}
}  // namespace

FieldCounts& FieldCounts::operator+=(const FieldCounts& other) {
  pushes += other.pushes;
  improved += other.improved;
  flows += other.flows;
  sweeps = std::max(sweeps, other.sweeps);
  return *this;
}

FieldSweep::FieldSweep(const BoundaryValueProblem& problem, const FieldGrid& grid)
    : problem_(problem),
      grid_(grid),
      newton_(problem),
      n_(problem.dynamics.dof),
      layers_(static_cast<long>(grid.axes.front().values.size())),
      points_(grid.size(), n_, grid.axes.size()) {
  layer_ = grid.size() / layers_;
}

std::vector<double> FieldSweep::target(long i, const std::vector<int>& windings) const {
  std::vector<double> q = grid_.target(i);
  for (std::size_t a = 0; a < windings.size(); ++a) {
    q[grid_.axes[a].coordinate] += windings[a] * grid_.axes[a].period;
  }
  return q;
}

bool FieldSweep::seed(long i,
                      const std::vector<double>& p0,
                      const std::vector<int>& windings,
                      int origin) {
  FieldPoint point;
  point.p0 = Eigen::Map<const Eigen::VectorXd>(p0.data(), n_);
  point.windings = windings;
  point.origin = origin;
  if (!newton_.solve(target(i, windings), point, counts_.flows)) return false;
  if (points_.known(i) && !(point.action < (1 - kBetter) * points_.action(i))) return false;
  points_.put(i, point);
  return true;
}

FieldSweep::Neighbour FieldSweep::neighbour(long i,
                                            const FieldPoint& point,
                                            std::size_t axis,
                                            int direction) const {
  const FieldGrid::Step step = grid_.step(i, axis, direction);
  if (step.index < 0) return {};
  Neighbour result{step.index, point.windings, SmallVector::Zero(n_)};
  result.windings[axis] += step.turns;
  result.dq[grid_.axes[axis].coordinate] = step.length;
  return result;
}

double FieldSweep::promised(const FieldPoint& from, const SmallVector& dq) const {
  return from.action + from.p1.dot(dq) + 0.5 * dq.dot(from.slope * dq);
}

bool FieldSweep::tempts(const FieldPoint& from, const Push& push) const {
  constexpr double kSameWay = 0.1;  // of the largest momentum
  const Neighbour& to = push.to;
  if (!points_.known(to.index)) return true;
  if (!(push.promise < (1 - kBetter) * points_.action(to.index))) return false;
  // What differs then is the error of the model, not the way.
  const SmallVector there = points_.p0(to.index);
  const SmallVector apart = from.p0 + from.inverse * to.dq - there;
  const bool near = apart.cwiseAbs().maxCoeff() < kSameWay * there.cwiseAbs().maxCoeff();
  return !near || to.windings != points_.windings(to.index);
}

FieldAttempt FieldSweep::attempt(const FieldPoint& from,
                                 std::vector<double> target,
                                 const SmallVector& dq) const {
  // Where J is nearly singular the step leads anywhere.
  constexpr double kFar = 4;  // of the momentum
  FieldAttempt attempt;
  attempt.target = std::move(target);
  attempt.inverse = from.inverse;
  const SmallVector step = from.inverse * dq;
  if (step.cwiseAbs().maxCoeff() < kFar * from.p0.cwiseAbs().maxCoeff()) {
    attempt.point.p0 = from.p0 + step;
  }
  return attempt;
}

bool FieldSweep::reach_by_half(const FieldPoint& from,
                               const Neighbour& to,
                               FieldPoint& point,
                               FieldCounts& counts) const {
  std::vector<double> end = target(to.index, to.windings);
  std::vector<double> middle = end;
  for (int j = 0; j < n_; ++j) middle[j] -= 0.5 * to.dq[j];
  const SmallVector step = 0.5 * to.dq;
  point = from;
  for (const std::vector<double>* next : {&middle, &end}) {
    FieldAttempt one = attempt(point, *next, step);
    if (one.point.p0.size() == 0) return false;
    newton_.solve({&one, 1}, counts.flows);
    if (!leads_on(from, one)) return false;
    point = one.point;
  }
  return true;
}

void FieldSweep::push(const FieldPoint& from,
                      const std::vector<Neighbour>& neighbours,
                      FieldCounts& counts) {
  std::vector<Push> near, far;
  std::vector<FieldAttempt> attempts;
  for (const Neighbour& to : neighbours) {
    const Push push{to, promised(from, to.dq)};
    if (!tempts(from, push)) continue;
    ++counts.pushes;
    FieldAttempt one = attempt(from, target(to.index, to.windings), to.dq);
    if (one.point.p0.size() == 0) {
      far.push_back(push);
    } else {
      near.push_back(push);
      attempts.push_back(std::move(one));
    }
  }
  newton_.solve(attempts, counts.flows);
  for (std::size_t i = 0; i < near.size(); ++i) take(from, near[i], attempts[i], counts);
  for (const Push& push : far) take(from, push, {}, counts);
}

void FieldSweep::take(const FieldPoint& from,
                      const Push& push,
                      const FieldAttempt& attempt,
                      FieldCounts& counts) {
  constexpr double kDoubt = 1e-6;  // relative; the model of a neighbour is not better than that
  const long i = push.to.index;
  FieldPoint point = attempt.point;
  if (!leads_on(from, attempt) && !reach_by_half(from, push.to, point, counts)) {
    if (push.promise < (1 - kDoubt) * points_.action(i)) points_.doubt(i);
    return;
  }
  if (points_.known(i) && !(point.action < (1 - kBetter) * points_.action(i))) return;
  ++counts.improved;
  point.windings = push.to.windings;
  point.origin = from.origin;
  points_.put(i, point);
}

void FieldSweep::push_all(long i, long first, long last, FieldCounts& counts) {
  if (!points_.has_news(i, 0)) return;
  const FieldPoint from = points_.point(i);
  std::vector<Neighbour> neighbours;
  for (std::size_t axis = 0; axis < grid_.axes.size(); ++axis) {
    for (const int direction : {-1, 1}) {
      Neighbour to = neighbour(i, from, axis, direction);
      if (to.index >= first && to.index < last) neighbours.push_back(std::move(to));
    }
  }
  push(from, neighbours, counts);
}

void FieldSweep::sweep_slab(long first,
                            long last,
                            bool forward,
                            const std::function<bool()>& goes_on,
                            FieldCounts& counts) {
  const long begin = first * layer_;
  const long end = last * layer_;
  for (long k = begin; k < end; ++k) {
    if (k % layer_ == 0 && !goes_on()) return;
    push_all(forward ? k : begin + end - 1 - k, begin, end, counts);
  }
}

void FieldSweep::cross(long layer, FieldCounts& counts) {
  // From `layer` to the next one, and back.
  for (const int direction : {1, -1}) {
    const long from = direction > 0 ? layer : (layer + 1) % layers_;
    for (long k = from * layer_; k < (from + 1) * layer_; ++k) {
      if (!points_.has_news(k, direction > 0 ? 1 : 2)) continue;
      const FieldPoint point = points_.point(k);
      const Neighbour to = neighbour(k, point, 0, direction);
      if (to.index >= 0) push(point, {to}, counts);
    }
  }
}

Spread FieldSweep::spread(int threads, const Progress& progress, int most_sweeps) {
  constexpr long kSlabs = 16;
  const long slabs = std::clamp(layers_ / 2, 1L, kSlabs);
  const auto begin = [&](long slab) { return slab * layers_ / slabs; };
  int quiet = 0;  // sweeps without an improvement
  double known = 0;
  const auto goes_on = [&] { return !progress || progress(known); };
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    std::vector<FieldCounts> counts(slabs);
    parallel_for(static_cast<int>(slabs), threads, [&](int slab) {
      sweep_slab(begin(slab), begin(slab + 1), sweep % 2 == 0, goes_on, counts[slab]);
    });
    if (!goes_on()) return Spread::kStopped;
    // Borders of every second pair of slabs, then the others; around, the last and the first.
    for (const long parity : {0L, 1L}) {
      parallel_for(static_cast<int>(slabs), threads, [&](int slab) {
        if (slab % 2 == parity && slab + 1 < slabs) cross(begin(slab + 1) - 1, counts[slab]);
      });
    }
    if (slabs > 1 || layers_ > 2) cross(layers_ - 1, counts[0]);
    long improved = 0;
    for (const FieldCounts& part : counts) {
      counts_ += part;
      improved += part.improved;
    }
    // Who improved was told to its neighbours in this sweep, or will be in the next one.
    quiet = improved == 0 ? quiet + 1 : 0;
    counts_.sweeps = std::max(counts_.sweeps, sweep + 1L);
    if (quiet == 2) return Spread::kSettled;
    long count = 0;
    for (long i = 0; i < points_.size(); ++i) count += points_.known(i) ? 1 : 0;
    known = static_cast<double>(count) / static_cast<double>(points_.size());
  }
  return Spread::kTired;
}

std::vector<long> FieldSweep::doubtful() const {
  std::vector<long> list;
  for (long i = 0; i < points_.size(); ++i) {
    if (!points_.known(i) || points_.doubted(i)) list.push_back(i);
  }
  return list;
}

double FieldSweep::error_of(long i, const std::vector<double>& units, int factor) const {
  const FieldPoint point = points_.point(i);
  const std::vector<double> end = newton_.end(point.p0, 2 * factor);
  if (end.empty()) return std::numeric_limits<double>::infinity();
  const std::vector<double> to = target(i, point.windings);
  double error = 0;
  for (int j = 0; j < n_; ++j) error = std::max(error, units[j] * std::abs(end[j] - to[j]));
  return error;
}

double FieldSweep::verify(long i, const std::vector<double>& units, double allowed) {
  constexpr int kMostSteps = 16;  // times those of the sweep
  double error = error_of(i, units, 1);
  long unused = 0;
  for (int factor = 2; factor <= kMostSteps && !(error <= allowed); factor *= 2) {
    FieldPoint point = points_.point(i);
    if (!newton_.solve(target(i, point.windings), point, unused, factor)) continue;
    if (point.sign != points_.sign(i)) break;
    points_.replace(i, point);
    error = error_of(i, units, factor);
  }
  return error;
}

}  // namespace carnot::internal
