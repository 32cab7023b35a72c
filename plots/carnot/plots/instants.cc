#include "carnot/plots/instants.h"

#include <algorithm>
#include <cmath>

#include "carnot/plots/page.h"

namespace carnot::plots {
namespace {

using View = Drawing::View;

double distance(const Row& a, const Row& b) {
  double square = 0;
  for (std::size_t i = 0; i < a.size(); ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(square);
}

// The diagonal of the box that holds the points.
double size_of(const Rows& points) {
  if (points.empty()) return 0;
  double square = 0;
  for (std::size_t i = 0; i < points.front().size(); ++i) {
    Interval values;
    for (const Row& point : points) values.include(point[i]);
    if (!values.empty()) square += values.span() * values.span();
  }
  return std::sqrt(square);
}

// How far the body is moved between two of its configurations: the mean over its points, or that of
// the point of the path where lines come and go.
double moved(const SceneInfo& info, const std::vector<double>& a, const std::vector<double>& b) {
  const Rows from = body_points(info, a);
  const Rows to = body_points(info, b);
  double sum = 0;
  if (from.size() == to.size()) {
    for (std::size_t i = 0; i < from.size(); ++i) sum += distance(from[i], to[i]);
    sum /= static_cast<double>(std::max<std::size_t>(from.size(), 1));
  } else {
    sum = distance(path_point(info, a), path_point(info, b));
  }
  return std::isfinite(sum) ? sum : 0;
}

// The row nearest to a place along the way.
std::size_t row_at(const std::vector<double>& way, double place) {
  const auto after = std::lower_bound(way.begin(), way.end(), place);
  if (after == way.begin()) return 0;
  if (after == way.end()) return way.size() - 1;
  const auto row = static_cast<std::size_t>(after - way.begin());
  return place - way[row - 1] < way[row] - place ? row - 1 : row;
}

// Adds `more` rows between those that are fixed, each time where the gaps are the largest.
std::vector<std::size_t> filled(const std::vector<std::size_t>& fixed,
                                const std::vector<double>& way,
                                std::size_t more) {
  std::vector<std::size_t> parts(fixed.size() - 1, 1);
  const auto gap = [&](std::size_t i) {
    return (way[fixed[i + 1]] - way[fixed[i]]) / static_cast<double>(parts[i]);
  };
  for (; more > 0; --more) {
    std::size_t largest = 0;
    for (std::size_t i = 1; i < parts.size(); ++i) {
      if (gap(i) > gap(largest)) largest = i;
    }
    ++parts[largest];
  }
  std::vector<std::size_t> rows = fixed;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = 1; j < parts[i]; ++j) {
      rows.push_back(row_at(way, way[fixed[i]] + gap(i) * static_cast<double>(j)));
    }
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace

std::vector<std::size_t> cusps(const Rows& points) {
  constexpr double kStill = 1e-9;  // of the size of the path: no direction
  const double still = kStill * size_of(points);
  const auto turns_back = [&](std::size_t i, std::size_t w) {
    if (i < w || i + w >= points.size()) return false;
    double product = 0;
    for (std::size_t j = 0; j < points[i].size(); ++j) {
      product += (points[i][j] - points[i - w][j]) * (points[i + w][j] - points[i][j]);
    }
    return product < 0 && distance(points[i - w], points[i]) > still &&
           distance(points[i], points[i + w]) > still;
  };
  std::vector<std::size_t> rows;
  double slowest = 0;
  std::size_t last = 0;  // of the rows that turn back, and are neighbours
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    if (!turns_back(i, 1) && !turns_back(i, 2)) continue;
    const double speed = distance(points[i - 1], points[i + 1]);
    if (rows.empty() || i > last + 1) {
      rows.push_back(i);
      slowest = speed;
    } else if (speed < slowest) {
      rows.back() = i;
      slowest = speed;
    }
    last = i;
  }
  return rows;
}

Row path_point(const SceneInfo& info, const std::vector<double>& q) {
  const Drawing& drawing = info.drawing;
  if (drawing.view == View::kSpace && drawing.place.at) {
    const auto point = drawing.place.at(q.data());
    return {point.begin(), point.end()};
  }
  Row point;
  const std::size_t axes = drawing.view == View::kSpace ? 3 : 2;
  for (std::size_t i = 0; i < axes; ++i) {
    point.push_back(q[static_cast<std::size_t>(drawing.axes[i])]);
  }
  return point;
}

Rows body_points(const SceneInfo& info, const std::vector<double>& q) {
  Rows points;
  if (!std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); })) return points;
  const Drawing& drawing = info.drawing;
  if (drawing.view == View::kPlane && drawing.body) {
    for (const Polyline& line : drawing.body(q.data())) {
      for (const auto& point : line.points) points.emplace_back(point.begin(), point.end());
    }
  }
  if (drawing.view == View::kSpace && drawing.body_in_space) {
    for (const SpaceLine& line : drawing.body_in_space(q.data())) {
      for (const auto& point : line.points) points.emplace_back(point.begin(), point.end());
    }
  }
  return points;
}

std::vector<std::size_t> body_instants(const SceneInfo& info,
                                       const Trajectory& trajectory,
                                       std::size_t most) {
  constexpr double kPerSize = 1.8;  // bodies along a way as long as the body is large
  constexpr double kApart = 0.25;   // sizes, from a cusp to the ends
  constexpr std::size_t kLeast = 4;
  const std::size_t rows = trajectory.q.size();
  std::vector<std::size_t> fixed = {0};
  if (rows > 1) fixed.push_back(rows - 1);
  std::vector<double> way = {0};
  Rows path;
  double size = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    path.push_back(path_point(info, trajectory.q[i]));
    size = std::max(size, size_of(body_points(info, trajectory.q[i])));
    if (i > 0) way.push_back(way.back() + moved(info, trajectory.q[i - 1], trajectory.q[i]));
  }
  if (size == 0 || way.back() == 0 || rows < 3) return fixed;
  std::vector<std::size_t> turns = cusps(path);
  std::erase_if(turns, [&](std::size_t row) {
    return std::min(way[row], way.back() - way[row]) < kApart * size;
  });
  if (fixed.size() + turns.size() <= most) {
    fixed.insert(fixed.begin() + 1, turns.begin(), turns.end());
  }
  const double wanted = std::clamp(
      kPerSize * way.back() / size + 1, static_cast<double>(kLeast), static_cast<double>(most));
  const auto all = std::max(static_cast<std::size_t>(wanted), fixed.size());
  return filled(fixed, way, all - fixed.size());
}

}  // namespace carnot::plots
