#include "carnot/plots/sphere.h"

#include <cmath>

namespace carnot::plots {

void Sides::add(const SpaceView& view, const Rows& points, bool sphere) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    Row row = view.at(points[i]);
    row.insert(row.end(), points[i].begin() + 3, points[i].end());
    const bool in_front = !sphere || view.near(points[i]);
    (in_front ? near : far).push_back(row);
    if (i + 1 == points.size() || !sphere || view.near(points[i + 1]) == in_front) continue;
    Row next = view.at(points[i + 1]);  // the piece over the edge is with what comes first
    next.insert(next.end(), points[i + 1].begin() + 3, points[i + 1].end());
    (in_front ? near : far).push_back(next);
    (in_front ? near : far).push_back(gap());
  }
  near.push_back(gap());
  far.push_back(gap());
}

Sides sphere_grid(const SpaceView& view, double radius) {
  constexpr int kPoints = 73;
  constexpr int kEvery = 30;
  Sides sides;
  const auto add = [&](const auto& line) {
    Rows points;
    for (int i = 0; i < kPoints; ++i) points.push_back(line(i * 360.0 / (kPoints - 1) * kDegree));
    sides.add(view, points, true);
  };
  for (int angle = -90 + kEvery; angle < 90; angle += kEvery) {
    const double z = radius * std::sin(angle * kDegree);
    const double r = radius * std::cos(angle * kDegree);
    add([&](double s) { return Row{r * std::cos(s), r * std::sin(s), z}; });
  }
  for (int angle = 0; angle < 180; angle += kEvery) {
    const double x = radius * std::cos(angle * kDegree);
    const double y = radius * std::sin(angle * kDegree);
    add([&](double s) { return Row{x * std::cos(s), y * std::cos(s), radius * std::sin(s)}; });
  }
  return sides;
}

Rows sphere_outline(const SpaceView& view, double radius) {
  constexpr int kPoints = 181;
  const Row centre = view.at({0, 0, 0});
  const Row side = view.at({radius, 0, 0});
  const Row back = view.at({0, radius, 0});
  const Row top = view.at({0, 0, radius});
  // The squared lengths of the images of three axes at right angles add up to twice the square.
  double square = 0;
  for (const Row& end : {side, back, top}) {
    square += std::pow(end[0] - centre[0], 2) + std::pow(end[1] - centre[1], 2);
  }
  const double r = std::sqrt(square / 2);
  Rows rows;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = i * 360.0 / (kPoints - 1) * kDegree;
    rows.push_back({centre[0] + r * std::cos(angle), centre[1] + r * std::sin(angle)});
  }
  return rows;
}

}  // namespace carnot::plots
