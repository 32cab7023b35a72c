#include "carnot/shooting/problem/natural_scales.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "carnot/shooting/problem/reach.h"
#include "carnot/transcription/transcription_functions.h"

namespace carnot::internal {
namespace {

constexpr double kOne = 1e-12;  // a scale this close to one is one

double cleaned(double scale) {
  if (!(scale > 0) || !std::isfinite(scale) || std::abs(scale - 1) <= kOne) return 1;
  return scale;
}

// M and G of a problem with a transcription, and H_pp of its extremals.
class Metric {
 public:
  explicit Metric(const BoundaryValueProblem& problem)
      : problem_(problem),
        dynamics_(problem.dynamics),
        n_(dynamics_.dof),
        entries_(entry_count(*dynamics_.transcription)) {}

  [[nodiscard]] bool is_angle(int j) const { return dynamics_.info.configuration[j].period > 0; }
  // Whether M tells the size of coordinate j. With a gauge M is of admissible velocities only.
  [[nodiscard]] bool has_mass(int j) {
    return !dynamics_.transcription->gauge && mass(problem_.from, j) > 0;
  }
  [[nodiscard]] double mass(const std::vector<double>& q, int j) {
    dynamics_.transcription->entries(dynamics_.system.get(), q.data(), {}, false, entries_.data());
    return entries_[j * (j + 1) / 2 + j];
  }
  // The largest entries of the rows of G near the ends, with columns in units of u.
  std::vector<double> rows(const std::vector<double>& u) {
    const int k = dynamics_.transcribed;
    std::vector<double> largest(k, 0.0);
    for_points(u, [&](const std::vector<double>& q) {
      dynamics_.transcription->entries(
          dynamics_.system.get(), q.data(), {}, false, entries_.data());
      const double* const g = entries_.data() + n_ * (n_ + 1) / 2;
      for (int i = 0; i < k; ++i) {
        for (int j = 0; j < n_; ++j) {
          largest[i] = std::max(largest[i], u[j] * std::abs(g[i * n_ + j]));
        }
      }
    });
    return largest;
  }
  // The largest sqrt(H_pp) of each coordinate near the ends.
  std::vector<double> mobility(const std::vector<double>& u) {
    std::vector<double> largest(n_, 0.0);
    std::vector<double> p(n_, 0.0), velocity(n_), lambda(dynamics_.multipliers);
    for_points(u, [&](const std::vector<double>& q) {
      for (int j = 0; j < n_; ++j) {
        p[j] = 1;
        const bool good = dynamics_.evaluate(0, q, p, velocity, lambda).status == RateStatus::kOk;
        if (good && velocity[j] > largest[j]) largest[j] = velocity[j];
        p[j] = 0;
      }
    });
    for (double& x : largest) x = std::sqrt(x);
    return largest;
  }

 private:
  // Points within u of the straight line. Angles stand at all multiples of an eighth of a turn.
  void for_points(const std::vector<double>& u,
                  const std::function<void(const std::vector<double>&)>& visit) {
    constexpr int kPoints = 16;
    std::vector<double> q(n_);
    for (int i = 0; i < kPoints; ++i) {
      const double s = 0.5 * (i % 3);
      for (int j = 0; j < n_; ++j) {
        const double period = dynamics_.info.configuration[j].period;
        const double sign = (i >> (j % 4)) % 2 == 0 ? 1 : -1;
        q[j] = period > 0 ? period / 8 * ((i * (2 * j + 1)) % 8)
                          : (1 - s) * problem_.from[j] + s * problem_.to[j] + sign * u[j];
      }
      visit(q);
    }
  }

  const BoundaryValueProblem& problem_;
  const Dynamics& dynamics_;
  int n_;
  std::vector<double> entries_;
};

// u for a given s.
std::vector<double> sizes_for(Metric& metric,
                              const std::vector<bool>& by_mass,
                              const std::vector<double>& root_mass,
                              double s) {
  constexpr int kPasses = 3;  // a coordinate's size may depend on the sizes of others
  const int n = static_cast<int>(by_mass.size());
  std::vector<double> u(n, 0.0);
  bool all = true;
  for (int j = 0; j < n; ++j) {
    if (metric.is_angle(j)) {
      u[j] = 1;
    } else if (by_mass[j]) {
      u[j] = s / root_mass[j];
    } else {
      all = false;
    }
  }
  for (int pass = 0; pass < kPasses && !all; ++pass) {
    const std::vector<double> mobility = metric.mobility(u);
    for (int j = 0; j < n; ++j) {
      if (!metric.is_angle(j) && !by_mass[j]) u[j] = s * mobility[j];
    }
  }
  return u;
}

// s of angles without mass. What a radian of them is worth may depend on other coordinates: where
// the wheel of a bicycle is turned by 0.004 rad at the end, and straight at the start, its heading
// turns a hundred times as easily on the way. So it is looked at within u of the ends as well, and
// s is the least that agrees with its own u, but no more than the ends say; one where they say
// nothing. Without this 12 of 32 starts to such a target converge, with some seeds 1 of 972, and
// with it 20 of 24.
double worth_of_radian(Metric& metric,
                       const std::vector<bool>& by_mass,
                       const std::vector<double>& root_mass) {
  constexpr double kSame = 1e-9;
  constexpr int kHalvings = 40;
  constexpr int kBisections = 20;
  const int n = static_cast<int>(by_mass.size());
  const auto worth_near = [&](const std::vector<double>& u) {
    const std::vector<double> mobility = metric.mobility(u);
    double square = 0;
    int angles = 0;
    for (int j = 0; j < n; ++j) {
      if (!metric.is_angle(j) || !(mobility[j] > 0)) continue;
      square += 1 / (mobility[j] * mobility[j]);
      ++angles;
    }
    return angles > 0 ? std::sqrt(square / angles) : std::numeric_limits<double>::infinity();
  };
  const auto worth_within = [&](double s) {
    return worth_near(sizes_for(metric, by_mass, root_mass, s));
  };
  const double at_ends = worth_near(std::vector<double>(n, 0.0));
  if (!std::isfinite(at_ends)) return 1;
  if (std::abs(worth_within(at_ends) - at_ends) <= kSame * at_ends) return at_ends;
  double high = std::ldexp(at_ends, -kHalvings);
  while (high < at_ends && worth_within(high) > high) high *= 2;
  if (high >= at_ends) return at_ends;
  double low = high / 2;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = std::sqrt(low * high);
    (worth_within(middle) <= middle ? high : low) = middle;
  }
  return high;
}

// The largest |to - from| over u, of fixed coordinates. Infinite where such a u vanishes.
double apart(const BoundaryValueProblem& problem, const std::vector<double>& u) {
  double largest = 0;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (problem.is_free_from(j) || problem.is_free_to(j)) continue;
    const double moved = std::abs(problem.to[j] - problem.from[j]);
    if (moved > 0) largest = std::max(largest, moved / u[j]);
  }
  return largest;
}

// s such that the ends are kApart u apart. How far they are falls with s, by powers between 1 and
// the step of the structure: a few secants on logarithms find it.
double size_of_ends(const BoundaryValueProblem& problem,
                    const std::function<std::vector<double>(double)>& sizes) {
  // With 1/2, 1, 2 and 4 the median searches of five nilpotent scenes (carnot stress, 60 targets)
  // took 90, 84, 74 and 75 ms together.
  constexpr double kApart = 2;
  constexpr int kMost = 60;
  constexpr double kEnough = 1e-13;
  constexpr double kFarthest = 700;  // of logarithms that doubles have
  double x = 0;
  double slope = -1;
  double value = std::log(apart(problem, sizes(1)) / kApart);
  if (value == -std::numeric_limits<double>::infinity()) return 1;
  for (int i = 0; i < kMost && std::abs(value) > kEnough; ++i) {
    const double step = std::isfinite(value) ? std::clamp(-value / slope, -30.0, 30.0) : 30.0;
    if (!(std::abs(x + step) < kFarthest)) return 1;
    const double next = std::log(apart(problem, sizes(std::exp(x + step))) / kApart);
    if (std::isfinite(next) && std::isfinite(value) && next != value) {
      slope = std::clamp((next - value) / step, -8.0, -0.5);
    }
    x += step;
    value = next;
  }
  return std::exp(x);
}

void set_metric_scales(const BoundaryValueProblem& problem, NaturalScales& scales) {
  const Dynamics& dynamics = problem.dynamics;
  const int n = dynamics.dof;
  Metric metric(problem);
  std::vector<bool> by_mass(n);
  std::vector<double> root_mass(n, 0.0);
  double square = 0;
  int angles = 0;
  bool any_angle = false;
  for (int j = 0; j < n; ++j) {
    by_mass[j] = metric.has_mass(j);
    if (by_mass[j]) root_mass[j] = std::sqrt(metric.mass(problem.from, j));
    any_angle = any_angle || metric.is_angle(j);
    if (metric.is_angle(j) && by_mass[j]) {
      square += root_mass[j] * root_mass[j];
      ++angles;
    }
  }
  double s = 1;
  if (angles > 0) {
    s = std::sqrt(square / angles);
  } else if (any_angle) {
    s = worth_of_radian(metric, by_mass, root_mass);
  } else {
    by_mass.assign(n, false);
    s = size_of_ends(problem,
                     [&](double size) { return sizes_for(metric, by_mass, root_mass, size); });
  }
  scales.q = sizes_for(metric, by_mass, root_mass, s);
  for (double& u : scales.q) u = cleaned(u);
  scales.action = cleaned(s * s / problem.time);
  // Without lengths the rows are as their author wrote them; those of a gauge have no units.
  if (!dynamics.transcription->gauge &&
      std::any_of(scales.q.begin(), scales.q.end(), [](double u) { return u != 1; })) {
    scales.rows = metric.rows(scales.q);
    for (double& row : scales.rows) row = cleaned(row);
  }
}

void set_reach_scales(const BoundaryValueProblem& problem, NaturalScales& scales) {
  const int n = problem.dynamics.dof;
  const Reach reach = reach_of(problem);
  // The most that moving one coordinate alone takes. What controls hardly reach to first order, as
  // where they do by brackets only, says nothing, unless nothing else is asked to move.
  constexpr double kReached = 1e-5;
  const double largest = *std::max_element(reach.sizes.begin(), reach.sizes.end());
  std::vector<double> moved(n, 0.0);
  double reached = 0;
  double hardly = 0;
  for (int j = 0; j < n; ++j) {
    if (problem.is_free_from(j) || problem.is_free_to(j)) continue;
    moved[j] = std::abs(problem.to[j] - problem.from[j]);
    double& most = reach.sizes[j] > kReached * largest ? reached : hardly;
    most = std::max(most, moved[j] * moved[j] / (reach.sizes[j] * problem.time));
  }
  const double effort = reached > 0 ? reached : hardly;
  for (int j = 0; j < n; ++j) {
    if (problem.dynamics.info.configuration[j].period > 0) continue;
    double size = std::max(moved[j], std::sqrt(effort * reach.sizes[j] * problem.time));
    if (size == 0) size = std::max(std::abs(problem.from[j]), std::abs(problem.to[j]));
    scales.q[j] = cleaned(size);
  }
  scales.action = cleaned(effort);
}

}  // namespace

double NaturalScales::length() const { return std::sqrt(action * time); }

NaturalScales NaturalScales::inverse() const {
  NaturalScales back = *this;
  for (auto* units : {&back.q, &back.rows, &back.multipliers}) {
    for (double& unit : *units) unit = 1 / unit;
  }
  back.time = 1 / time;
  back.action = 1 / action;
  return back;
}

bool NaturalScales::trivial() const {
  const auto is_one = [](double scale) { return scale == 1; };
  return time == 1 && action == 1 && std::all_of(q.begin(), q.end(), is_one) &&
         std::all_of(rows.begin(), rows.end(), is_one);
}

NaturalScales natural_scales(const BoundaryValueProblem& problem) {
  const Dynamics& dynamics = problem.dynamics;
  NaturalScales scales;
  scales.q.assign(dynamics.dof, 1.0);
  scales.time = cleaned(problem.time);
  if (dynamics.has_holonomic()) {
    scales.action = cleaned(1 / problem.time);
  } else if (dynamics.has_transcription()) {
    set_metric_scales(problem, scales);
  } else {
    set_reach_scales(problem, scales);
  }
  if (scales.rows.empty()) scales.rows.assign(dynamics.transcribed, 1.0);
  // H has the terms lambda_i g_i, and a row g_i of the transcription is in units of rows_i / time.
  scales.multipliers.assign(dynamics.multipliers, scales.action);
  if (scales.rows.size() == scales.multipliers.size()) {
    for (std::size_t i = 0; i < scales.rows.size(); ++i) scales.multipliers[i] /= scales.rows[i];
  }
  return scales;
}

}  // namespace carnot::internal
