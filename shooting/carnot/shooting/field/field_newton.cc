#include "carnot/shooting/field/field_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/shooting/field/packed_tangents.h"

namespace carnot::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Errors below this are gone after one step of Newton's method more, since that squares them;
// verification measures what is left.
constexpr double kSquared = 1e-6;

double largest(const SmallVector& x) { return x.cwiseAbs().maxCoeff(); }

SmallVector miss_of(const double* q, const std::vector<double>& target) {
  SmallVector miss(target.size());
  for (Eigen::Index r = 0; r < miss.size(); ++r) miss[r] = q[r] - target[r];
  return miss;
}

// How much larger than in its steps an error of a flow can be at the end. Along a straight stretch
// of length L of a unicycle it grows like exp(L / beta).
double growth_of(const SmallMatrix& inverse) { return small_lu_inverse(inverse).norm(); }

// That of a flow whose end is to be known to about `end`, but no more than is usual.
double tolerance_for(double end, const SmallMatrix& inverse, double usual) {
  return std::max(kFineFlow, std::min(usual, end / growth_of(inverse)));
}

double coarse_tolerance(const SmallMatrix& inverse) {
  constexpr double kEnd = 1e-3;
  return tolerance_for(kEnd, inverse, kCoarseFlow);
}

}  // namespace

FieldNewton::FieldNewton(const BoundaryValueProblem& problem)
    : problem_(problem), n_(problem.dynamics.dof) {}

long FieldNewton::steps_for(const SmallVector& p0) const {
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

bool FieldNewton::flow(const SmallVector& p0, int factor, std::vector<double>& z) const {
  z = problem_.from;
  z.insert(z.end(), p0.data(), p0.data() + n_);
  const StepPlan plan = StepPlan::equal(0, problem_.time, factor * steps_for(p0));
  return problem_.dynamics.flow(plan, z).completed();
}

std::vector<double> FieldNewton::end(const SmallVector& p0, int factor) const {
  std::vector<double> z;
  if (!flow(p0, factor, z)) return {};
  z.resize(n_);
  return z;
}

void FieldNewton::solve(std::span<FieldAttempt> attempts, long& flows) const {
  if (has_packs(problem_.dynamics)) {
    solve_packed(attempts, flows);
    return;
  }
  for (FieldAttempt& attempt : attempts) {
    if (attempt.point.p0.size() == 0) continue;
    approach(attempt, attempt.point.p0);
    attempt.found = solve(attempt.target, attempt.point, flows);
  }
}

FieldNewton::Near FieldNewton::approach_packed(std::span<FieldAttempt> attempts) const {
  std::vector<std::size_t> tried;
  std::vector<SmallVector> p0;
  std::vector<double> tolerances;
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    if (attempts[i].point.p0.size() == 0) continue;
    tried.push_back(i);
    p0.push_back(attempts[i].point.p0);
    tolerances.push_back(coarse_tolerance(attempts[i].inverse));
  }
  const std::vector<PackedEnd> ends = packed_ends(problem_, p0, tolerances);
  Near near;
  for (std::size_t k = 0; k < tried.size(); ++k) {
    if (!ends[k].reached) continue;
    FieldAttempt& attempt = attempts[tried[k]];
    const SmallVector step = attempt.inverse * miss_of(ends[k].q1.data(), attempt.target);
    if (!(largest(step) < largest(attempt.point.p0))) continue;  // it leads anywhere
    attempt.point.p0 -= step;
    near.push_back(tried[k]);
  }
  return near;
}

void FieldNewton::solve_packed(std::span<FieldAttempt> attempts, long& flows) const {
  constexpr int kMost = 4;
  // Up to four steps, with Broyden's corrections of the inverse, save a sixth of the tangents.
  // Fields of 69,696 vehicles then take 1.1, of 133,956 unicycles 0.95 of the time: not worth it.
  Near open = approach_packed(attempts);
  std::vector<double> last(attempts.size(), kInfinity);
  std::vector<std::size_t> near;
  for (int step = 0; step < kMost && !open.empty(); ++step) {
    std::vector<SmallVector> p0;
    std::vector<SmallMatrix> bases;
    std::vector<double> tolerances;
    for (const std::size_t i : open) {
      p0.push_back(attempts[i].point.p0);
      bases.push_back(attempts[i].inverse);
      tolerances.push_back(coarse_tolerance(attempts[i].inverse));
    }
    flows += static_cast<long>(open.size());
    const std::vector<PackedTangent> tangents = packed_tangents(problem_, p0, bases, tolerances);
    std::vector<std::size_t> left;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const std::size_t i = open[k];
      const Step went = improve(tangents[k], attempts[i], last[i]);
      if (went == Step::kOn) left.push_back(i);
      if (went != Step::kNear) continue;
      if (attempts[i].rough) {
        attempts[i].found = set_action(attempts[i].point);
      } else {
        near.push_back(i);
      }
    }
    open = left;
  }
  std::vector<FieldAttempt> polished;
  polished.reserve(near.size());
  for (const std::size_t i : near) polished.push_back(std::move(attempts[i]));
  polish(polished);
  for (std::size_t k = 0; k < near.size(); ++k) attempts[near[k]] = std::move(polished[k]);
}

FieldNewton::Step FieldNewton::improve(const PackedTangent& tangent,
                                       FieldAttempt& attempt,
                                       double& last) const {
  constexpr double kFalls = 0.5;  // of the error in a step, from the second one on
  constexpr double kNear = 1e-3;
  if (!tangent.reached) return Step::kLost;
  const SmallVector miss = miss_of(tangent.q1.data(), attempt.target);
  const double error = largest(miss);
  const SmallMatrix inverse_along = small_lu_inverse(tangent.j);
  if (!(error < kFalls * last) || !inverse_along.allFinite()) return Step::kLost;
  last = error;
  attempt.inverse = tangent.d * inverse_along;
  attempt.point.p0 -= attempt.inverse * miss;
  if (error > kNear) return Step::kOn;
  const int sign = determinant_of(tangent.j).sign * determinant_of(tangent.d).sign;
  attempt.point.inverse = attempt.inverse;
  attempt.point.sign = static_cast<std::int8_t>(sign);
  attempt.point.slope = tangent.k * inverse_along;
  attempt.point.p1 = tangent.p1 - attempt.point.slope * miss;
  return Step::kNear;
}

void FieldNewton::polish(std::span<FieldAttempt> attempts) const {
  constexpr int kMost = 5;
  constexpr double kFalls = 0.1;
  constexpr double kThere = 1e-12;
  // After a step of Newton's method with coarse tangents a flow need not know more than this.
  constexpr double kFirstFlow = 1e-9;
  constexpr double kFirstEnd = 1e-7;
  constexpr double kSteps = 100;  // whose errors add up
  std::vector<double> last(attempts.size(), kInfinity);
  std::vector<std::size_t> open(attempts.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  for (int step = 0; step < kMost && !open.empty(); ++step) {
    std::vector<SmallVector> some;
    std::vector<double> tolerances;
    for (const std::size_t i : open) {
      const FieldPoint& point = attempts[i].point;
      some.push_back(point.p0);
      tolerances.push_back(step == 0 ? tolerance_for(kFirstEnd, point.inverse, kFirstFlow)
                                     : kFineFlow);
    }
    const std::vector<PackedEnd> ends = packed_ends(problem_, some, tolerances);
    std::vector<std::size_t> left;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (!ends[k].reached) continue;
      const std::size_t i = open[k];
      FieldPoint& point = attempts[i].point;
      const SmallVector miss = miss_of(ends[k].q1.data(), attempts[i].target);
      const double error = largest(miss);
      const double falls = error / last[i];
      const bool there = error < kSteps * kFineFlow * growth_of(point.inverse);
      if (!there && (!(error < last[i]) || falls > kFalls)) continue;
      last[i] = error;
      point.p0 -= point.inverse * miss;
      if (step == 0 || (!there && error * falls > kThere)) {
        left.push_back(i);
      } else {
        point.p1 = ends[k].p1 - point.slope * miss;
        attempts[i].found = set_action(point);
      }
    }
    open = left;
  }
}

void FieldNewton::approach(const FieldAttempt& attempt, SmallVector& p0) const {
  constexpr int kMost = 4;
  constexpr double kFalls = 0.3;  // of the error in a step; else a Jacobian of its own pays
  std::vector<double> z;
  double last = kInfinity;
  SmallVector best = p0;
  for (int step = 0; step < kMost; ++step) {
    if (!flow(p0, 1, z)) break;
    const SmallVector miss = miss_of(z.data(), attempt.target);
    const double error = largest(miss);
    if (!(error < last)) break;
    best = p0;
    if (error <= kSquared || error > kFalls * last) break;
    last = error;
    const SmallVector correction = attempt.inverse * miss;
    if (!(largest(correction) < largest(p0))) break;
    p0 -= correction;
  }
  p0 = best;
}

bool FieldNewton::solve(const std::vector<double>& target,
                        FieldPoint& point,
                        long& flows,
                        int factor) const {
  constexpr int kMost = 7;
  constexpr double kFalls = 0.5;
  const auto n = static_cast<std::size_t>(n_);
  std::vector<double> z(2 * n), m(4 * n * n);
  double last = kInfinity;
  const long steps = factor * steps_for(point.p0);
  SmallMatrix j(n_, n_), k(n_, n_);
  SmallVector miss(n_);
  for (int iteration = 0; iteration < kMost; ++iteration) {
    std::copy(problem_.from.begin(), problem_.from.end(), z.begin());
    std::copy_n(point.p0.data(), n, z.begin() + n_);
    ++flows;
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
  return set_action(point);
}

bool FieldNewton::set_action(FieldPoint& point) const {
  std::vector<double> velocity(n_), lambda(problem_.dynamics.multipliers);
  const std::span<const double> p(point.p0.data(), static_cast<std::size_t>(n_));
  point.action =
      problem_.time * problem_.dynamics.evaluate(0, problem_.from, p, velocity, lambda).hamiltonian;
  return std::isfinite(point.action);
}

}  // namespace carnot::internal
