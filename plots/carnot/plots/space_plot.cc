#include "carnot/plots/space_plot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "carnot/plots/instants.h"

namespace carnot::plots {
namespace {

using Point = std::array<double, 3>;

constexpr double kDegree = std::numbers::pi / 180;
const std::string kGrid = "with lines lw 0.6 lc rgb '#e4e4e4'";
const std::string kEdge = "with lines lw 0.8 lc rgb '#9a9a9a'";
const std::string kTic = "with lines lw 1 lc rgb '#000000'";
const std::string kShadow = "with lines lw 1 lc rgb '#b4b4b4'";

std::string start_color() { return " " + line_color_of(TimeColors::kStart); }
std::string goal_color() { return " " + line_color_of(TimeColors::kGoal); }

Interval extent(const SceneInfo& info, const std::vector<Curve>& curves, std::size_t axis) {
  constexpr std::size_t kAllAlong = 90;
  Interval values;
  for (const Curve& curve : curves) {
    const auto& q = curve.trajectory->q;
    for (const auto& row : q) values.include(path_point(info, row)[axis]);
    for (const std::size_t i : spread(q.size(), kAllAlong)) {
      for (const Row& point : body_points(info, q[i])) values.include(point[axis]);
    }
  }
  return values;
}

// A turn that has most of the paths on the near side of the sphere. None of them looks along an
// axis.
double best_turn(const SceneInfo& info, const std::vector<Curve>& curves) {
  constexpr double kMirrored = 90 - kTurn;
  double best = kTurn;
  double most = -1e300;
  for (const double quarter : {0.0, 90.0, 180.0, 270.0}) {
    for (const double turn : {quarter + kTurn, quarter + kMirrored}) {
      const double x = std::sin(turn * kDegree);  // towards the viewer
      const double y = -std::cos(turn * kDegree);
      double sum = 0;
      for (const Curve& curve : curves) {
        for (const auto& q : curve.trajectory->q) {
          const Row point = path_point(info, q);
          const double near = x * point[0] + y * point[1];
          if (std::isfinite(near)) sum += near;
        }
      }
      if (sum > most + 1e-9 * std::abs(most)) {
        most = sum;
        best = turn;
      }
    }
  }
  return best;
}

bool comparable(double a, double b) {
  constexpr double kComparable = 4;  // spans within this factor get one scale
  return std::max(a, b) <= kComparable * std::min(a, b);
}

Point corner_of(bool x, bool y, bool z) { return {x ? 0.5 : -0.5, y ? 0.5 : -0.5, z ? 0.5 : -0.5}; }

// The end of an axis at a fraction of its range, from -1/2 to 1/2.
double value_at(const Axis& axis, double fraction) {
  return axis.offset + axis.lower + (fraction + 0.5) * axis.span();
}

Row data_point(const SpaceFrame& frame, const Point& fractions) {
  Row point;
  for (std::size_t i = 0; i < 3; ++i) point.push_back(value_at(frame.axes[i], fractions[i]));
  return point;
}

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
  const auto place = [&](const Point& p) { return view.at(data_point(view.frame(), p))[0]; };
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
    Row a = data_point(frame, from);
    Row b = data_point(frame, to);
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
    return view.at(data_point(frame, at));
  };
  const Row from = place(-0.5);
  const Row to = place(0.5);
  const Row middle = place(0);
  const double length = std::max(1e-9, std::hypot(to[0] - from[0], to[1] - from[1]));
  std::array<double, 2> out = {(to[1] - from[1]) / length, (from[0] - to[0]) / length};
  const Row centre = view.at(data_point(frame, {0, 0, 0}));
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

// The edges of the floor and of the two walls behind; with a sphere, which needs no walls, the
// floor and the edge that carries the numbers of z.
Rows edges(const SpaceView& view) {
  Rows rows;
  const auto add = [&](const Point& a, const Point& b) {
    add_line(view, data_point(view.frame(), a), data_point(view.frame(), b), rows);
  };
  const bool x = view.near_upper(0);
  const bool y = view.near_upper(1);
  add(corner_of(!x, !y, false), corner_of(x, !y, false));
  add(corner_of(!x, !y, false), corner_of(!x, y, false));
  add(corner_of(x, y, false), corner_of(x, !y, false));
  add(corner_of(x, y, false), corner_of(!x, y, false));
  if (view.frame().sphere > 0) {
    Point from = labelled_edges(view)[2].at;
    Point to = from;
    from[2] = -0.5;
    to[2] = 0.5;
    add(from, to);
    return rows;
  }
  add(corner_of(!x, !y, true), corner_of(x, !y, true));
  add(corner_of(!x, !y, true), corner_of(!x, y, true));
  add(corner_of(!x, !y, false), corner_of(!x, !y, true));
  add(corner_of(x, !y, false), corner_of(x, !y, true));
  add(corner_of(!x, y, false), corner_of(!x, y, true));
  return rows;
}

// Lines on a sphere, what is near and what is far; each point with `values` after the place.
struct Sides {
  Rows near;
  Rows far;

  void add(const SpaceView& view, const Rows& points, bool sphere) {
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
};

// Meridians and parallels, every 30 degrees.
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

// The outline of the sphere: its points at right angles to the rays.
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

double time_fraction(const Trajectory& trajectory, double t) {
  const double span = trajectory.t.back() - trajectory.t.front();
  return span == 0 ? 0 : (t - trajectory.t.front()) / span;
}

// The last number of each row becomes a pale colour.
Rows paled(const Rows& rows, const Trajectory& trajectory) {
  Rows pale = rows;
  for (Row& row : pale) {
    if (!row.empty()) row.back() = TimeColors::pale(time_fraction(trajectory, row.back()));
  }
  return pale;
}

Rows floor_rows(const SpaceView& view, const Rows& points) {
  const Axis& z = view.frame().axes[2];
  Rows rows;
  for (const Row& point : points) {
    const double floor = z.offset + z.lower;
    rows.push_back(view.at({point[0], point[1], point[2] - point[2] + floor}));  // NaN stays
  }
  return rows;
}

// The body at a row, coloured by its time; pale on the far side of a sphere.
Rows body_in_space(const SceneInfo& info,
                   const Trajectory& trajectory,
                   const SpaceView& view,
                   std::size_t row,
                   bool near) {
  Rows rows;
  const auto& q = trajectory.q[row];
  if (body_points(info, q).empty()) return rows;
  const double fraction = time_fraction(trajectory, trajectory.t[row]);
  const double color = near ? TimeColors::argb(fraction, 0) : TimeColors::pale(fraction);
  for (const SpaceLine& line : info.drawing.body_in_space(q.data())) {
    for (const Point& point : line.points) {
      Row at = view.at({point.begin(), point.end()});
      at.push_back(color);
      rows.push_back(at);
    }
    rows.push_back(gap());
  }
  return rows;
}

}  // namespace

SpaceFrame::SpaceFrame(const SceneInfo& info, const std::vector<Curve>& curves)
    : axes{Axis(extent(info, curves, 0)),
           Axis(extent(info, curves, 1)),
           Axis(extent(info, curves, 2))} {
  constexpr double kMargin = 1.1;
  constexpr double kMarginOfSphere = 1.12;  // numbers at the corners stay apart
  constexpr double kFlattest = 0.45;        // of the longer side of the floor
  constexpr double kFreeHeight = 0.8;
  sphere = info.drawing.sphere;
  if (sphere > 0) {
    const double radius = sphere;
    turn = best_turn(info, curves);
    Interval values;
    values.include(-radius);
    values.include(radius);
    for (Axis& axis : axes) values.include(axis.lower), values.include(axis.upper);
    for (Axis& axis : axes) {
      axis = Axis(values);
      axis.widen(kMarginOfSphere);
    }
    return;
  }
  for (Axis& axis : axes) axis.widen(kMargin);
  auto& [x, y, z] = axes;
  const double floor = std::max(x.span(), y.span());
  if (comparable(x.span(), y.span())) {
    x.widen_to(kFlattest * floor);
    y.widen_to(kFlattest * floor);
    drawn[0] = x.span() / floor;
    drawn[1] = y.span() / floor;
  }
  constexpr double kUnder = 0.15;  // the floor lies below the curve
  const bool same_unit = space_coordinate(info, 0).unit == space_coordinate(info, 2).unit;
  drawn[2] = kFreeHeight;
  if (same_unit && comparable(x.span(), y.span()) && comparable(floor, z.span())) {
    z.widen_to(kFlattest * floor);
    drawn[2] = (1 + kUnder) * z.span() / floor;
  }
  z.lower -= kUnder * z.span();
}

Coordinate space_coordinate(const SceneInfo& info, std::size_t axis) {
  if (info.drawing.place.at) return info.drawing.place.coordinates[axis];
  const auto i = static_cast<std::size_t>(info.drawing.axes[axis]);
  if (i < info.configuration.size()) return info.configuration[i];
  return {"q" + std::to_string(i + 1), "", 0};
}

SpaceView::SpaceView(const SpaceFrame& frame,
                     const Box& room,
                     double turn,
                     const std::array<double, 2>& turns)
    : frame_(frame), turn_(0) {
  constexpr int kTurns = 13;
  constexpr double kLeft = 66;  // numbers and label of the upright axis
  constexpr double kRight = 34;
  constexpr double kBelow = 40;
  constexpr double kAbove = 8;
  Interval right;
  Interval up;
  for (int i = 0; i < kTurns; ++i) {
    turn_ = (turns[0] + (turns[1] - turns[0]) * i / (kTurns - 1)) * kDegree;
    const auto include = [&](Point corner) {
      for (std::size_t j = 0; j < 3; ++j) corner[j] *= frame_.drawn[j];
      const Point seen = projected(corner);
      right.include(seen[0]);
      up.include(seen[1]);
    };
    for (const bool x : {false, true}) {
      for (const bool y : {false, true}) {
        include(corner_of(x, y, false));
        // Around a sphere only one of the upright edges at the sides is drawn.
        const bool aside = (x == near_upper(0)) != (y == near_upper(1));
        if (frame_.sphere == 0 || aside) include(corner_of(x, y, true));
      }
    }
  }
  if (frame_.sphere > 0) up.include(frame_.drawn[2] * frame_.sphere / frame_.axes[2].span());
  turn_ = turn * kDegree;
  scale_ = std::min((room.width - kLeft - kRight) / right.span(),
                    (room.height - kBelow - kAbove) / up.span());
  box_.width = right.span() * scale_ + kLeft + kRight;
  box_.height = up.span() * scale_ + kBelow + kAbove;
  box_.x = room.x + (room.width - box_.width) / 2;
  box_.y = room.y + (room.height - box_.height) / 2;
  middle_ = {box_.x + kLeft - right.lower * scale_, box_.y + kBelow - up.lower * scale_};
}

std::array<double, 3> SpaceView::projected(const Point& drawn) const {
  const double right = drawn[0] * std::cos(turn_) + drawn[1] * std::sin(turn_);
  const double back = -drawn[0] * std::sin(turn_) + drawn[1] * std::cos(turn_);
  const double c = std::cos(kElevation * kDegree);
  const double s = std::sin(kElevation * kDegree);
  return {right, drawn[2] * c + back * s, drawn[2] * s - back * c};
}

Row SpaceView::at(const Row& point) const {
  Point drawn{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Axis& axis = frame_.axes[i];
    drawn[i] = frame_.drawn[i] * ((axis.at(point[i]) - axis.lower) / axis.span() - 0.5);
  }
  const Point seen = projected(drawn);
  return {middle_[0] + scale_ * seen[0], middle_[1] + scale_ * seen[1]};
}

bool SpaceView::near(const Row& point) const {
  return projected({point[0], point[1], point[2]})[2] >= 0;
}

bool SpaceView::near_upper(std::size_t i) const {
  Point axis{};
  axis[i] = 1;
  return projected(axis)[2] > 0;
}

Rows space_rows(const SceneInfo& info, const Trajectory& trajectory) {
  Rows rows;
  for (std::size_t i = 0; i < trajectory.q.size(); ++i) {
    rows.push_back(path_point(info, trajectory.q[i]));
    rows.back().push_back(trajectory.t[i]);
  }
  return rows;
}

std::vector<LegendEntry> space_legend(const SceneInfo& info) {
  const Drawing& drawing = info.drawing;
  std::vector<LegendEntry> entries = {
      {"", "with points pt 7 ps 1.2" + start_color(), "start"},
      {"", "with points pt 5 ps 1.1" + goal_color(), "goal"},
      {"with lines lw 2.2 " + line_color_of(TimeColors::kMiddle),
       "",
       drawing.path.empty() ? "path" : "path of " + escaped(drawing.path)}};
  if (drawing.sphere == 0) entries.push_back({kShadow, "", "shadow"});
  if (drawing.body_in_space && !drawing.glyph.empty()) {
    entries.push_back(
        {"with lines lw 1.4 " + line_color_of(TimeColors::kMiddle), "", escaped(drawing.glyph)});
  }
  return entries;
}

void draw_space(Script& script,
                const Picture& page,
                const SceneInfo& info,
                const Trajectory& trajectory,
                const SpaceView& view,
                std::size_t last,
                const std::vector<std::size_t>& bodies) {
  const double size = std::clamp(view.box().width / 560, 0.6, 1.0);  // small panels, thin lines
  const auto scaled = [size](double points) { return number(size * points, 3); };
  const double radius = info.drawing.sphere;
  const bool sphere = radius > 0;
  const Box& box = view.box();
  script << "unset xtics\nunset ytics\nunset border\nunset grid\nset xlabel ''\nset ylabel ''\n"
         << "set size noratio\nset xrange [" << box.x << ":" << box.x + box.width
         << "]\nset yrange [" << box.y << ":" << box.y + box.height << "]\n";
  set_box(script, page, box);
  Rows tics;
  Rows grid;
  for (const Edge& edge : labelled_edges(view)) {
    label_edge(script, page, info, view, edge, tics, grid);
  }
  const Rows points = space_rows(info, trajectory);
  const Row& end = points.back();
  Sides path;
  path.add(view, {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(last) + 1}, sphere);
  Plot plot(script, "plot", {box.x, box.y});
  if (!sphere) plot.add(grid, kGrid);
  plot.add(edges(view), kEdge).add(tics, kTic);
  const auto add_bodies = [&](bool near) {
    for (const std::size_t row : bodies) {
      if (sphere && view.near(points[row]) != near) continue;
      if (!sphere && !near) continue;
      const bool at_end = row == 0 || row + 1 == points.size();
      plot.add(body_in_space(info, trajectory, view, row, near),
               "using 1:2:3 with lines lc rgb variable lw " + scaled(at_end ? 2.6 : 1.4));
    }
  };
  if (sphere) {
    const Sides lines = sphere_grid(view, radius);
    plot.add(sphere_outline(view, radius),
             "with filledcurves closed fs solid noborder fc rgb '#f7f7f7'")
        .add(lines.far, "with lines lw 0.5 lc rgb '#e9e9e9'")
        .add(paled(path.far, trajectory),
             "using 1:2:3 with lines lc rgb variable lw " + scaled(1.6));
    add_bodies(false);
    plot.add(lines.near, "with lines lw 0.6 lc rgb '#cfcfcf'")
        .add(sphere_outline(view, radius), "with lines lw 0.8 lc rgb '#b4b4b4'");
  } else {
    const Rows shadow =
        floor_rows(view, {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(last) + 1});
    plot.add(shadow, kShadow)
        .add({view.at(points.front()), floor_rows(view, {points.front()})[0]},
             "with lines lw 1 dt (4,4)" + start_color())
        .add({view.at(end), floor_rows(view, {end})[0]}, "with lines lw 1 dt (4,4)" + goal_color());
  }
  plot.add(path.near, "using 1:2:3 with lines lc palette lw " + scaled(2.2));
  add_bodies(true);
  plot.add({view.at(points.front())}, "with points pt 7 ps " + scaled(1.2) + start_color())
      .add({view.at(end)}, "with points pt 5 ps " + scaled(1.1) + goal_color());
  plot.draw();
  clear_settings(script);
}

Picture space_picture(const SceneInfo& info, const std::vector<Curve>& curves) {
  constexpr std::size_t kBodies = 9;
  constexpr std::size_t kBodiesInPanel = 7;
  const std::vector<Curve> shown = shown_curves(curves);
  const bool single = shown.size() == 1;
  Sheet sheet;
  sheet.left = 20;
  sheet.below = 62;
  sheet.gap_x = 30;
  sheet.gap_y = 50;
  const SpaceFrame frame(info, shown);
  const Box room{0, 0, panel_room(shown.size(), sheet), single ? 540.0 : 420.0};
  const Box box = SpaceView(frame, room).box();
  const auto draw = [&](Script& script, const Picture& page, const Curve& curve, const Panel& at) {
    const SpaceView view(frame, at.box);
    const Trajectory& trajectory = *curve.trajectory;
    draw_space(script,
               page,
               info,
               trajectory,
               view,
               trajectory.t.size() - 1,
               body_instants(info, trajectory, single ? kBodies : kBodiesInPanel));
  };
  return draw_panels(info, curves, sheet, box.width, box.height, space_legend(info), draw);
}

}  // namespace carnot::plots
