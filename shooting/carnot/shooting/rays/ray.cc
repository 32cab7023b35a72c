#include "carnot/shooting/rays/ray.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/shoot/end_point.h"

namespace carnot::internal {
namespace {

// Whether H is quadratic in p at q: then speeds scale, and every time may be that of unit speed.
bool is_quadratic(const Dynamics& dynamics,
                  const std::vector<double>& q,
                  const std::vector<double>& p) {
  constexpr double kRounding = 1e-10;
  const auto energy = [&](double factor) {
    std::vector<double> z = q;
    for (const double x : p) z.push_back(factor * x);
    return motion_at(dynamics, z.data()).hamiltonian;
  };
  const double one = energy(1);
  return energy(0) == 0 && std::abs(energy(2) - 4 * one) <= kRounding * std::abs(one) &&
         std::abs(energy(-1) - one) <= kRounding * std::abs(one);
}

// The difference of n coordinates or momenta, relative to the largest one.
double relative_difference(const double* a, const double* b, int n) {
  double scale = 0;
  for (int j = 0; j < n; ++j) scale = std::max(scale, std::abs(b[j]));
  const double difference = largest_difference(a, b, n);
  return difference > 0 ? difference / scale : 0;
}

// Of phase points, whose momenta may be much larger than their coordinates.
double difference_of(const std::vector<double>& a, const std::vector<double>& b, int n) {
  return std::max(relative_difference(a.data(), b.data(), n), relative_difference(&a[n], &b[n], n));
}

// Where the flow leads in these steps; empty where it fails.
std::vector<double> led(const Dynamics& dynamics, std::vector<double> z, double t, long steps) {
  if (!dynamics.flow(StepPlan::equal(0, t, steps), z).completed()) z.clear();
  return z;
}

// Of the flow that tells whether so many steps are enough.
long fewer_steps(long steps) { return steps == 1 ? 2 : steps / 2; }

// How many steps are wanted after two flows, of which `end` is that of `steps`.
long told_steps(const Dynamics& dynamics,
                const std::vector<double>& other,
                long others,
                const std::vector<double>& end,
                long steps) {
  // What is left is so little of kFlowRoundOff, 1e-16. Beside an abnormal extremal it grows on: on
  // the flat Martinet problem by 1e12 until extremals are conjugate, and their times are good to
  // 1e-9 with this share, to 1.5e-8 with four times as much, and to 2e-7 with 64 times.
  constexpr int kShare = 10;  // a power of two
  if (other.empty()) return 2 * steps;
  const int order = dynamics.order;
  const double ratio = static_cast<double>(steps) / static_cast<double>(others);
  const double allowed = kFlowRoundOff * std::max(1.0, std::ldexp(std::pow(ratio, order), -kShare));
  const double by = difference_of(other, end, dynamics.dof) / allowed;
  if (by <= 1) return steps;
  const double more = std::ceil(static_cast<double>(steps) * std::pow(by, 1.0 / order));
  return more < 2 * static_cast<double>(steps) ? static_cast<long>(more) : 2 * steps;
}

void check(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

}  // namespace

Motion motion_at(const Dynamics& dynamics, const double* z) {
  const int n = dynamics.dof;
  Motion motion;
  motion.velocity.resize(n);
  std::vector<double> lambda(dynamics.multipliers);
  const std::span<const double> q(z, n);
  const std::span<const double> p(z + n, n);
  const std::span<double> velocity(motion.velocity.data(), n);
  const PointValues values = dynamics.evaluate(0, q, p, velocity, lambda);
  motion.hamiltonian = values.status == RateStatus::kOk ? values.hamiltonian : std::nan("");
  return motion;
}

double speed_of(const Dynamics& dynamics,
                const std::vector<double>& from,
                const std::vector<double>& p) {
  std::vector<double> z = from;
  z.insert(z.end(), p.begin(), p.end());
  return std::sqrt(2 * motion_at(dynamics, z.data()).hamiltonian);
}

double validated_speed(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const std::vector<double>& p) {
  const auto n = static_cast<std::size_t>(dynamics.dof);
  check(from.size() == n && p.size() == n, "from and p0 need one number for each coordinate");
  for (std::size_t j = 0; j < n; ++j) {
    check(std::isfinite(from[j]) && std::isfinite(p[j]), "from and p0 must be finite");
  }
  check(end_status(dynamics, from) == RateStatus::kOk, "the constraints are dependent at from");
  check(dynamics.autonomous && (dynamics.has_transcription() || dynamics.on_leaves) &&
            is_quadratic(dynamics, from, p),
        "fronts and cut times are of scenes with velocity constraints or driftless controls, and "
        "without a potential");
  const double speed = speed_of(dynamics, from, p);
  check(speed > 0 && std::isfinite(speed), "p0 moves nothing: its velocity is zero");
  return speed;
}

long wanted_steps(const Dynamics& dynamics,
                  const std::vector<double>& z,
                  double t,
                  long steps,
                  const std::vector<double>& end) {
  if (end.empty()) return 2 * steps;
  const long others = fewer_steps(steps);
  return told_steps(dynamics, led(dynamics, z, t, others), others, end, steps);
}

Followed follow(const Dynamics& dynamics, const std::vector<double>& z, double t, long fewest) {
  std::vector<double> other;  // of the steps before
  long others = 0;
  for (long steps = std::min(fewest, kMostSteps);; steps = std::min(steps, kMostSteps)) {
    std::vector<double> end = led(dynamics, z, t, steps);
    if (steps == kMostSteps) return {steps, std::move(end)};
    long wanted = 2 * steps;
    if (!end.empty()) {
      if (others != fewer_steps(steps)) {
        others = fewer_steps(steps);
        other = led(dynamics, z, t, others);
      }
      wanted = told_steps(dynamics, other, others, end, steps);
    }
    if (wanted == steps) return {steps, std::move(end)};
    other = std::move(end);
    others = std::exchange(steps, wanted);
  }
}

std::vector<double> Ray::start() const {
  std::vector<double> z = from_;
  z.insert(z.end(), p_.begin(), p_.end());
  return z;
}

std::vector<double> Ray::at(double t, long steps) const {
  return led(*dynamics_, start(), t, steps);
}

std::optional<RayEnd> Ray::end(double t, long steps) const {
  const BoundaryValueProblem problem(*dynamics_, from_, from_, t);
  RayEnd end;
  auto tangent = end_point_tangent(problem, p_, t, steps, end.z);
  if (!tangent) return std::nullopt;
  end.tangent = std::move(*tangent);
  return end;
}

Followed Ray::follow(double t, long fewest) const {
  return internal::follow(*dynamics_, start(), t, fewest);
}

BoundaryValueProblem Ray::problem(double t, long steps) const {
  std::vector<double> z = at(t, steps);
  z.resize(from_.size(), std::nan(""));
  return {*dynamics_, from_, z, t};
}

}  // namespace carnot::internal
