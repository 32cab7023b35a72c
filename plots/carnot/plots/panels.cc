#include "carnot/plots/panels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace carnot::plots {
namespace {

constexpr std::size_t kMostPanels = 6;

struct Grid {
  std::size_t columns, rows;

  explicit Grid(std::size_t panels)
      : columns(panels <= 3   ? panels
                : panels == 4 ? 2
                              : 3),
        rows((panels + columns - 1) / columns) {}
  [[nodiscard]] double usual_width() const {
    return columns == 1 ? 900 : columns == 2 ? 1000 : 1200;
  }
};

void put_page_title(Script& script, const Picture& page, const SceneInfo& info, std::size_t all) {
  std::string title = info.name + ": ";
  if (all > kMostPanels) title += "first " + std::to_string(kMostPanels) + " of ";
  title = escaped(title + std::to_string(all) + " extremals");
  put_text(script, page, page.width / 2, page.height - 25, title, "center font ',15'");
}

void put_panel_title(
    Script& script, const Picture& page, const Box& box, const Curve& curve, std::size_t i) {
  const std::string name = curve.name.empty() ? std::to_string(i + 1) : curve.name;
  std::string text = name + ": action " + number(curve.action, 6);
  if (curve.length) text += ", length " + number(*curve.length, 5);
  put_text(script, page, box.x + box.width / 2, box.y + box.height + 18, escaped(text));
}

// A line style for a line of two points alone: gnuplot gives it straight ends.
std::string sample(std::string style) {
  const std::string lines = "with lines";
  return style.replace(style.find(lines), lines.size(), "with vectors nohead");
}

}  // namespace

std::vector<Curve> shown_curves(const std::vector<Curve>& curves) {
  const std::size_t n = std::min(curves.size(), kMostPanels);
  return {curves.begin(), curves.begin() + static_cast<std::ptrdiff_t>(n)};
}

Interval times_of(const std::vector<Curve>& curves) {
  Interval times;
  for (const Curve& curve : curves) {
    for (const double t : curve.trajectory->t) times.include(t);
  }
  return times;
}

double panel_room(std::size_t panels, const Sheet& sheet) {
  const Grid grid(panels);
  const auto n = static_cast<double>(grid.columns);
  return (grid.usual_width() - sheet.left - sheet.right - (n - 1) * sheet.gap_x) / n;
}

void put_title(Script& script, const Picture& page, const SceneInfo& info, const Curve& curve) {
  const double middle = page.width / 2;
  put_text(script, page, middle, page.height - 25, heading(info, curve), "center font ',15'");
  put_text(script, page, middle, page.height - 52, numbers_line(info, curve));
}

void draw_legend(Script& script,
                 const Picture& page,
                 double x,
                 double width,
                 const std::vector<LegendEntry>& entries) {
  constexpr double kSample = 34;  // of the line
  constexpr double kSpace = 9;    // between a sample and its title
  constexpr double kGap = 30;     // between entries
  constexpr double kRow = 22;
  constexpr double kLowest = 18;
  // Rows of entries, filled one after the other.
  std::vector<std::vector<LegendEntry>> rows(1);
  std::vector<double> widths = {0};
  const auto width_of = [](const LegendEntry& entry) {
    return kSample + kSpace + text_width(entry.title);
  };
  for (const LegendEntry& entry : entries) {
    const double more = width_of(entry) + (rows.back().empty() ? 0 : kGap);
    if (!rows.back().empty() && widths.back() + more > width) {
      rows.emplace_back();
      widths.push_back(0);
    }
    widths.back() += rows.back().empty() ? width_of(entry) : more;
    rows.back().push_back(entry);
  }
  clear_settings(script);
  script << "unset tics\nunset border\nset key off\n";
  script << "set xrange [0:" << page.width << "]\nset yrange [0:" << page.height << "]\n";
  set_box(script, page, {0, 0, page.width, page.height});
  std::vector<std::pair<Rows, std::string>> samples;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = kLowest + kRow * static_cast<double>(rows.size() - 1 - i);
    const double half = widths[i] / 2;
    const bool fits = 2 * half < page.width;
    double at = std::round((fits ? std::clamp(x, half, page.width - half) : page.width / 2) - half);
    for (const LegendEntry& entry : rows[i]) {
      if (!entry.line.empty()) samples.push_back({{{at, y, kSample, 0}}, sample(entry.line)});
      for (const std::string& point : entry.points) {
        samples.push_back({{{at + kSample / 2, y}}, point});
      }
      put_text(script, page, at + kSample + kSpace, y, entry.title, "left");
      at += std::round(width_of(entry) + kGap);
    }
  }
  Plot plot(script, "plot", {0, 0});
  for (const auto& [points, style] : samples) plot.add(points, style);
  plot.draw();
  clear_settings(script);
}

void set_time_colors(Script& script, const Picture& page, const Interval& times, const Box& bar) {
  Axis axis(times);
  axis.lower += axis.offset;  // colours are of t itself
  axis.upper += axis.offset;
  script << TimeColors::palette();
  set_axis(script, "cb", axis, bar.height, 60);
  script << "set cblabel 't [time]'\nset cbtics nomirror out scale 0.4\n"
         << "set colorbox user origin screen " << bar.x / page.width << ", screen "
         << bar.y / page.height << " size screen " << bar.width / page.width << ", screen "
         << bar.height / page.height << " noborder\n";
}

Picture draw_panels(const SceneInfo& info,
                    const std::vector<Curve>& curves,
                    const Sheet& sheet,
                    double width,
                    double height,
                    const std::vector<LegendEntry>& legend,
                    const DrawPanel& draw) {
  constexpr double kLeastWidth = 660;  // for the title
  const std::vector<Curve> shown = shown_curves(curves);
  const Grid grid(shown.size());
  const auto rows = static_cast<double>(grid.rows);
  const auto columns = static_cast<double>(grid.columns);
  const double all_rows = rows * height + (rows - 1) * sheet.gap_y;
  const double all_columns = columns * width + (columns - 1) * sheet.gap_x;
  Picture page;
  page.width = std::max(kLeastWidth, sheet.left + all_columns + sheet.right);
  page.height = sheet.below + all_rows + sheet.above;
  const double left = sheet.left + (page.width - sheet.left - all_columns - sheet.right) / 2;
  Script script;
  script << "set multiplot\nset key off\n";
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const std::size_t row = i / grid.columns;
    const std::size_t column = i % grid.columns;
    const Panel panel{{left + static_cast<double>(column) * (width + sheet.gap_x),
                       sheet.below + (rows - 1 - static_cast<double>(row)) * (height + sheet.gap_y),
                       width,
                       height},
                      column == 0,
                      i + grid.columns >= shown.size()};
    if (i == 0) {
      const Box bar{left + all_columns + 22, sheet.below, 14, all_rows};
      set_time_colors(script, page, times_of(shown), bar);
    } else {
      script << "unset colorbox\nunset label\n";
    }
    if (shown.size() == 1) {
      put_title(script, page, info, shown[0]);
    } else {
      if (i == 0) put_page_title(script, page, info, curves.size());
      put_panel_title(script, page, panel.box, shown[i], i);
    }
    draw(script, page, shown[i], panel);
  }
  draw_legend(script, page, page.width / 2, page.width - 40, legend);
  script << "unset multiplot\n";
  page.commands = script.text();
  return page;
}

}  // namespace carnot::plots
