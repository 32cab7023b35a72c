#include "carnot/shooting/field/field_grid.h"

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

}  // namespace carnot::internal
