#include "carnot/plots/surface_plot.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "carnot/plots/page.h"
#include "carnot/plots/plot_file.h"
#include "carnot/plots/script.h"

namespace carnot::plots {
namespace {

constexpr double kWidth = 1400;
constexpr double kHeight = 760;

bool finite(const std::array<double, 3>& p) {
  return std::all_of(p.begin(), p.end(), [](double x) { return std::isfinite(x); });
}

// The axes of a plane across one of three.
std::array<int, 2> others(int across) {
  if (across == 0) return {1, 2};
  return across == 1 ? std::array{0, 2} : std::array{0, 1};
}

// What lies in a plane does so but for round-off. That is not drawn in its own size: the axis is an
// eighth as long as another one of the same unit.
void widen_flat(const SurfacePage& page, std::array<Interval, 3>& ranges) {
  constexpr double kFlat = 1e-6;
  constexpr double kPart = 0.13;
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      if (page.axes[k].unit != page.axes[l].unit || ranges[l].empty()) continue;
      const double other = ranges[l].span();
      if (!(ranges[k].span() < kFlat * other)) continue;
      const double middle = 0.5 * (ranges[k].lower + ranges[k].upper);
      const double rounded = std::abs(middle) < kFlat * other ? 0 : middle;
      ranges[k] = {rounded - 0.5 * kPart * other, rounded + 0.5 * kPart * other};
    }
  }
}

std::array<Axis, 3> axes_of(const SurfacePage& page) {
  std::array<Interval, 3> ranges;
  for (const SurfaceSheet& sheet : page.sheets) {
    for (const auto& t : sheet.triangles) {
      for (const int i : t) {
        if (!finite(sheet.points[i])) continue;
        for (int k = 0; k < 3; ++k) ranges[k].include(sheet.points[i][k]);
      }
    }
    for (const auto& segment : sheet.segments) {
      for (const int i : segment) {
        if (!finite(sheet.points[i])) continue;
        for (int k = 0; k < 2; ++k) ranges[k].include(sheet.points[i][k]);
      }
    }
  }
  if (!page.plane) widen_flat(page, ranges);
  return {Axis(ranges[0]), Axis(ranges[1]), Axis(ranges[2])};
}

// A place, and the value there.
using Valued = std::array<double, 4>;

// What is drawn of a triangle: nothing, itself, or what is behind the section, three corners or
// four.
std::vector<Valued> drawn_part(const SurfacePage& page,
                               const SurfaceSheet& sheet,
                               const std::array<int, 3>& t) {
  std::vector<Valued> corners;
  for (const int i : t) {
    const auto& p = sheet.points[i];
    if (!finite(p) || !std::isfinite(sheet.values[i])) return {};
    corners.push_back({p[0], p[1], p[2], sheet.values[i]});
  }
  if (!page.halved) return corners;
  std::vector<Valued> behind;
  for (int k = 0; k < 3; ++k) {
    const Valued& a = corners[k];
    const Valued& b = corners[(k + 1) % 3];
    const bool a_behind = a[page.across] >= page.at;
    if (a_behind) behind.push_back(a);
    if (a_behind == (b[page.across] >= page.at)) continue;
    const double part = (page.at - a[page.across]) / (b[page.across] - a[page.across]);
    Valued border{};
    for (int j = 0; j < 4; ++j) border[j] = a[j] + part * (b[j] - a[j]);
    behind.push_back(border);
  }
  return behind;
}

// Of what is drawn.
Axis axis_of_values(const SurfacePage& page) {
  Interval range;
  for (const SurfaceSheet& sheet : page.sheets) {
    for (const auto& t : sheet.triangles) {
      for (const Valued& corner : drawn_part(page, sheet, t)) range.include(corner[3]);
    }
  }
  return Axis(range);
}

// A patch has one colour. So a triangle is cut in two in the middle of the edge on which values
// differ most, as long as the difference is above `step` and the edge long enough to be seen: its
// place differs by more than `step`, too. Long thin triangles would look like spikes.
template <class Put>
void put_by_value(const std::array<Valued, 3>& t, const Valued& step, const Put& put) {
  const auto difference = [&](int k, int j) { return std::abs(t[k][j] - t[(k + 1) % 3][j]); };
  int k = 0;
  for (const int other : {1, 2}) {
    if (difference(other, 3) > difference(k, 3)) k = other;
  }
  const auto differs = [&](int j) { return difference(k, j) > step[j]; };
  if (!differs(3) || !(differs(0) || differs(1) || differs(2))) {
    put(t);
    return;
  }
  const Valued& a = t[k];
  const Valued& b = t[(k + 1) % 3];
  const Valued& c = t[(k + 2) % 3];
  Valued middle{};
  for (int j = 0; j < 4; ++j) middle[j] = 0.5 * (a[j] + b[j]);
  put_by_value({a, middle, c}, step, put);
  put_by_value({middle, b, c}, step, put);
}

// All patches of a page.
template <class Put>
void put_patches(const SurfacePage& page, const Valued& step, const Put& put) {
  for (const SurfaceSheet& sheet : page.sheets) {
    for (const auto& t : sheet.triangles) {
      const std::vector<Valued> piece = drawn_part(page, sheet, t);
      for (std::size_t k = 2; k < piece.size(); ++k) {
        put_by_value({piece[0], piece[k - 1], piece[k]}, step, put);
      }
    }
  }
}

// A triangle is a patch of two lines, of which one has become a point. Pieces with four corners are
// two of them: the light falls on other patches as if they were turned round.
void put_pieces(Script& script,
                const SurfacePage& page,
                const std::array<Axis, 3>& axes,
                const Axis& values) {
  // Colours that are told apart, and places: more patches look the same. A picture with 60,000 of
  // them takes ten seconds, so there are not many more of them than triangles.
  constexpr double kColors = 40;
  constexpr double kFewestColors = 5;
  constexpr double kPlaces = 150;
  std::size_t most = 10000;
  for (const SurfaceSheet& sheet : page.sheets) most += 2 * sheet.triangles.size();
  Valued step{axes[0].span() / kPlaces, axes[1].span() / kPlaces, axes[2].span() / kPlaces, 0};
  for (double colors = kColors; colors >= kFewestColors; colors /= 2) {
    step[3] = values.span() / colors;
    std::size_t patches = 0;
    put_patches(page, step, [&](const std::array<Valued, 3>&) { ++patches; });
    if (patches <= most) break;
  }
  const auto put = [&](const Valued& corner) {
    for (int k = 0; k < 3; ++k) script << number(axes[k].at(corner[k]), 7) << " ";
    script << number(corner[3], 5) << "\n";
  };
  script << "$surface << EOD\n";
  put_patches(page, step, [&](const std::array<Valued, 3>& patch) {
    put(patch[0]);
    put(patch[1]);
    script << "\n";
    put(patch[2]);
    put(patch[2]);
    script << "\n\n";
  });
  script << "EOD\n";
}

void draw_space(Script& script,
                const SurfacePage& page,
                const std::array<Axis, 3>& axes,
                const Axis& values) {
  constexpr std::array kLetters{"x", "y", "z"};
  constexpr double kSides = 420;  // a side of the box, seen from aside, on the canvas
  constexpr double kTics = 80;
  put_pieces(script, page, axes, values);
  script << "set lmargin -1\nset rmargin -1\nset bmargin -1\nset tmargin -1\n"
         << "set origin 0, 0\nset size 0.53, 0.95\nset border 127 lw 0.5 lc rgb '#9a9a9a'\n"
         << "set view 64, 40, 0.98, 1.2\nset xyplane 0\n"
         << "set pm3d depthorder noborder\n"
         << "set pm3d lighting primary 0.55 specular 0.25 spec2 0.1\n"
         << "set palette defined (0 '#30123b', 0.2 '#2f6fd6', 0.45 '#1fb8a8', 0.65 '#a2d84a', "
         << "0.85 '#f0a22e', 1 '#b5331f')\nset cbrange [" << number(values.lower, 6) << ":"
         << number(values.upper, 6) << "]\n"
         << "set colorbox user origin 0.53, 0.3 size 0.011, 0.36\nset cblabel "
         << quoted_markup(page.color) << " tc rgb '#000000'\nset cbtics tc rgb '#000000'\n"
         << "unset key\n";
  for (int k = 0; k < 3; ++k) {
    set_axis(script, kLetters[k], axes[k], kSides, kTics);
    script << "set " << kLetters[k] << "tics tc rgb '#000000' offset 0, -0.3\nset " << kLetters[k]
           << "label " << quoted_markup(axes[k].label(symbol(page.axes[k].name), page.axes[k].unit))
           << " tc rgb '#000000' offset 0, 0" << (k == 2 ? " rotate" : "") << "\n";
  }
  const auto row = [&](const std::array<double, 3>& p) {
    return Row{axes[0].at(p[0]), axes[1].at(p[1]), axes[2].at(p[2])};
  };
  Rows lines;
  Rows points;
  for (const auto& line : page.lines) {
    for (const auto& p : line) lines.push_back(row(p));
    lines.push_back(gap());
    lines.push_back(gap());
  }
  for (const auto& p : page.points) points.push_back(row(p));
  const std::string line_data = script.data(lines);
  const std::string point_data = script.data(points);
  script << "splot $surface using 1:2:3:4 with pm3d";
  if (!line_data.empty()) script << ", " << line_data << " with lines lw 2.5 lc rgb '#000000'";
  if (!point_data.empty()) {
    script << ", " << point_data << " with points pt 7 ps 1.4 lc rgb '#d7191c'";
  }
  script << "\n";
  script << "unset pm3d\nunset colorbox\nunset zlabel\n";
}

using Pieces = std::vector<std::array<std::array<double, 2>, 2>>;

// Lines on two of the axes, those of each sheet in its colour.
void draw_lines(Script& script,
                const Picture& picture,
                const Box& box,
                const SurfacePage& page,
                const std::array<Axis, 3>& axes,
                const std::array<int, 2>& on,
                const std::string& key,
                const std::vector<Pieces>& sheets) {
  Axis x = axes[on[0]];
  Axis y = axes[on[1]];
  constexpr double kMargin = 1.1;
  constexpr double kTics = 90;
  x.widen(kMargin);
  y.widen(kMargin);
  set_box(script, picture, box);
  script << "set border 3 lw 0.8 lc rgb '#000000'\nset xtics nomirror\nset ytics nomirror\n"
         << "set key " << key << " horizontal\nset grid lw 0.5 lc rgb '#e4e4e4'\n";
  set_axis(script, "x", x, box.width, kTics);
  set_axis(script, "y", y, box.height, kTics);
  const auto label = [&](const Axis& axis, int k) {
    return quoted_markup(axis.label(symbol(page.axes[k].name), page.axes[k].unit));
  };
  script << "set xlabel " << label(x, on[0]) << "\nset ylabel " << label(y, on[1]) << "\n";
  Plot plot(script, "plot", {x.lower, y.lower});
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    Rows rows;
    for (const auto& piece : sheets[i]) {
      for (const auto& end : piece) rows.push_back({x.at(end[0]), y.at(end[1])});
      rows.push_back(gap());
    }
    plot.add(rows, "with lines lw 1.4 " + line_color(i));
    if (!page.sheets[i].title.empty()) {
      plot.key("with lines lw 1.4 " + line_color(i), page.sheets[i].title);
    }
  }
  plot.draw();
}

void draw_section(Script& script,
                  const Picture& picture,
                  const SurfacePage& page,
                  const std::array<Axis, 3>& axes) {
  const Box box{925, 110, 430, 490};
  constexpr double kTitle = 100;  // above the box, with up to three rows of the legend between them
  constexpr double kLegend = 84;
  std::vector<Pieces> sheets;
  for (const SurfaceSheet& sheet : page.sheets) {
    sheets.push_back(section_of(sheet, page.across, page.at));
  }
  const double middle = box.x + box.width / 2;
  const double top = box.y + box.height;
  put_text(script,
           picture,
           middle,
           top + kTitle,
           "section at " + symbol(page.axes[page.across].name) + " = " + number(page.at, 4));
  const std::string key = "at screen " + number(middle / picture.width, 6) + ", screen " +
                          number((top + kLegend) / picture.height, 6) +
                          " center top maxcols 4 samplen 1.5";
  draw_lines(script, picture, box, page, axes, others(page.across), key, sheets);
}

void draw_curves(Script& script,
                 const Picture& picture,
                 const SurfacePage& page,
                 const std::array<Axis, 3>& axes) {
  std::vector<Pieces> sheets;
  for (const SurfaceSheet& sheet : page.sheets) {
    Pieces pieces;
    for (const auto& [i, j] : sheet.segments) {
      const auto& a = sheet.points[i];
      const auto& b = sheet.points[j];
      if (finite(a) && finite(b)) pieces.push_back({{{a[0], a[1]}, {b[0], b[1]}}});
    }
    sheets.push_back(std::move(pieces));
  }
  draw_lines(script,
             picture,
             {110, 90, 1200, 560},
             page,
             axes,
             {0, 1},
             "at screen 0.5, 0.92 center top",
             sheets);
}

}  // namespace

std::vector<std::array<std::array<double, 2>, 2>> section_of(const SurfaceSheet& sheet,
                                                             int across,
                                                             double at) {
  const auto [x, y] = others(across);
  std::vector<std::array<std::array<double, 2>, 2>> pieces;
  for (const auto& t : sheet.triangles) {
    std::vector<std::array<double, 2>> ends;
    for (int k = 0; k < 3; ++k) {
      const auto& a = sheet.points[t[k]];
      const auto& b = sheet.points[t[(k + 1) % 3]];
      if (!finite(a) || !finite(b) || (a[across] < at) == (b[across] < at)) continue;
      const double part = (at - a[across]) / (b[across] - a[across]);
      ends.push_back({a[x] + part * (b[x] - a[x]), a[y] + part * (b[y] - a[y])});
    }
    if (ends.size() == 2) pieces.push_back({ends[0], ends[1]});
  }
  return pieces;
}

std::string write_surfaces(const std::string& file, const SurfacePage& page) {
  constexpr double kLoopSeconds = 3;
  constexpr double kShortest = 0.06;
  Picture picture;
  picture.width = kWidth;
  picture.height = kHeight;
  picture.animated = page.growing;
  const std::size_t sheets = page.sheets.size();
  picture.frame_seconds = std::max(kShortest, kLoopSeconds / static_cast<double>(sheets));
  Script script;
  const std::array<Axis, 3> axes = axes_of(page);
  const Axis values = page.plane ? Axis(Interval{}) : axis_of_values(page);
  for (std::size_t shown = page.growing ? 1 : sheets; shown <= sheets; ++shown) {
    SurfacePage frame = page;
    frame.sheets.resize(shown);
    script << "set multiplot\n" << (page.growing ? "unset label\n" : "");
    put_text(script,
             picture,
             kWidth / 2,
             kHeight - 28,
             page.title + (page.subtitle.empty() ? "" : "   {/*0.8 " + page.subtitle + "}"));
    if (page.plane) {
      draw_curves(script, picture, frame, axes);
    } else {
      SurfacePage front = frame;
      if (page.growing) front.sheets.erase(front.sheets.begin(), front.sheets.end() - 1);
      draw_space(script, front, axes, values);
      clear_settings(script);
      draw_section(script, picture, frame, axes);
    }
    script << "unset multiplot\n";
  }
  picture.commands = script.text();
  return write_picture(file, picture);
}

}  // namespace carnot::plots
