#include "carnot/shooting/front/end_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {
namespace {

// Whole turns of the difference; infinite where there are none.
double period_of(const Dynamics& dynamics, const EndCondition& condition, bool mod_angles) {
  const auto period = [&](int j) { return dynamics.info.configuration[j].period; };
  const bool is_angle =
      mod_angles && period(condition.coordinate) > 0 &&
      (condition.equal < 0 || period(condition.equal) == period(condition.coordinate));
  return is_angle ? period(condition.coordinate) : std::numeric_limits<double>::infinity();
}

}  // namespace

EndSection::EndSection(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const UnitMomenta& momenta,
                       const EndCondition& condition,
                       double t,
                       bool mod_angles)
    : dynamics_(dynamics),
      from_(from),
      momenta_(momenta),
      condition_(condition),
      t_(t),
      period_(period_of(dynamics, condition, mod_angles)) {}

double EndSection::excess(const double* q) const {
  double excess = q[condition_.coordinate] - condition_.value;
  if (condition_.equal >= 0) excess -= q[condition_.equal];
  if (std::isfinite(period_)) excess -= period_ * std::round(excess / period_);
  return excess;
}

double EndSection::excess_at(const UnitMomentum& place, long& steps) const {
  const Ray ray(dynamics_, from_, momenta_.momentum(place));
  const Followed end = ray.follow(t_, steps);
  if (end.z.empty()) return std::numeric_limits<double>::quiet_NaN();
  steps = end.steps;
  return excess(end.z.data());
}

bool EndSection::settle(UnitMomentum& place) const {
  constexpr int kIterations = 12;
  constexpr double kFarthest = 0.3;   // no step is longer
  constexpr double kRoundOff = 1e-9;  // after a step below this the next one is round-off
  long steps = 0;
  for (int i = 0; i < kIterations; ++i) {
    const Ray ray(dynamics_, from_, momenta_.momentum(place));
    if (i == 0) steps = ray.enough_steps(t_);
    const auto end = ray.end(t_, steps);
    if (!end) return false;
    Eigen::RowVectorXd row = end->tangent.row(condition_.coordinate);
    if (condition_.equal >= 0) row -= end->tangent.row(condition_.equal);
    std::array<UnitMomentum, 3> ways;
    std::copy_n(momenta_.ways(place).begin(), 2, ways.begin());
    ways[2].w = Eigen::Vector2d::UnitY();
    Eigen::Vector3d gradient;
    for (int k = 0; k < 3; ++k) gradient[k] = row.dot(momenta_.tangent(place, ways[k]));
    Eigen::Vector3d step = -excess(end->z.data()) / gradient.squaredNorm() * gradient;
    if (!step.allFinite()) return false;
    const double length = step.norm();
    if (length > kFarthest) step *= kFarthest / length;
    for (int k = 0; k < 3; ++k) {
      place.c += step[k] * ways[k].c;
      place.w += step[k] * ways[k].w;
    }
    place.c.normalize();
    if (length < kRoundOff) return true;
  }
  return false;
}

}  // namespace carnot::internal
