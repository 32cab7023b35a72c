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
// Errors below this are gone after one step of Newton's method more, since that squares them;
// verification measures what is left.
constexpr double kSquared = 1e-6;

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

long FieldSweep::steps_for(const SmallVector& p0) const {
  // Lengths of steps in radians. Fields of 133,956 unicycles and of 68,921 points of the Heisenberg
  // group took 18.5 and 8.8 s with 1, and 19.8 and 7.6 s with 1.5.
  constexpr double kStep = 1;
  constexpr long kLeast = 4;
  constexpr long kMost = 1024;
  std::vector<double> velocity(n_), lambda(problem_.dynamics.multipliers);
  const std::span<const double> p(p0.data(), static_cast<std::size_t>(n_));
  const double energy =
      problem_.dynamics.evaluate(0, problem_.from, p, velocity, lambda).hamiltonian;
  // Momenta of coordinates without mass turn the others.
  const double length =
      problem_.time * std::max(std::sqrt(2 * std::max(energy, 0.0)), p0.cwiseAbs().maxCoeff());
  return std::clamp(static_cast<long>(std::ceil(length / kStep)), kLeast, kMost);
}

void FieldSweep::approach(const SmallMatrix& inverse,
                          const std::vector<double>& target,
                          SmallVector& p0) const {
  constexpr int kMost = 4;
  constexpr double kFalls = 0.3;  // of the error in a step; else a Jacobian of its own pays
  std::vector<double> z(2 * problem_.from.size());
  SmallVector miss(n_);
  double last = std::numeric_limits<double>::infinity();
  SmallVector best = p0;
  for (int step = 0; step < kMost; ++step) {
    std::copy(problem_.from.begin(), problem_.from.end(), z.begin());
    std::copy_n(p0.data(), n_, z.begin() + n_);
    const StepPlan plan = StepPlan::equal(0, problem_.time, steps_for(p0));
    if (!problem_.dynamics.flow(plan, z).completed()) break;
    for (int r = 0; r < n_; ++r) miss[r] = z[r] - target[r];
    const double error = miss.cwiseAbs().maxCoeff();
    if (!(error < last)) break;
    best = p0;
    if (error <= kSquared || error > kFalls * last) break;
    last = error;
    const SmallVector correction = inverse * miss;
    if (!(correction.cwiseAbs().maxCoeff() < p0.cwiseAbs().maxCoeff())) break;
    p0 -= correction;
  }
  p0 = best;
}

bool FieldSweep::solve(const std::vector<double>& target,
                       FieldPoint& point,
                       FieldCounts& counts,
                       int factor) const {
  constexpr int kMost = 7;
  constexpr double kFalls = 0.5;
  const auto n = static_cast<std::size_t>(n_);
  std::vector<double> z(2 * n), m(4 * n * n);
  double last = std::numeric_limits<double>::infinity();
  const long steps = factor * steps_for(point.p0);
  SmallMatrix j(n_, n_), k(n_, n_);
  SmallVector miss(n_);
  for (int iteration = 0; iteration < kMost; ++iteration) {
    std::copy(problem_.from.begin(), problem_.from.end(), z.begin());
    std::copy_n(point.p0.data(), n, z.begin() + n_);
    ++counts.flows;
    if (!problem_.dynamics.tangent_flow(StepPlan::equal(0, problem_.time, steps), z, m)
             .completed()) {
      return false;
    }
    for (int r = 0; r < n_; ++r) {
      miss[r] = z[r] - target[r];
      for (int c = 0; c < n_; ++c) {
        j(r, c) = m[r * 2 * n_ + n_ + c];
        k(r, c) = m[(n_ + r) * 2 * n_ + n_ + c];
      }
    }
    const double error = miss.cwiseAbs().maxCoeff();
    if (!(error < last) && !(error <= kSquared)) return false;
    const SmallMatrix inverse = small_lu_inverse(j);
    if (!inverse.allFinite()) return false;
    point.p0 -= inverse * miss;
    if (error <= kSquared) {
      const Determinant determinant = determinant_of(j);
      point.sign = static_cast<std::int8_t>(determinant.sign);
      point.inverse = inverse;
      point.slope = k * inverse;
      point.p1.resize(n_);
      const SmallVector moved = k * (inverse * miss);
      for (int r = 0; r < n_; ++r) point.p1[r] = z[n_ + r] - moved[r];
      break;
    }
    if (iteration + 1 == kMost || (iteration > 1 && error > kFalls * last)) return false;
    last = error;
  }
  std::vector<double> velocity(n), lambda(problem_.dynamics.multipliers);
  const std::span<const double> p(point.p0.data(), n);
  point.action =
      problem_.time * problem_.dynamics.evaluate(0, problem_.from, p, velocity, lambda).hamiltonian;
  return std::isfinite(point.action);
}

bool FieldSweep::seed(long i,
                      const std::vector<double>& p0,
                      const std::vector<int>& windings,
                      int origin) {
  FieldPoint point;
  point.p0 = Eigen::Map<const Eigen::VectorXd>(p0.data(), n_);
  point.windings = windings;
  point.origin = origin;
  if (!solve(target(i, windings), point, counts_)) return false;
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

bool FieldSweep::reach(const FieldPoint& from,
                       const std::vector<double>& target,
                       const SmallVector& dq,
                       FieldPoint& point,
                       FieldCounts& counts) const {
  // Where J is nearly singular the step leads anywhere.
  constexpr double kFar = 4;  // of the momentum
  const SmallVector step = from.inverse * dq;
  if (!(step.cwiseAbs().maxCoeff() < kFar * from.p0.cwiseAbs().maxCoeff())) return false;
  point.p0 = from.p0 + step;
  approach(from.inverse, target, point.p0);
  return solve(target, point, counts) && point.sign == from.sign;
}

void FieldSweep::push(const FieldPoint& from, const Neighbour& to, FieldCounts& counts) {
  constexpr double kDoubt = 1e-6;   // relative; the model of a neighbour is not better than that
  constexpr double kSameWay = 0.1;  // of the largest momentum
  const double promise = promised(from, to.dq);
  const bool known = points_.known(to.index);
  const double action = points_.action(to.index);
  if (known) {
    if (!(promise < (1 - kBetter) * action)) return;
    // What differs then is the error of the model, not the way.
    const SmallVector there = points_.p0(to.index);
    const SmallVector apart = from.p0 + from.inverse * to.dq - there;
    const bool near = apart.cwiseAbs().maxCoeff() < kSameWay * there.cwiseAbs().maxCoeff();
    if (near && to.windings == points_.windings(to.index)) return;
  }
  ++counts.pushes;
  FieldPoint point;
  point.windings = to.windings;
  point.origin = from.origin;
  const std::vector<double> end = target(to.index, to.windings);
  bool reached = reach(from, end, to.dq, point, counts);
  if (!reached) {
    // By way of the point half-way.
    FieldPoint half;
    std::vector<double> middle = end;
    for (int j = 0; j < n_; ++j) middle[j] -= 0.5 * to.dq[j];
    const SmallVector step = 0.5 * to.dq;
    reached = reach(from, middle, step, half, counts) && reach(half, end, step, point, counts);
  }
  if (!reached) {
    if (promise < (1 - kDoubt) * action) points_.doubt(to.index);
    return;
  }
  if (known && !(point.action < (1 - kBetter) * action)) return;
  ++counts.improved;
  points_.put(to.index, point);
}

void FieldSweep::push_all(long i, long first, long last, FieldCounts& counts) {
  if (!points_.has_news(i, 0)) return;
  const FieldPoint from = points_.point(i);
  for (std::size_t axis = 0; axis < grid_.axes.size(); ++axis) {
    for (const int direction : {-1, 1}) {
      const Neighbour to = neighbour(i, from, axis, direction);
      if (to.index >= first && to.index < last) push(from, to, counts);
    }
  }
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
      if (to.index >= 0) push(point, to, counts);
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
  std::vector<double> z = problem_.from;
  z.insert(z.end(), point.p0.data(), point.p0.data() + n_);
  const StepPlan plan = StepPlan::equal(0, problem_.time, 2 * factor * steps_for(point.p0));
  if (!problem_.dynamics.flow(plan, z).completed()) return std::numeric_limits<double>::infinity();
  const std::vector<double> to = target(i, point.windings);
  double error = 0;
  for (int j = 0; j < n_; ++j) error = std::max(error, units[j] * std::abs(z[j] - to[j]));
  return error;
}

double FieldSweep::verify(long i, const std::vector<double>& units, double allowed) {
  constexpr int kMostSteps = 16;  // times those of the sweep
  double error = error_of(i, units, 1);
  FieldCounts unused;
  for (int factor = 2; factor <= kMostSteps && !(error <= allowed); factor *= 2) {
    FieldPoint point = points_.point(i);
    if (!solve(target(i, point.windings), point, unused, factor)) continue;
    if (point.sign != points_.sign(i)) break;
    points_.replace(i, point);
    error = error_of(i, units, factor);
  }
  return error;
}

}  // namespace carnot::internal
