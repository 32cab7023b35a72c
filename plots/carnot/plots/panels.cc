#include "carnot/plots/panels.h"

#include <algorithm>

namespace carnot::plots {
namespace {

constexpr std::size_t kMostPanels = 6;

constexpr double kLeft = 90;    // axis label and numbers
constexpr double kRight = 125;  // colour bar
constexpr double kBelow = 100;  // axis label, legend
constexpr double kAbove = 75;   // title
constexpr double kGapX = 60;
constexpr double kGapY = 72;

struct Grid {
  std::size_t columns, rows;

  explicit Grid(std::size_t panels)
      : columns(panels <= 3   ? panels
                : panels == 4 ? 2
                              : 3),
        rows((panels + columns - 1) / columns) {}
  [[nodiscard]] double page_width() const {
    return columns == 1 ? 900 : columns == 2 ? 1000 : 1200;
  }
  [[nodiscard]] double panel_width() const {
    const auto n = static_cast<double>(columns);
    return (page_width() - kLeft - kRight - (n - 1) * kGapX) / n;
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

double panel_width(std::size_t panels) { return Grid(panels).panel_width(); }

void put_title(Script& script, const Picture& page, const SceneInfo& info, const Curve& curve) {
  const double middle = page.width / 2;
  put_text(script, page, middle, page.height - 25, heading(info, curve), "center font ',15'");
  put_text(script, page, middle, page.height - 52, numbers_line(info, curve));
}

void draw_legend(Script& script,
                 const Picture& page,
                 double x,
                 const std::vector<LegendEntry>& entries) {
  constexpr double kMiddle = 20;
  constexpr double kHalfEntry = 95;  // about half the width of an entry
  const double half = kHalfEntry * static_cast<double>(entries.size());
  if (2 * half < page.width) x = std::clamp(x, half, page.width - half);
  clear_settings(script);
  script << "unset tics\nunset border\nset xrange [0:1]\nset yrange [0:1]\n";
  set_box(script, page, {0, 0, page.width, page.height});  // room for a single row
  script << "set key at screen " << x / page.width << ", screen " << kMiddle / page.height
         << " center center horizontal maxrows 1 Left reverse samplen 2 width -2\n";
  Plot plot(script, "plot", {0, 0});
  for (const LegendEntry& entry : entries) plot.key(entry.style, entry.title);
  plot.draw();
  clear_settings(script);
}

void set_time_colors(Script& script, const Picture& page, const Interval& times, const Box& bar) {
  Axis axis(times);
  axis.lower += axis.offset;  // colours are of t itself
  axis.upper += axis.offset;
  script << TimeColors::palette();
  set_axis(script, "cb", axis, bar.height, 60);
  script << "set cblabel 't [time]'\nset cbtics scale 0.4\n"
         << "set colorbox user origin screen " << bar.x / page.width << ", screen "
         << bar.y / page.height << " size screen " << bar.width / page.width << ", screen "
         << bar.height / page.height << " noborder\n";
}

Picture draw_panels(const SceneInfo& info,
                    const std::vector<Curve>& curves,
                    double height,
                    const std::vector<LegendEntry>& legend,
                    const DrawPanel& draw) {
  const std::vector<Curve> shown = shown_curves(curves);
  const Grid grid(shown.size());
  const auto rows = static_cast<double>(grid.rows);
  const double all_rows = rows * height + (rows - 1) * kGapY;
  Picture page;
  page.width = grid.page_width();
  page.height = kBelow + all_rows + kAbove;
  Script script;
  script << "set multiplot\nset key off\n";
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const std::size_t row = i / grid.columns;
    const std::size_t column = i % grid.columns;
    const Panel panel{{kLeft + static_cast<double>(column) * (grid.panel_width() + kGapX),
                       kBelow + (rows - 1 - static_cast<double>(row)) * (height + kGapY),
                       grid.panel_width(),
                       height},
                      column == 0,
                      i + grid.columns >= shown.size()};
    if (i == 0) {
      const Box bar{page.width - kRight + 22, kBelow, 14, all_rows};
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
  draw_legend(script, page, page.width / 2, legend);
  script << "unset multiplot\n";
  page.commands = script.text();
  return page;
}

}  // namespace carnot::plots
