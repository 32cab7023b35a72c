#include "carnot/shooting/problem/turn_rates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace carnot::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Rates {
 public:
  explicit Rates(const BoundaryValueProblem& problem)
      : problem_(problem),
        velocity_(problem.dynamics.dof),
        lambda_(problem.dynamics.multipliers),
        p_(problem.dynamics.dof) {
    for (int j = 0; j < problem.dynamics.dof; ++j) {
      (is_angle(j) ? angles_ : others_).push_back(j);
    }
  }

  [[nodiscard]] std::vector<double> find() {
    std::vector<double> rates(problem_.from.size(), kInfinity);
    if (!problem_.dynamics.has_transcription()) return rates;
    for (const int j : angles_) rates[j] = rate_of(j);
    return rates;
  }

 private:
  [[nodiscard]] double period_of(int j) const {
    return problem_.dynamics.info.configuration[j].period;
  }
  [[nodiscard]] bool is_angle(int j) const { return period_of(j) > 0; }

  // 2 H(q, e_j); infinite where it has none, or q a potential.
  double twice_h(const std::vector<double>& q, int j) {
    const Dynamics& dynamics = problem_.dynamics;
    const PointValues rest = dynamics.evaluate(0, q, p_, velocity_, lambda_);
    if (rest.status != RateStatus::kOk || rest.hamiltonian != 0) return kInfinity;
    p_[j] = 1;
    const PointValues moved = dynamics.evaluate(0, q, p_, velocity_, lambda_);
    p_[j] = 0;
    return moved.status == RateStatus::kOk ? 2 * moved.hamiltonian : kInfinity;
  }

  void draw(const std::vector<int>& coordinates, std::vector<double>& q) {
    constexpr double kRoom = 10;  // units, of coordinates without a period
    for (const int j : coordinates) {
      const double room = is_angle(j) ? period_of(j) : kRoom;
      q[j] = problem_.from[j] + std::uniform_real_distribution<double>(-room, room)(random_);
    }
  }

  // From the best of some configurations upwards, one angle after the other.
  double rate_of(int j) {
    // The last step, in periods. A smooth maximum is then missed by 1e-5 or so, far below the
    // margin.
    constexpr double kFinest = 1e-3;
    constexpr double kMargin = 1.01;
    constexpr int kConfigurations = 64;
    std::vector<double> best = problem_.from;
    double most = 0;
    for (int i = 0; i < kConfigurations; ++i) {
      std::vector<double> q = problem_.from;
      draw(angles_, q);
      const double value = twice_h(q, j);
      if (!depends_on_angles_only(q, j, value)) return kInfinity;
      if (value > most) best = q;
      most = std::max(most, value);
    }
    for (double step = 0.25; step > kFinest; step /= 2) {
      for (const int k : angles_) {
        for (const double to : {best[k] - step * period_of(k), best[k] + step * period_of(k)}) {
          std::vector<double> q = best;
          q[k] = to;
          const double value = twice_h(q, j);
          if (value > most) best = q;
          most = std::max(most, value);
        }
      }
    }
    return most > 0 ? kMargin * std::sqrt(most) : kInfinity;
  }

  bool depends_on_angles_only(std::vector<double> q, int j, double value) {
    constexpr double kRounding = 1e-12;
    draw(others_, q);
    return std::isfinite(value) && std::abs(twice_h(q, j) - value) <= kRounding * value;
  }

  const BoundaryValueProblem& problem_;
  std::vector<double> velocity_;
  std::vector<double> lambda_;
  std::vector<double> p_;
  std::vector<int> angles_;
  std::vector<int> others_;
  std::mt19937_64 random_;
};

}  // namespace

std::vector<double> turn_rates(const BoundaryValueProblem& problem) {
  return Rates(problem).find();
}

double least_length(const BoundaryValueProblem& problem, const std::vector<double>& rates) {
  double length = 0;
  for (std::size_t j = 0; j < rates.size(); ++j) {
    const int coordinate = static_cast<int>(j);
    if (problem.is_free_from(coordinate) || problem.is_free_to(coordinate)) continue;
    length = std::max(length, std::abs(problem.to[j] - problem.from[j]) / rates[j]);
  }
  return length;
}

}  // namespace carnot::internal
