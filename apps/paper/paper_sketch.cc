// Figure 1 of the paper: the vehicle, its wheels and its angles.
#include <array>
#include <cmath>
#include <numbers>

#include "carnot/plots/series_plot.h"
#include "paper/paper_parts.h"

namespace carnot::apps {
namespace {

using plots::Series;
using Point = std::array<double, 2>;

constexpr int kBlack = 6;  // of line_color()
constexpr int kBlue = 0;
constexpr int kRed = 1;
constexpr double kTheta = 0.45;  // rad
constexpr double kPhi = 1.15;

Point from(const Point& origin, double angle, double distance) {
  return {origin[0] + distance * std::cos(angle), origin[1] + distance * std::sin(angle)};
}

Series line(const std::vector<Point>& points, int color, double width, bool dashed = false) {
  Series series;
  for (const Point& point : points) {
    series.x.push_back(point[0]);
    series.y.push_back(point[1]);
  }
  series.color = color;
  series.width = width;
  series.dashed = dashed;
  return series;
}

Series dot(const Point& at) {
  Series series = line({at}, kBlack, 1);
  series.mark = Series::Mark::kPoints;
  return series;
}

Series wheel(const Point& at, double heading, int color) {
  constexpr double kRadius = 0.2;  // of the wheelbase
  return line({from(at, heading, -kRadius), from(at, heading, kRadius)}, color, 7);
}

// From the x direction to `angle`.
Series arc(const Point& about, double radius, double angle, int color) {
  constexpr int kPieces = 40;
  std::vector<Point> points;
  for (int i = 0; i <= kPieces; ++i) points.push_back(from(about, angle * i / kPieces, radius));
  return line(points, color, 1.2);
}

plots::Note note(const Point& at, const std::string& text) { return {at[0], at[1], text}; }

}  // namespace

PaperPart paper_sketch() {
  constexpr double kAcross = std::numbers::pi / 2;
  const Point rear{0, 0};
  const Point front = from(rear, kTheta, 1);
  plots::SeriesPanel panel;
  panel.series = {line({rear, from(rear, 0, 0.75)}, kBlack, 0.8, true),
                  line({front, from(front, 0, 0.6)}, kBlack, 0.8, true),
                  line({front, from(front, kPhi, 0.55)}, kRed, 0.8, true),
                  arc(rear, 0.55, kTheta, kBlue),
                  arc(front, 0.4, kPhi, kRed),
                  line({rear, front}, kBlack, 2.5),
                  wheel(rear, kTheta, kBlue),
                  wheel(front, kPhi, kRed),
                  dot(rear),
                  dot(front)};
  panel.notes = {note(from(rear, kTheta / 2, 0.63), "\u03b8"),
                 note(from(front, kPhi / 2, 0.48), "\u03c6"),
                 note(from(from(rear, kTheta, 0.55), kTheta + kAcross, 0.1), "L"),
                 note(from(rear, kTheta - kAcross, 0.2), "(z, w)"),
                 note(from(front, -1.2, 0.15), "(x, y)")};
  panel.x.range = {-0.35, 1.6};
  panel.y.range = {-0.25, 1.0};
  panel.equal_axes = true;
  panel.frame = false;
  plots::SeriesPage page;
  page.title = "the two-wheeled vehicle";
  page.panels = {panel};
  page.width = 540;
  page.height = 360;
  PaperPart part;
  part.title = "Section 5: the vehicle";
  part.figures = {{"vehicle",
                   "the two wheels, the angles theta of the body and phi of the front wheel",
                   [page](const auto& file) { return plots::write_series(file, page); }}};
  return part;
}

}  // namespace carnot::apps
