#include "carnot/shooting/field/field_grid.h"

#include <cmath>

namespace carnot::internal {

long FieldGrid::size() const {
  long size = 1;
  for (const Axis& axis : axes) size *= static_cast<long>(axis.values.size());
  return size;
}

Eigen::VectorXd FieldGrid::change(std::size_t axis, double length) const {
  Eigen::VectorXd dq = Eigen::VectorXd::Zero(static_cast<long>(to.size()));
  dq[axes[axis].coordinate] = length;
  for (const Follower& one : followers) dq[one.coordinate] += one.ratio * dq[one.leader];
  return dq;
}

std::vector<double> FieldGrid::target(long i) const { return target(i, {}); }

std::vector<double> FieldGrid::target(long i, const std::vector<int>& windings) const {
  std::vector<double> q = to;
  for (std::size_t a = axes.size(); a-- > 0;) {
    const auto count = static_cast<long>(axes[a].values.size());
    q[axes[a].coordinate] = axes[a].values[i % count];
    i /= count;
  }
  for (std::size_t a = 0; a < windings.size(); ++a) {
    q[axes[a].coordinate] += windings[a] * axes[a].period;
  }
  for (const Follower& one : followers) q[one.coordinate] += one.ratio * q[one.leader];
  return q;
}

FieldGrid::Step FieldGrid::step(long i, std::size_t axis, int direction) const {
  long stride = 1;
  for (std::size_t a = axes.size(); --a > axis;) stride *= static_cast<long>(axes[a].values.size());
  const Axis& along = axes[axis];
  const auto count = static_cast<long>(along.values.size());
  const long at = i / stride % count;
  long next = at + direction;
  int wraps = 0;
  if (next < 0 || next >= count) {
    if (!along.around || count < 3) return {};
    wraps = next < 0 ? -1 : 1;
    next -= wraps * count;
  }
  const int up = along.values.back() > along.values.front() ? 1 : -1;
  Step step;
  step.index = i + (next - at) * stride;
  step.turns = up * wraps;
  step.length = along.values[next] - along.values[at] + step.turns * along.period;
  return step;
}

FieldGrid::Image FieldGrid::image(long i,
                                  const std::vector<int>& windings,
                                  const std::vector<double>& mirror) const {
  constexpr double kSame = 1e-9;  // of a step
  std::vector<double> there = target(i, windings);
  for (std::size_t j = 0; j < there.size(); ++j) there[j] *= mirror[j];
  for (std::size_t k = followers.size(); k-- > 0;) {
    const auto& [coordinate, leader, ratio] = followers[k];
    there[coordinate] -= ratio * there[leader];
  }
  Image image{0, {}};
  std::vector<bool> has_axis(to.size(), false);
  for (const Axis& axis : axes) {
    const int j = axis.coordinate;
    has_axis[j] = true;
    const auto count = static_cast<long>(axis.values.size());
    const double step = count > 1 ? axis.values[1] - axis.values[0] : 1;
    // In steps from the first value, and then within the first period.
    const double steps = (there[j] - axis.values[0]) / step;
    const double period = axis.period / std::abs(step);
    double within = steps;
    if (period > 0) within -= period * std::floor((steps + kSame) / period);
    const double at = std::round(within);
    if (std::abs(within - at) > kSame || at < 0 || at >= static_cast<double>(count)) return {};
    image.index = image.index * count + static_cast<long>(at);
    const double turns = axis.period > 0 ? (steps - at) * step / axis.period : 0;
    image.windings.push_back(static_cast<int>(std::lround(turns)));
  }
  for (std::size_t j = 0; j < to.size(); ++j) {
    if (!has_axis[j] && there[j] != to[j]) return {};
  }
  return image;
}

}  // namespace carnot::internal
