#include "carnot/shooting/field/field_grid.h"

#include <cmath>

namespace carnot::internal {

long FieldGrid::size() const {
  long size = 1;
  for (const Axis& axis : axes) size *= static_cast<long>(axis.values.size());
  return size;
}

std::vector<double> FieldGrid::target(long i) const {
  std::vector<double> q = to;
  for (std::size_t a = axes.size(); a-- > 0;) {
    const auto count = static_cast<long>(axes[a].values.size());
    q[axes[a].coordinate] = axes[a].values[i % count];
    i /= count;
  }
  return q;
}

std::vector<double> FieldGrid::target(long i, const std::vector<int>& windings) const {
  std::vector<double> q = target(i);
  for (std::size_t a = 0; a < windings.size(); ++a) {
    q[axes[a].coordinate] += windings[a] * axes[a].period;
  }
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
  const std::vector<double> from = target(i, windings);
  const std::vector<double> base = target(0);
  Image image{0, {}};
  std::vector<bool> has_axis(to.size(), false);
  for (const Axis& axis : axes) {
    const int j = axis.coordinate;
    has_axis[j] = true;
    const auto count = static_cast<long>(axis.values.size());
    const double step = count > 1 ? axis.values[1] - axis.values[0] : 1;
    // In steps from the first value, and then within the first period.
    const double there = (mirror[j] * from[j] - axis.values[0]) / step;
    const double period = axis.period / std::abs(step);
    double within = there;
    if (period > 0) within -= period * std::floor((there + kSame) / period);
    const double at = std::round(within);
    if (std::abs(within - at) > kSame || at < 0 || at >= static_cast<double>(count)) return {};
    image.index = image.index * count + static_cast<long>(at);
    const double turns = axis.period > 0 ? (there - at) * step / axis.period : 0;
    image.windings.push_back(static_cast<int>(std::lround(turns)));
  }
  for (std::size_t j = 0; j < to.size(); ++j) {
    if (!has_axis[j] && mirror[j] * base[j] != base[j]) return {};
  }
  return image;
}

}  // namespace carnot::internal
