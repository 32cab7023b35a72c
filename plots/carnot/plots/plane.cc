#include "carnot/plots/plane.h"

#include <algorithm>
#include <cmath>

#include "carnot/plots/instants.h"
#include "carnot/scene/body.h"

namespace carnot::plots {
namespace {

constexpr double kMargin = 1.08;

bool finite(const std::vector<double>& q) {
  return std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); });
}

std::vector<Polyline> body_at(const SceneInfo& info, const std::vector<double>& q) {
  if (!info.drawing.body || !finite(q)) return {};
  return info.drawing.body(q.data());
}

// A wheel that is given by the ends of its diameter, from above: a narrow rectangle.
Polyline outlined(const Polyline& line) {
  constexpr double kWidth = 0.3;  // of the diameter
  if (line.role != Polyline::Role::kWheel || line.points.size() != 2) return line;
  const auto& a = line.points[0];
  const auto& b = line.points[1];
  const double diameter = std::hypot(b[0] - a[0], b[1] - a[1]);
  const double heading = std::atan2(b[1] - a[1], b[0] - a[0]);
  return {
      line.role,
      rectangle({a[0] / 2 + b[0] / 2, a[1] / 2 + b[1] / 2}, heading, diameter, kWidth * diameter)
          .points};
}

// Of a wheel, which is symmetric about its axle.
double middle_of(const Polyline& line, std::size_t i) {
  double lower = line.points.front()[i];
  double upper = lower;
  for (const auto& point : line.points) {
    lower = std::min(lower, point[i]);
    upper = std::max(upper, point[i]);
  }
  return lower / 2 + upper / 2;
}

double time_fraction(const Trajectory& trajectory, std::size_t row) {
  const double span = trajectory.t.back() - trajectory.t.front();
  return span == 0 ? 0 : (trajectory.t[row] - trajectory.t.front()) / span;
}

}  // namespace

std::size_t axis_index(const SceneInfo& info, std::size_t i) {
  return static_cast<std::size_t>(info.drawing.axes[i]);
}

PlaneExtent::PlaneExtent(const SceneInfo& info,
                         const std::vector<Curve>& curves,
                         std::size_t bodies) {
  constexpr std::size_t kAllAlong = 90;
  for (const Limit& limit : info.limits) {
    for (const auto& corner : limit.outline) {
      x.include(corner[0]);
      y.include(corner[1]);
    }
  }
  for (const Curve& curve : curves) {
    const Trajectory& trajectory = *curve.trajectory;
    for (const auto& q : trajectory.q) {
      x.include(q[axis_index(info, 0)]);
      y.include(q[axis_index(info, 1)]);
    }
    const std::vector<std::size_t> rows = bodies == 0 ? spread(trajectory.q.size(), kAllAlong)
                                                      : body_instants(info, trajectory, bodies);
    for (const std::size_t i : rows) {
      for (const Row& point : body_points(info, trajectory.q[i])) {
        x.include(point[0]);
        y.include(point[1]);
      }
    }
  }
}

PlaneFrame::PlaneFrame(const PlaneExtent& extent, const Box& room)
    : x(extent.x), y(extent.y), box(room) {
  constexpr double kFlattest = 0.3;  // height / width of a path along an axis
  const double size = kMargin * std::max(x.span(), y.span());
  x.widen_to(std::max(kMargin * x.span(), kFlattest * size));
  y.widen_to(std::max(kMargin * y.span(), kFlattest * size));
  const double scale = std::min(room.width / x.span(), room.height / y.span());
  box.width = std::max(scale * x.span(), std::min(room.width, 0.6 * room.height));
  box.height = scale * y.span();
  x.widen_to(box.width / scale);
  box.x += (room.width - box.width) / 2;
  box.y += (room.height - box.height) / 2;
}

Rows body_rows(const SceneInfo& info,
               const Trajectory& trajectory,
               const std::vector<std::size_t>& instants,
               Polyline::Role role,
               const PlaneFrame& frame,
               int alpha) {
  Rows rows;
  for (const std::size_t i : instants) {
    const double color = TimeColors::argb(time_fraction(trajectory, i), alpha);
    for (const Polyline& line : body_at(info, trajectory.q[i])) {
      if (line.role != role) continue;
      for (const auto& point : outlined(line).points) {
        rows.push_back({frame.x.at(point[0]), frame.y.at(point[1]), color});
      }
      rows.push_back(gap());
    }
  }
  return rows;
}

Rows path_rows(const SceneInfo& info, const Trajectory& trajectory, const PlaneFrame& frame) {
  Rows rows;
  for (std::size_t i = 0; i < trajectory.q.size(); ++i) {
    const auto& q = trajectory.q[i];
    rows.push_back(
        {frame.x.at(q[axis_index(info, 0)]), frame.y.at(q[axis_index(info, 1)]), trajectory.t[i]});
  }
  return rows;
}

std::vector<Rows> other_wheels(const SceneInfo& info,
                               const Trajectory& trajectory,
                               const PlaneFrame& frame) {
  constexpr double kSame = 1e-3;  // of the picture: the wheel is at the reference point
  std::vector<Rows> tracks;
  std::vector<double> largest;  // distance from the reference point
  for (const auto& q : trajectory.q) {
    std::size_t wheel = 0;
    for (const Polyline& line : body_at(info, q)) {
      if (line.role != Polyline::Role::kWheel || line.points.empty()) continue;
      if (tracks.size() <= wheel) tracks.resize(wheel + 1), largest.resize(wheel + 1);
      const double x = middle_of(line, 0);
      const double y = middle_of(line, 1);
      const double off = std::hypot(x - q[axis_index(info, 0)], y - q[axis_index(info, 1)]);
      largest[wheel] = std::max(largest[wheel], off);
      tracks[wheel++].push_back({frame.x.at(x), frame.y.at(y)});
    }
  }
  std::vector<Rows> others;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (largest[i] > kSame * frame.x.span()) others.push_back(tracks[i]);
  }
  return others;
}

Rows limit_rows(const SceneInfo& info, const Curve& curve, const PlaneFrame& frame) {
  const Rows path = path_rows(info, *curve.trajectory, frame);
  Rows rows;
  for (const auto& [begin, end] : curve.on_limits) {
    // A touch is at the sample that is nearest to it.
    std::size_t nearest = 0;
    bool any = false;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double t = curve.trajectory->t[i];
      const double middle = 0.5 * (begin + end);
      if (std::abs(t - middle) < std::abs(curve.trajectory->t[nearest] - middle)) nearest = i;
      if (t < begin || t > end) continue;
      rows.push_back({path[i][0], path[i][1]});
      any = true;
    }
    if (!any && !path.empty()) rows.push_back({path[nearest][0], path[nearest][1]});
    rows.push_back(gap());
  }
  return rows;
}

void set_plane(Script& script,
               const Picture& page,
               const SceneInfo& info,
               const PlaneFrame& frame) {
  const std::size_t i = axis_index(info, 0);
  const std::size_t j = axis_index(info, 1);
  set_box(script, page, frame.box);
  script << "unset object\n";
  for (const Limit& limit : info.limits) {
    if (limit.outline.empty()) continue;
    script << "set object polygon";
    for (std::size_t corner = 0; corner <= limit.outline.size(); ++corner) {
      const auto& point = limit.outline[corner % limit.outline.size()];
      script << (corner == 0 ? " from " : " to ") << number(frame.x.at(point[0]), 9) << ","
             << number(frame.y.at(point[1]), 9);
    }
    script << " behind fc rgb '#d8d4ce' fs solid 1 border rgb '#8a8378'\n";
  }
  set_axis(script, "x", frame.x, frame.box.width, 62);
  set_axis(script, "y", frame.y, frame.box.height, 60);
  script << "set xlabel "
         << quoted_markup(frame.x.label(coordinate_symbol(info, i), coordinate_unit(info, i)))
         << "\nset ylabel "
         << quoted_markup(frame.y.label(coordinate_symbol(info, j), coordinate_unit(info, j)))
         << "\nset size ratio -1\nset grid lc rgb '#e4e4e4' lt 1 lw 0.6\n"
         << "set tics nomirror out scale 0.6\nset border 3 lw 1\n";
}

}  // namespace carnot::plots
