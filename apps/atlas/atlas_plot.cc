#include "atlas/atlas_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/plots/isolines.h"
#include "carnot/plots/script.h"
#include "text/text_table.h"

namespace carnot::apps {

// The points of a slice: (i, j) of the two axes drawn.
struct AtlasPlot::Slice {
  std::string title;
  std::size_t across = 0;  // places of the axes drawn
  std::size_t up = 1;
  std::vector<long> points;  // i * count of `up` + j
};

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kLineColor = 0;
constexpr int kCutColor = 5;

// At most `count` of the indices below `size`, evenly spread.
std::vector<std::size_t> some_of(std::size_t size, std::size_t count) {
  std::vector<std::size_t> indices;
  const std::size_t shown = std::min(size, count);
  for (std::size_t k = 0; k < shown; ++k) {
    indices.push_back(shown == 1 ? 0 : (k * (size - 1) + (shown - 1) / 2) / (shown - 1));
  }
  return indices;
}

plots::Interval range_of(const std::vector<double>& values) {
  return {std::min(values.front(), values.back()), std::max(values.front(), values.back())};
}

std::string axis_label(const Axis& axis) {
  return plots::with_unit(plots::symbol(axis.name), axis.unit);
}

// Values at six neighbours in a row: whether there is a jump between the third and the fourth.
bool jumps(const std::array<double, 6>& p, double size) {
  constexpr double kTimes = 4;  // of the changes beside it
  constexpr double kLeast = 0.1;
  const double change = std::abs(p[3] - p[2]);
  const double beside = std::max(std::abs(p[2] - p[1]), std::abs(p[4] - p[3]));
  return change > kTimes * beside && change > kLeast * size;
}

// The same for a fall of the slope.
bool has_ridge(const std::array<double, 6>& d) {
  constexpr double kTimes = 3;  // of the bends beside it
  const auto bend = [&](std::size_t k) { return std::abs(d[k - 1] - 2 * d[k] + d[k + 1]); };
  const double fall = (d[2] - d[1]) - (d[4] - d[3]);
  return fall > kTimes * (bend(1) + bend(4));
}

}  // namespace

AtlasPlot::AtlasPlot(SceneInfo info, std::vector<Axis> axes, int n)
    : info_(std::move(info)), axes_(std::move(axes)), n_(n) {}

void AtlasPlot::add(const Json& record) {
  const Json& geodesics = record.at("geodesics");
  if (geodesics.empty()) {
    distance_.push_back(kNone);
    p0_.insert(p0_.end(), static_cast<std::size_t>(n_), kNone);
    return;
  }
  const Json& least = geodesics[0];
  lengths_ = lengths_ && !least.at("length").is_null();
  distance_.push_back(least.at(lengths_ ? "length" : "action").get<double>());
  for (const Json& p : least.at("p0")) p0_.push_back(p.get<double>());
}

std::vector<AtlasPlot::Slice> AtlasPlot::slices() const {
  constexpr std::size_t kMost = 6;
  Slice one;
  const auto place_of = [&](int coordinate, std::size_t otherwise) {
    const auto found = std::find_if(axes_.begin(), axes_.end(), [&](const Axis& axis) {
      return axis.coordinate == coordinate;
    });
    return found == axes_.end() ? otherwise : static_cast<std::size_t>(found - axes_.begin());
  };
  one.across = place_of(info_.drawing.axes[0], 0);
  one.up = place_of(info_.drawing.axes[1], 1);
  if (one.across == one.up) {
    one.across = 0;
    one.up = 1;
  }
  std::vector<std::size_t> at(axes_.size());
  for (std::size_t a = 0; a < axes_.size(); ++a) at[a] = axes_[a].values.size() / 2;
  std::size_t through = axes_.size();  // the axis whose values make the slices
  for (std::size_t a = axes_.size(); a-- > 0;) {
    if (a != one.across && a != one.up) through = a;
  }
  const auto cuts =
      through < axes_.size() ? some_of(axes_[through].values.size(), kMost) : some_of(1, 1);
  std::vector<Slice> list;
  for (const std::size_t cut : cuts) {
    if (through < axes_.size()) at[through] = cut;
    Slice slice = one;
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      if (a == slice.across || a == slice.up) continue;
      slice.title += fmt::format("{}{} = {}",
                                 slice.title.empty() ? "" : ", ",
                                 plots::symbol(axes_[a].name),
                                 text_number(axes_[a].values[at[a]], 3));
    }
    std::vector<std::size_t> point = at;
    for (point[slice.across] = 0; point[slice.across] < axes_[slice.across].values.size();
         ++point[slice.across]) {
      for (point[slice.up] = 0; point[slice.up] < axes_[slice.up].values.size();
           ++point[slice.up]) {
        long index = 0;
        for (std::size_t a = 0; a < axes_.size(); ++a) {
          index = index * static_cast<long>(axes_[a].values.size()) + static_cast<long>(point[a]);
        }
        slice.points.push_back(index);
      }
    }
    list.push_back(std::move(slice));
  }
  return list;
}

std::vector<double> AtlasPlot::distances(const Slice& slice) const {
  std::vector<double> values;
  for (const long i : slice.points) values.push_back(distance_[i]);
  return values;
}

// A ridge of the distance alone may be a bend that the grid does not resolve; a jump of p(0) alone
// is met everywhere where the slice lies in the cut locus.
bool AtlasPlot::is_cut(const Slice& slice, std::size_t first, std::size_t stride) const {
  std::array<double, 6> values;
  for (std::size_t m = 0; m < 6; ++m) values[m] = distance_[slice.points[first + m * stride]];
  if (!has_ridge(values)) return false;
  const auto momentum = [&](std::size_t m, int c) {
    return p0_[slice.points[first + m * stride] * n_ + c];
  };
  double size = 0;
  for (int c = 0; c < n_; ++c) size = std::max(size, std::abs(momentum(2, c)));
  for (int c = 0; c < n_; ++c) {
    for (std::size_t m = 0; m < 6; ++m) values[m] = momentum(m, c);
    if (jumps(values, size)) return true;
  }
  return false;
}

plots::Series AtlasPlot::cut_locus(const Slice& slice) const {
  const std::vector<double>& x = axes_[slice.across].values;
  const std::vector<double>& y = axes_[slice.up].values;
  plots::Series cut;
  cut.color = kCutColor;
  cut.mark = plots::Series::Mark::kDots;
  cut.width = 4;
  const auto add = [&](double px, double py) {
    cut.x.push_back(px);
    cut.y.push_back(py);
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < y.size(); ++j) {
      const std::size_t k = i * y.size() + j;
      if (i + 5 < x.size() && is_cut(slice, k, y.size())) add(0.5 * (x[i + 2] + x[i + 3]), y[j]);
      if (j + 5 < y.size() && is_cut(slice, k, 1)) add(x[i], 0.5 * (y[j + 2] + y[j + 3]));
    }
  }
  return cut;
}

plots::Series AtlasPlot::isolines(const Slice& slice, double step, double largest) const {
  plots::Series lines;
  lines.color = kLineColor;
  lines.width = 1.2;
  const std::vector<double> values = distances(slice);
  for (int level = 1; level * step < largest; ++level) {
    const plots::Isoline line =
        plots::isoline(axes_[slice.across].values, axes_[slice.up].values, values, level * step);
    lines.x.insert(lines.x.end(), line.x.begin(), line.x.end());
    lines.y.insert(lines.y.end(), line.y.begin(), line.y.end());
  }
  return lines;
}

std::string AtlasPlot::draw(const std::string& file) const {
  constexpr int kLevels = 16;
  const std::vector<Slice> list = slices();
  double largest = 0;
  for (const Slice& slice : list) {
    for (const double d : distances(slice))
      largest = std::isfinite(d) ? std::max(largest, d) : largest;
  }
  const double step = plots::tic_step(plots::Axis({0, std::max(largest, 1e-300)}), kLevels, 3);
  plots::SeriesPage page;
  page.title = plots::escaped(fmt::format("{}: {}", info_.name, lengths_ ? "distance" : "action"));
  page.subtitle = fmt::format("a line every {}", text_number(step));
  bool named = false;  // once is enough for the legend
  for (const Slice& slice : list) {
    const Axis& across = axes_[slice.across];
    const Axis& up = axes_[slice.up];
    plots::SeriesPanel panel;
    panel.title = slice.title;
    panel.x.label = axis_label(across);
    panel.y.label = axis_label(up);
    panel.x.range = range_of(across.values);
    panel.y.range = range_of(up.values);
    panel.equal_axes = across.unit == up.unit;
    plots::Series cut = cut_locus(slice);
    if (!cut.x.empty() && !named) {
      cut.title = "cut locus";
      panel.legend = plots::Legend::kTopRight;
      named = true;
    }
    panel.series = {isolines(slice, step, largest), std::move(cut)};
    page.panels.push_back(std::move(panel));
  }
  return plots::write_series(file, page);
}

}  // namespace carnot::apps
