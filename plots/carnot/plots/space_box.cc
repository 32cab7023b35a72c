#include "carnot/plots/space_box.h"

#include <algorithm>
#include <cmath>

namespace carnot::plots {
namespace {

using Point = std::array<double, 3>;

void add_line(const SpaceView& view, const Row& from, const Row& to, Rows& rows) {
  rows.push_back(view.at(from));
  rows.push_back(view.at(to));
  rows.push_back(gap());
}

// An edge of the box that carries the numbers of axis i. `at` holds its two other fractions.
struct Edge {
  std::size_t axis;
  Point at;
};

// The near edges of the floor and, of the two upright edges at the sides, the left one.
std::array<Edge, 3> labelled_edges(const SpaceView& view) {
  const double x = view.near_upper(0) ? 0.5 : -0.5;
  const double y = view.near_upper(1) ? 0.5 : -0.5;
  Point left = {x, -y, 0};
  const Point other = {-x, y, 0};
  const auto place = [&](const Point& p) { return view.at(point_in_box(view.frame(), p))[0]; };
  if (place(other) < place(left)) left = other;
  return {Edge{0, {0, y, -0.5}}, Edge{1, {x, 0, -0.5}}, Edge{2, left}};
}

std::vector<double> tics_of(const Axis& axis, double length) {
  constexpr double kSpacing = 58;
  const double step = tic_step(axis, std::max(3.0, length / kSpacing), 3);
  std::vector<double> tics;
  for (double k = std::ceil(axis.lower / step - 1e-9); k * step <= axis.upper + 1e-9 * step; ++k) {
    tics.push_back(axis.offset + k * step);
  }
  return tics;
}

// Lines across the two walls that meet in the edge's axis, at one tic.
void add_grid(const SpaceView& view, std::size_t axis, double tic, Rows& grid) {
  const SpaceFrame& frame = view.frame();
  Point far{};
  for (std::size_t i = 0; i < 3; ++i) far[i] = view.near_upper(i) ? -0.5 : 0.5;
  far[2] = -0.5;
  for (std::size_t along = 0; along < 3; ++along) {
    if (along == axis) continue;
    Point from = far;
    Point to = far;
    from[along] = -0.5;
    to[along] = 0.5;
    Row a = point_in_box(frame, from);
    Row b = point_in_box(frame, to);
    a[axis] = b[axis] = tic;
    add_line(view, a, b, grid);
  }
}

// Numbers, tics and the label along an edge of the box, outside of it.
void label_edge(Script& script,
                const Picture& page,
                const SceneInfo& info,
                const SpaceView& view,
                const Edge& edge,
                Rows& tics,
                Rows& grid) {
  constexpr double kTicLength = 5;
  constexpr double kHeight = 13;  // of a number
  constexpr double kSpace = 5;
  const SpaceFrame& frame = view.frame();
  const Axis& axis = frame.axes[edge.axis];
  const auto place = [&](double fraction) {
    Point at = edge.at;
    at[edge.axis] = fraction;
    return view.at(point_in_box(frame, at));
  };
  const Row from = place(-0.5);
  const Row to = place(0.5);
  const Row middle = place(0);
  const double length = std::max(1e-9, std::hypot(to[0] - from[0], to[1] - from[1]));
  std::array<double, 2> out = {(to[1] - from[1]) / length, (from[0] - to[0]) / length};
  const Row centre = view.at(point_in_box(frame, {0, 0, 0}));
  if (out[0] * (middle[0] - centre[0]) + out[1] * (middle[1] - centre[1]) < 0) {
    out = {-out[0], -out[1]};
  }
  double widest = 0;
  for (const double tic : tics_of(axis, length)) {
    const Row at = place((axis.at(tic) - axis.lower) / axis.span() - 0.5);
    const std::string text = tic_number(axis.at(tic), axis.span());
    const double half = std::abs(out[0]) * text_width(text) / 2 + std::abs(out[1]) * kHeight / 2;
    const double off = kTicLength + kSpace + half;
    widest = std::max(widest, half);
    tics.push_back(at);
    tics.push_back({at[0] + kTicLength * out[0], at[1] + kTicLength * out[1]});
    tics.push_back(gap());
    put_text(script, page, at[0] + off * out[0], at[1] + off * out[1], text);
    add_grid(view, edge.axis, tic, grid);
  }
  const Coordinate coordinate = space_coordinate(info, edge.axis);
  double angle = std::atan2(to[1] - from[1], to[0] - from[0]) / kDegree;
  if (angle > 90.5) angle -= 180;
  if (angle < -89.5) angle += 180;
  const double off = kTicLength + 3 * kSpace + 2 * widest + kHeight / 2;
  put_text(script,
           page,
           middle[0] + off * out[0],
           middle[1] + off * out[1],
           axis.label(symbol(coordinate.name), coordinate.unit),
           "center rotate by " + number(angle, 5));
}

}  // namespace

Rows box_edges(const SpaceView& view) {
  Rows rows;
  const auto add = [&](const Point& a, const Point& b) {
    add_line(view, point_in_box(view.frame(), a), point_in_box(view.frame(), b), rows);
  };
  const bool x = view.near_upper(0);
  const bool y = view.near_upper(1);
  add(corner_of_box(!x, !y, false), corner_of_box(x, !y, false));
  add(corner_of_box(!x, !y, false), corner_of_box(!x, y, false));
  add(corner_of_box(x, y, false), corner_of_box(x, !y, false));
  add(corner_of_box(x, y, false), corner_of_box(!x, y, false));
  if (view.frame().sphere > 0) {
    Point from = labelled_edges(view)[2].at;
    Point to = from;
    from[2] = -0.5;
    to[2] = 0.5;
    add(from, to);
    return rows;
  }
  add(corner_of_box(!x, !y, true), corner_of_box(x, !y, true));
  add(corner_of_box(!x, !y, true), corner_of_box(!x, y, true));
  add(corner_of_box(!x, !y, false), corner_of_box(!x, !y, true));
  add(corner_of_box(x, !y, false), corner_of_box(x, !y, true));
  add(corner_of_box(!x, y, false), corner_of_box(!x, y, true));
  return rows;
}

void label_box(Script& script,
               const Picture& page,
               const SceneInfo& info,
               const SpaceView& view,
               Rows& tics,
               Rows& grid) {
  for (const Edge& edge : labelled_edges(view)) {
    label_edge(script, page, info, view, edge, tics, grid);
  }
}

}  // namespace carnot::plots
