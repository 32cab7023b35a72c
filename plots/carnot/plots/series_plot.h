// Numbers against numbers: convergence, drift, growth, work against precision.
//
// A page holds panels in a row, or in several. Each panel has its own axes, linear or logarithmic,
// series drawn as lines, points or both, and dashed lines of a given slope to compare them with.
// All texts are markup (script.h).
#pragma once

#include <string>
#include <vector>

#include "carnot/plots/page.h"
#include "carnot/plots/plot_file.h"

namespace carnot::plots {

// A value that is not finite makes a gap, and so does one that is not positive (or not within 100
// decades of 1) where the axis is logarithmic.
struct Series {
  enum class Mark { kLine, kPoints, kLineAndPoints, kDots };

  std::string title;  // empty: not in the legend
  std::vector<double> x;
  std::vector<double> y;
  Mark mark = Mark::kLine;
  int color = -1;  // of line_color(); -1: the place among the series
  bool dashed = false;
  double width = 1.8;
};

// The straight line of the drawn scales through (x, y), as far as x_end: y + slope (X - x), and
// where the axes are logarithmic y exp(slope (X - x)) (only y), y (X/x)^slope (both),
// y + slope log10(X/x) (only x).
struct SlopeLine {
  std::string title;
  double slope = 1;
  double x = 1;
  double y = 1;
  double x_end = 2;
};

// A text centred at a point of the axes.
struct Note {
  double x = 0;
  double y = 0;
  std::string text;
};

struct Scale {
  std::string label;
  bool logarithmic = false;
  Interval range{};  // empty: that of the series
};

enum class Legend { kRight, kTopLeft, kTopRight, kBottomLeft, kBottomRight };

struct SeriesPanel {
  std::string title;
  Scale x;
  Scale y;
  std::vector<Series> series;
  std::vector<SlopeLine> slopes;
  std::vector<Note> notes;
  Legend legend = Legend::kRight;  // beside the panel, or inside in a corner
  bool equal_axes = false;         // one scale, for paths in the plane; linear axes only
  bool frame = true;               // axes, tics and grid
};

struct SeriesPage {
  std::string title;
  std::string subtitle;
  std::vector<SeriesPanel> panels;
  std::size_t columns = 3;  // at most; further panels go to the next row
  double width = 440;       // inside of each panel
  double height = 380;
};

Picture series_picture(const SeriesPage& page);

// Throws std::invalid_argument for a bad file name (see validate_plot_file), a page without panels
// or a series with as many x as y is not; std::runtime_error when gnuplot fails. The file appears
// whole or not at all. Returns gnuplot's warnings, usually none.
std::string write_series(const std::string& file, const SeriesPage& page);

}  // namespace carnot::plots
