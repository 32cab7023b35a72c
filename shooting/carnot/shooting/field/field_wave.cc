#include "carnot/shooting/field/field_wave.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace carnot::internal {
namespace {

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

FieldWave::FieldWave(const BoundaryValueProblem& problem,
                     const FieldGrid& grid,
                     FieldStore& points,
                     FieldCounts& counts)
    : grid_(grid), points_(points), counts_(counts), newton_(problem) {}

FieldWave::Push FieldWave::promised(const FieldPoint& from,
                                    long to,
                                    std::vector<int> windings,
                                    SmallVector dq) {
  // Of 46,656 vehicles 34 had more than their mirror image has without slack, 25 with this one and
  // 24 with twice as much, in the same time.
  constexpr double kSlack = 0.5;
  const double bending = 0.5 * dq.dot(from.slope * dq);
  const double promise = from.action + from.p1.dot(dq) + bending;
  return {from, to, std::move(windings), std::move(dq), promise, kSlack * std::abs(bending)};
}

void FieldWave::push(const FieldPoint& from, std::size_t axis, const FieldGrid::Step& step) {
  std::vector<int> windings = from.windings;
  windings[axis] += step.turns;
  SmallVector dq = SmallVector::Zero(from.p0.size());
  dq[grid_.axes[axis].coordinate] = step.length;
  add(promised(from, step.index, std::move(windings), std::move(dq)));
  // Two packs of ends. A field of 133,956 unicycles takes 91,374, 90,858 and 90,497 packs of
  // tangents with waves of 8, 16 and 32, which the points that they await cut short.
  constexpr std::size_t kFull = 16;
  if (wave_.size() == kFull) run();
}

bool FieldWave::awaits(long i) const {
  return std::any_of(wave_.begin(), wave_.end(), [i](const Push& push) { return push.to == i; });
}

void FieldWave::add(Push push) {
  if (tempts(push)) (awaits(push.to) ? after_ : wave_).push_back(std::move(push));
}

bool FieldWave::tempts(const Push& push) const {
  constexpr double kSameWay = 0.1;  // of the largest momentum
  if (!points_.known(push.to)) return true;
  if (!points_.is_more(push.to, push.promise - push.slack)) return false;
  // What differs then is the error of the model, not the way.
  const SmallVector there = points_.p0(push.to);
  const SmallVector apart = push.from.p0 + push.from.inverse * push.dq - there;
  const bool near = apart.cwiseAbs().maxCoeff() < kSameWay * there.cwiseAbs().maxCoeff();
  return !near || push.windings != points_.windings(push.to);
}

void FieldWave::run() {
  while (!wave_.empty()) {
    reach();
    wave_.clear();
    for (Push& push : std::exchange(after_, {})) add(std::move(push));
  }
}

void FieldWave::reach() {
  attempts_.clear();
  std::vector<const Push*> near;
  for (const Push& push : wave_) {
    ++counts_.pushes;
    FieldAttempt one = attempt(push.from, grid_.target(push.to, push.windings), push.dq);
    if (one.point.p0.size() == 0) {
      take(push, one);
    } else {
      near.push_back(&push);
      attempts_.push_back(std::move(one));
    }
  }
  newton_.solve(attempts_, FieldNewton::Care::kQuick, counts_.flows);
  for (std::size_t i = 0; i < near.size(); ++i) take(*near[i], attempts_[i]);
}

FieldAttempt FieldWave::attempt(const FieldPoint& from,
                                std::vector<double> target,
                                const SmallVector& dq) {
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

FieldWave::Parts FieldWave::reach_in_parts(const Push& push, FieldPoint& point) {
  using Care = FieldNewton::Care;
  constexpr double kLeast = 1.0 / 16;
  const std::vector<double> end = grid_.target(push.to, push.windings);
  point = push.from;
  double part = 0.5;
  for (double done = 0; done < 1;) {
    std::vector<double> next = end;
    for (Eigen::Index j = 0; j < push.dq.size(); ++j) next[j] -= (1 - done - part) * push.dq[j];
    FieldAttempt one = attempt(point, std::move(next), part * push.dq);
    const Care care = part > kLeast ? Care::kQuick : Care::kThorough;
    if (one.point.p0.size() > 0) newton_.solve({&one, 1}, care, counts_.flows);
    if (leads_on(push.from, one)) {
      point = one.point;
      done += part;
      part = std::min(2 * part, 1 - done);
      if (done < 1 && !tempts(promised(point, push.to, push.windings, (1 - done) * push.dq))) {
        return Parts::kNoLess;
      }
    } else if (part > kLeast) {
      part /= 2;
    } else {
      return Parts::kNowhere;
    }
  }
  return Parts::kThere;
}

void FieldWave::take(const Push& push, const FieldAttempt& attempt) {
  constexpr double kDoubt = 1e-6;  // relative; the model of a neighbour is not better than that
  FieldPoint point = attempt.point;
  const Parts parts = leads_on(push.from, attempt) ? Parts::kThere : reach_in_parts(push, point);
  if (parts == Parts::kNowhere && push.promise < (1 - kDoubt) * points_.action(push.to)) {
    points_.doubt(push.to);
  }
  if (parts != Parts::kThere) return;
  if (!points_.is_more(push.to, point.action)) return;
  ++counts_.improved;
  point.windings = push.windings;
  point.origin = push.from.origin;
  points_.put(push.to, point);
}

}  // namespace carnot::internal
