#include "carnot/shooting/steer/steering_question.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/extremal/symmetry.h"
#include "carnot/shooting/linear/round_off.h"

namespace carnot::internal {
namespace {

// The angle that the frame of `origin` is turned by.
double turn_of(const Symmetries& symmetries, const double* origin) {
  return symmetries.angles.empty() ? 0 : origin[symmetries.angles.front()];
}

void enter_frame(const SceneInfo& info, const double* origin, double* q) {
  const Symmetries& symmetries = info.symmetries;
  const double turn = turn_of(symmetries, origin);
  for (const int j : {symmetries.x, symmetries.y}) {
    if (j >= 0) q[j] -= origin[j];
  }
  turn_plane(symmetries, -turn, q);
  for (const int j : symmetries.angles) q[j] -= turn;
}

// A difference of coordinate j, less whole periods.
double wrapped(const SceneInfo& info, const SteeringRules& rules, std::size_t j, double apart) {
  const double period = rules.mod_angles ? info.configuration[j].period : 0;
  return period > 0 ? apart - period * std::round(apart / period) : apart;
}

// |to - from| over the sizes of the coordinates; 0 where it is round-off of them.
double distance_apart(const SceneInfo& info,
                      const SteeringRules& rules,
                      std::span<const double> from,
                      std::span<const double> to) {
  double sum = 0;
  bool apart = false;
  for (std::size_t j = 0; j < from.size(); ++j) {
    if (rules.is_free(j)) continue;
    const double step = std::abs(wrapped(info, rules, j, to[j] - from[j]));
    apart = apart || step > kSameCoordinate * (std::abs(from[j]) + std::abs(to[j]));
    sum = std::hypot(sum, step / rules.size(j));
  }
  return apart ? sum : 0;
}

}  // namespace

void SteeringQuestion::ask(const SceneInfo& info,
                           const SteeringRules& rules,
                           std::span<const double> from,
                           std::span<const double> to) {
  const std::size_t n = from.size();
  const double apart = distance_apart(info, rules, from, to);
  double& contraction = sense.contraction;
  contraction = apart < rules.resolution ? apart / rules.resolution : 1;
  if (apart == 0) contraction = 0;
  // Both ways, one after the other.
  ends.resize(4 * n);
  for (const bool backwards : {false, true}) {
    const std::span<const double> origin = backwards ? to : from;
    const std::span<const double> other = backwards ? from : to;
    double* const start = ends.data() + (backwards ? 2 * n : 0);
    double* const target = start + n;
    std::copy(origin.begin(), origin.end(), start);
    enter_frame(info, origin.data(), start);
    std::copy(other.begin(), other.end(), target);
    enter_frame(info, origin.data(), target);
    for (std::size_t j = 0; j < n && contraction < 1; ++j) {
      const double step = wrapped(info, rules, j, target[j] - start[j]);
      target[j] = contraction > 0 ? start[j] + step / contraction : start[j];
    }
    for (std::size_t j = 0; j < n; ++j) {
      if (rules.is_free(j)) target[j] = start[j];
    }
    for (double* x = start; x != target + n; ++x) *x += 0.0;  // -0 becomes 0
  }
  const auto middle = ends.begin() + 2 * static_cast<std::ptrdiff_t>(n);
  sense.reversed =
      rules.reversible && std::lexicographical_compare(middle, ends.end(), ends.begin(), middle);
  if (sense.reversed) std::copy(middle, ends.end(), ends.begin());
  ends.resize(2 * n);
}

void leave_frame(const SceneInfo& info, const double* origin, double* q) {
  const Symmetries& symmetries = info.symmetries;
  const double turn = turn_of(symmetries, origin);
  turn_plane(symmetries, turn, q);
  for (const int j : {symmetries.x, symmetries.y}) {
    if (j >= 0) q[j] += origin[j];
  }
  for (const int j : symmetries.angles) q[j] += turn;
}

}  // namespace carnot::internal
