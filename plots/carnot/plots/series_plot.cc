#include "carnot/plots/series_plot.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "carnot/plots/curve.h"

namespace carnot::plots {
namespace {

constexpr std::size_t kMostPoints = 4000;  // more than a page can show only swell the file
constexpr double kLeft = 100;              // axis label and numbers
constexpr double kLabelHeight = 65;        // axis label
constexpr double kPanelTitle = 30;
constexpr double kMostDecades = 100;  // about 1: beyond, gnuplot's own arithmetic overflows

// Drawn values of one axis.
struct Range {
  Axis axis{Interval{}};
  bool logarithmic = false;

  [[nodiscard]] bool shows(double x) const {
    return !logarithmic || (x > 0 && std::abs(std::log10(x)) <= kMostDecades);
  }
  [[nodiscard]] double at(double x) const { return logarithmic ? x : axis.at(x); }
};

// A little more than the values, and enough for 1, 2 or 5 times a power of ten to be among them.
// `values` are exponents.
void set_decades(Axis& axis, Interval values) {
  constexpr double kMargin = 0.05;
  constexpr double kLeast = 0.4;
  if (values.empty()) values = {0, 1};
  const double margin = std::max(kMargin * values.span(), (kLeast - values.span()) / 2);
  axis.lower = std::pow(10.0, values.lower - margin);
  axis.upper = std::pow(10.0, values.upper + margin);
}

Range range_of(const Scale& scale, const std::vector<const std::vector<double>*>& columns) {
  constexpr double kMargin = 1.06;
  Range range;
  range.logarithmic = scale.logarithmic;
  Interval values;
  const auto include = [&](double x) {
    if (range.shows(x)) values.include(scale.logarithmic ? std::log10(x) : x);
  };
  for (const std::vector<double>* column : columns) {
    if (!scale.range.empty()) break;
    for (const double x : *column) include(x);
  }
  if (!scale.range.empty()) {
    include(scale.range.lower);
    include(scale.range.upper);
  }
  if (scale.logarithmic) {
    set_decades(range.axis, values);
  } else {
    range.axis = Axis(values);
    if (scale.range.empty()) range.axis.widen(kMargin);
  }
  return range;
}

struct Ranges {
  Range x;
  Range y;

  Ranges(const SeriesPanel& panel, const Box& box) {
    std::vector<const std::vector<double>*> xs;
    std::vector<const std::vector<double>*> ys;
    for (const Series& series : panel.series) {
      xs.push_back(&series.x);
      ys.push_back(&series.y);
    }
    x = range_of(panel.x, xs);
    y = range_of(panel.y, ys);
    if (!panel.equal_axes) return;
    const double unit = std::max(x.axis.span() / box.width, y.axis.span() / box.height);
    x.axis.widen_to(unit * box.width);
    y.axis.widen_to(unit * box.height);
  }

  [[nodiscard]] Row at(double px, double py) const {
    const bool shown = x.shows(px) && y.shows(py);
    return shown ? Row{x.at(px), y.at(py)} : gap();
  }
};

Rows rows_of(const Series& series, const Ranges& ranges) {
  Rows rows;
  for (const std::size_t i : spread(series.x.size(), kMostPoints)) {
    rows.push_back(ranges.at(series.x[i], series.y[i]));
  }
  return rows;
}

Rows rows_of(const SlopeLine& line, const Ranges& ranges) {
  const bool log_x = ranges.x.logarithmic;
  const bool log_y = ranges.y.logarithmic;
  const double along = log_x ? std::log(line.x_end / line.x) : line.x_end - line.x;
  const double rise = line.slope * (log_x && !log_y ? along / std::log(10.0) : along);
  const double end = log_y ? line.y * std::exp(rise) : line.y + rise;
  return {ranges.at(line.x, line.y), ranges.at(line.x_end, end)};
}

std::string style_of(const Series& series, std::size_t place) {
  constexpr std::size_t kSymbols = 5;
  static constexpr int kSymbol[kSymbols] = {7, 5, 9, 13, 11};  // filled, all of one weight
  const std::size_t color = series.color < 0 ? place : static_cast<std::size_t>(series.color);
  std::string paint = " " + line_color(color);
  if (series.dashed) paint = paint.substr(0, paint.find(" dt")) + " dt (7,5)";
  const std::string line = " lw " + number(series.width, 3) + paint;
  const std::string symbol = " pt " + std::to_string(kSymbol[color % kSymbols]);
  switch (series.mark) {
    case Series::Mark::kPoints:
      return "with points ps 0.8" + symbol + line;
    case Series::Mark::kLineAndPoints:
      return "with linespoints ps 0.8" + symbol + line;
    case Series::Mark::kDots:
      return "with points ps 0.16 pt 7" + line;
    default:
      return "with lines" + line;
  }
}

// What the legend takes to the right of the panel.
double legend_width(const SeriesPanel& panel) {
  constexpr double kSample = 60;
  double widest = 0;
  if (panel.legend == Legend::kRight) {
    for (const Series& series : panel.series) widest = std::max(widest, text_width(series.title));
    for (const SlopeLine& line : panel.slopes) widest = std::max(widest, text_width(line.title));
  }
  return widest == 0 ? 0 : widest + kSample;
}

void set_legend(Script& script, const Picture& page, Legend legend, const Box& box) {
  constexpr double kBesides = 14;
  constexpr double kInside = 10;
  const bool right = legend == Legend::kTopRight || legend == Legend::kBottomRight;
  const bool top = legend == Legend::kTopLeft || legend == Legend::kTopRight;
  script << "set key at screen ";
  if (legend == Legend::kRight) {
    script << (box.x + box.width + kBesides) / page.width << ", screen "
           << (box.y + box.height) / page.height << " left top";
  } else {
    script << (right ? box.x + box.width - kInside : box.x + kInside) / page.width << ", screen "
           << (top ? box.y + box.height - kInside : box.y + kInside) / page.height
           << (right ? " right" : " left") << (top ? " top" : " bottom")
           << " opaque fillcolor rgb '#ffffff'";
  }
  script << " vertical Left reverse samplen 1.6\n";
}

// Tics at powers of ten, about one per `spacing`; where the axis has room for less than two of
// them, at 1, 2 and 5 times a power. All by name: gnuplot's own small tics of a step of 10^8 take
// forever.
void set_log_tics(
    Script& script, const std::string& letter, const Axis& axis, double size, double spacing) {
  const double lower = std::log10(axis.lower);
  const double upper = std::log10(axis.upper);
  const bool decades = std::floor(upper) - std::ceil(lower) >= 1;
  const double every = std::max(1.0, std::ceil((upper - lower) * spacing / size));
  script << "set logscale " << letter << "\nset format " << letter
         << (decades ? " '10^{%T}'\n" : " '%h'\n") << "set " << letter << "tics (";
  std::string separator;
  const auto add = [&](double x, bool named) {
    if (x < axis.lower || x > axis.upper) return;
    script << separator << (named ? "" : "'' ") << number(x, 3) << (named ? "" : " 1");
    separator = ", ";
  };
  for (double exponent = std::floor(lower); exponent <= upper; ++exponent) {
    const double power = std::pow(10.0, exponent);
    add(power, !decades || std::fmod(exponent, every) == 0);
    for (int m = 2; m < 10 && every == 1; ++m) add(m * power, !decades && (m == 2 || m == 5));
  }
  script << ")\n";
}

// Range, tics, their format and the label of one axis.
void set_scale(Script& script,
               const std::string& letter,
               const Range& range,
               const Scale& scale,
               double size) {
  const double spacing = letter == "x" ? 80 : 50;
  set_axis(script, letter, range.axis, size, spacing);
  script << "set format " << letter << " '%h'\n";
  if (range.logarithmic) set_log_tics(script, letter, range.axis, size, spacing);
  const std::string label = range.logarithmic ? scale.label : range.axis.label(scale.label, "");
  script << "set " << letter << "label " << quoted_markup(label) << "\n";
}

void draw_panel(Script& script, const Picture& page, const SeriesPanel& panel, const Box& box) {
  const Ranges ranges(panel, box);
  if (!panel.title.empty()) {
    put_text(script, page, box.x + box.width / 2, box.y + box.height + 18, panel.title);
  }
  set_box(script, page, box);
  set_scale(script, "x", ranges.x, panel.x, box.width);
  set_scale(script, "y", ranges.y, panel.y, box.height);
  if (panel.frame) {
    script << "set grid lc rgb '#e4e4e4' lt 1 lw 0.6\nset tics nomirror out scale 0.6\n"
           << "set border 3 lw 1\n";
  } else {
    script << "unset tics\nunset border\n";
  }
  set_legend(script, page, panel.legend, box);
  for (const Note& note : panel.notes) {
    const Row at = ranges.at(note.x, note.y);
    if (at.empty()) continue;
    script << "set label " << quoted_markup(note.text) << " at " << at[0] << ", " << at[1]
           << " center\n";
  }
  Plot plot(script, "plot", {ranges.x.axis.lower, ranges.y.axis.lower});
  const auto add = [&](const Rows& rows, const std::string& style, const std::string& title) {
    plot.add(rows, style);
    if (title.empty()) return;
    const std::size_t dots = style.find("ps 0.16");  // too small for a legend
    plot.key(dots == std::string::npos ? style : std::string(style).replace(dots, 7, "ps 0.6"),
             title);
  };
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    add(rows_of(panel.series[i], ranges), style_of(panel.series[i], i), panel.series[i].title);
  }
  for (const SlopeLine& line : panel.slopes) {
    add(rows_of(line, ranges), "with lines lw 1.2 lc rgb '#606060' dt (7,5)", line.title);
  }
  plot.draw();
  clear_settings(script);
}

void validate(const SeriesPage& page) {
  if (page.panels.empty() || page.columns == 0) {
    throw std::invalid_argument("a plot of series needs a panel");
  }
  for (const SeriesPanel& panel : page.panels) {
    for (const Series& series : panel.series) {
      if (series.x.size() != series.y.size()) {
        throw std::invalid_argument("series '" + series.title + "' has " +
                                    std::to_string(series.x.size()) + " x and " +
                                    std::to_string(series.y.size()) + " y");
      }
    }
  }
}

}  // namespace

Picture series_picture(const SeriesPage& what) {
  constexpr double kRight = 30;
  const double above = what.subtitle.empty() ? 50 : 78;
  const std::size_t columns = std::min(what.columns, what.panels.size());
  const std::size_t rows = (what.panels.size() + columns - 1) / columns;
  std::vector<double> legends(columns, 0);  // widths
  bool titled = false;
  for (std::size_t i = 0; i < what.panels.size(); ++i) {
    double& width = legends[i % columns];
    width = std::max(width, legend_width(what.panels[i]));
    titled = titled || !what.panels[i].title.empty();
  }
  const double row_height = what.height + kLabelHeight + (titled ? kPanelTitle : 0);
  Picture page;
  page.width = kRight;
  for (const double legend : legends) page.width += kLeft + what.width + legend;
  page.height = static_cast<double>(rows) * row_height + above;
  Script script;
  script << "set multiplot\n";
  put_text(script, page, page.width / 2, page.height - 25, what.title, "center font ',15'");
  put_text(script, page, page.width / 2, page.height - 53, what.subtitle);
  double x = 0;
  for (std::size_t i = 0; i < what.panels.size(); ++i) {
    const std::size_t column = i % columns;
    const std::size_t row = i / columns;
    if (column == 0) x = 0;
    const double y = static_cast<double>(rows - 1 - row) * row_height + kLabelHeight;
    draw_panel(script, page, what.panels[i], {x + kLeft, y, what.width, what.height});
    x += kLeft + what.width + legends[column];
  }
  script << "unset multiplot\n";
  page.commands = script.text();
  return page;
}

std::string write_series(const std::string& file, const SeriesPage& page) {
  validate_plot_file(file);
  validate(page);
  return write_picture(file, series_picture(page));
}

}  // namespace carnot::plots
