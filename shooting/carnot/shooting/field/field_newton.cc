#include "carnot/shooting/field/field_newton.h"

#include <algorithm>
#include <array>
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

void FieldNewton::solve(std::span<FieldAttempt> attempts, Care care, long& flows) const {
  const bool packed = tangents_of_a_pack(problem_.dynamics) > 0;
  if (packed) solve_packed(attempts, flows);
  if (packed && care == Care::kQuick) return;
  for (FieldAttempt& attempt : attempts) {
    if (attempt.found) continue;
    approach(attempt, attempt.point.p0);
    attempt.found = solve(attempt.target, attempt.point, flows);
  }
}

void FieldNewton::approach_packed(std::span<const FieldAttempt> attempts,
                                  std::span<SmallVector> p0) const {
  const auto together = static_cast<std::size_t>(ends_of_a_pack(problem_.dynamics));
  std::vector<SmallVector> ends(together);
  for (std::size_t i = 0; i < p0.size(); i += together) {
    const auto some = p0.subspan(i, std::min(together, p0.size() - i));
    if (!packed_ends(problem_, some, ends)) continue;
    for (std::size_t k = 0; k < some.size(); ++k) {
      const FieldAttempt& attempt = attempts[i + k];
      const SmallVector correction = attempt.inverse * miss_of(ends[k].data(), attempt.target);
      if (largest(correction) < largest(some[k])) some[k] -= correction;
    }
  }
}

void FieldNewton::solve_packed(std::span<FieldAttempt> attempts, long& flows) const {
  constexpr int kMost = 4;
  const auto together = static_cast<std::size_t>(tangents_of_a_pack(problem_.dynamics));
  std::vector<SmallVector> p0;
  for (const FieldAttempt& attempt : attempts) p0.push_back(attempt.point.p0);
  // Fields of 133,956 unicycles take 283,064 tangents without this, 178,178 with it, and 163,222
  // where it is done twice, which costs what it saves.
  approach_packed(attempts, p0);
  std::vector<double> last(attempts.size(), kInfinity);
  std::vector<std::size_t> open(attempts.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  std::vector<SmallVector> some;
  std::vector<PackedTangent> tangents(together);
  for (int step = 0; step < kMost && !open.empty(); ++step) {
    std::vector<std::size_t> left;
    for (std::size_t first = 0; first < open.size(); first += together) {
      const std::size_t count = std::min(together, open.size() - first);
      some.clear();
      for (std::size_t k = 0; k < count; ++k) some.push_back(p0[open[first + k]]);
      flows += static_cast<long>(count);
      if (!packed_tangents(problem_, some, tangents)) continue;
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = open[first + k];
        if (improve(tangents[k], attempts[i], p0[i], last[i])) left.push_back(i);
      }
    }
    open = left;
  }
}

bool FieldNewton::improve(const PackedTangent& tangent,
                          FieldAttempt& attempt,
                          SmallVector& p0,
                          double& last) const {
  constexpr double kFalls = 0.5;  // of the error in a step, from the second one on
  constexpr double kNear = 1e-3;
  const SmallVector miss = miss_of(tangent.q1.data(), attempt.target);
  const double error = largest(miss);
  const SmallMatrix inverse = small_lu_inverse(tangent.j);
  if (!(error < kFalls * last) || !inverse.allFinite()) return false;
  last = error;
  p0 -= inverse * miss;
  if (error > kNear) return true;
  FieldPoint point;
  point.p0 = p0;
  point.inverse = inverse;
  if (!polish(attempt.target, error, point)) return false;
  point.sign = static_cast<std::int8_t>(determinant_of(tangent.j).sign);
  point.slope = tangent.k * inverse;
  point.windings = attempt.point.windings;
  point.origin = attempt.point.origin;
  attempt.point = point;
  attempt.found = true;
  return false;
}

bool FieldNewton::polish(const std::vector<double>& target, double near, FieldPoint& point) const {
  constexpr int kMost = 5;
  constexpr double kFalls = 0.1;
  constexpr double kThere = 1e-12;
  // The Jacobian is that of an end so far away, and of differences.
  constexpr double kCoarse = 1e-4;
  std::vector<double> z;
  double last = kInfinity;
  for (int step = 0; step < kMost; ++step) {
    if (!flow(point.p0, 1, z)) return false;
    const SmallVector miss = miss_of(z.data(), target);
    const double error = largest(miss);
    const double falls = step > 0 ? error / last : std::max(near, kCoarse);
    if (!(error < last) || falls > kFalls) return false;
    last = error;
    point.p0 -= point.inverse * miss;
    if (error * falls > kThere) continue;
    point.p1 = Eigen::Map<const Eigen::VectorXd>(z.data() + n_, n_);
    return set_action(point);
  }
  return false;
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
