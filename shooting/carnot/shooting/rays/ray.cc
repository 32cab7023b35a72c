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

// But for the round-off of a flow. Momenta may be much larger than coordinates.
bool same_numbers(const double* a, const double* b, int count) {
  double scale = 0;
  for (int j = 0; j < count; ++j) scale = std::max(scale, std::abs(b[j]));
  return largest_difference(a, b, count) <= kFlowRoundOff * scale;
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

long enough_steps(const Dynamics& dynamics, const std::vector<double>& z, double t, long fewest) {
  constexpr long kMost = 1L << 14;
  const int n = dynamics.dof;
  const auto end = [&](long steps) {
    std::vector<double> at = z;
    if (!dynamics.flow(StepPlan::equal(0, t, steps), at).completed()) at.clear();
    return at;
  };
  std::vector<double> coarse = end(fewest);
  for (long steps = fewest; steps < kMost; steps *= 2) {
    std::vector<double> fine = end(2 * steps);
    const bool both = !coarse.empty() && !fine.empty();
    if (both && same_numbers(coarse.data(), fine.data(), n) &&
        same_numbers(&coarse[n], &fine[n], n)) {
      return steps;
    }
    coarse = std::move(fine);
  }
  return kMost;
}

std::vector<double> Ray::start() const {
  std::vector<double> z = from_;
  z.insert(z.end(), p_.begin(), p_.end());
  return z;
}

std::vector<double> Ray::at(double t, long steps) const {
  std::vector<double> z = start();
  if (!dynamics_->flow(StepPlan::equal(0, t, steps), z).completed()) return {};
  return z;
}

std::optional<RayEnd> Ray::end(double t, long steps) const {
  const BoundaryValueProblem problem(*dynamics_, from_, from_, t);
  RayEnd end;
  auto tangent = end_point_tangent(problem, p_, t, steps, end.z);
  if (!tangent) return std::nullopt;
  end.tangent = std::move(*tangent);
  return end;
}

long Ray::enough_steps(double t) const {
  constexpr long kFewest = 8;
  return internal::enough_steps(*dynamics_, start(), t, kFewest);
}

BoundaryValueProblem Ray::problem(double t, long steps) const {
  std::vector<double> z = at(t, steps);
  z.resize(from_.size(), std::nan(""));
  return {*dynamics_, from_, z, t};
}

}  // namespace carnot::internal
