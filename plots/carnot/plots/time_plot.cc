#include "carnot/plots/time_plot.h"

#include <algorithm>
#include <cmath>

#include "carnot/plots/panels.h"
#include "carnot/plots/units.h"

namespace carnot::plots {
namespace {

constexpr double kGap = 16;  // between panels

struct Line {
  std::string title;  // markup
  Rows points;        // (t, value)
};

struct TimePanel {
  std::string label;  // markup
  std::vector<Line> lines;
  Rows zeros;  // points near the lower edge
  Axis values{Interval{}};
  bool logarithmic = false;
  std::vector<std::pair<double, double>> shaded;  // times at a limit
};

// Column i of q, p or lambda for each i.
TimePanel columns(const std::string& label,
                  const Trajectory& trajectory,
                  const std::vector<std::vector<double>>& values,
                  const std::vector<std::string>& titles) {
  TimePanel panel;
  Interval range;
  for (std::size_t i = 0; i < titles.size(); ++i) {
    Line line{titles[i], {}};
    for (std::size_t row = 0; row < values.size(); ++row) {
      line.points.push_back({trajectory.t[row], values[row][i]});
      range.include(values[row][i]);
    }
    panel.lines.push_back(line);
  }
  panel.values = Axis(range);
  panel.values.widen(1.12);
  panel.label = panel.values.label(label, "");
  for (Line& line : panel.lines) {
    for (Row& row : line.points) row[1] = panel.values.at(row[1]);
  }
  return panel;
}

// Whether H depends on time along one of the curves.
bool has_work(const std::vector<Curve>& curves) {
  return std::any_of(curves.begin(), curves.end(), [](const Curve& curve) {
    const std::vector<double>& work = curve.trajectory->work;
    return std::any_of(work.begin(), work.end(), [](double x) { return x != 0; });
  });
}

// What is shown as the error, in markup.
std::string energy_error(const std::vector<Curve>& curves) {
  return has_work(curves) ? "|H − H(0) − ∫H_{t} dt|" : "|H − H(0)|";
}

// By how much H is not what it should be. Where it depends on time, it should change by its work.
double energy_error(const Trajectory& trajectory, std::size_t row) {
  const double change = trajectory.hamiltonian[row] - trajectory.hamiltonian.front();
  if (trajectory.work.empty()) return std::abs(change);
  return std::abs(change - (trajectory.work[row] - trajectory.work.front()));
}

// The error on a logarithmic axis. The line leaves out what is exactly 0; dots above the lower
// edge stand for it, but for the first time, where it is 0 by definition.
TimePanel energy(const std::vector<Curve>& curves, const std::vector<std::string>& titles) {
  TimePanel panel;
  panel.label = with_unit("error", "energy");
  panel.logarithmic = true;
  Interval range;  // of the exponent
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const Trajectory& trajectory = *curves[c].trajectory;
    Line line{titles[c], {}};
    for (std::size_t row = 0; row < trajectory.t.size(); ++row) {
      const double error = energy_error(trajectory, row);
      if (error == 0) {
        if (row > 0) panel.zeros.push_back({trajectory.t[row], 0});
      } else {
        line.points.push_back({trajectory.t[row], error});
        range.include(std::log10(error));
      }
    }
    panel.lines.push_back(line);
  }
  if (range.empty()) range = {-16, -16};
  const double floor = std::floor(range.lower) - 1;
  panel.values.lower = std::pow(10.0, floor);
  panel.values.upper = std::pow(10.0, std::max(std::floor(range.upper) + 1, floor + 3));
  const double lifted = floor + 0.05 * std::log10(panel.values.upper / panel.values.lower);
  for (Row& row : panel.zeros) row[1] = std::pow(10.0, lifted);
  return panel;
}

std::vector<TimePanel> panels_of(const SceneInfo& info, const Curve& curve, const TimePanels& on) {
  const Trajectory& trajectory = *curve.trajectory;
  const std::size_t k = trajectory.lambda.empty() ? 0 : trajectory.lambda.front().size();
  std::vector<std::string> q;
  std::vector<std::string> p;
  std::vector<std::string> lambda;
  for (std::size_t i = 0; i < trajectory.q.front().size(); ++i) {
    const std::string name = coordinate_symbol(info, i);
    const std::string unit = coordinate_unit(info, i);
    q.push_back(with_unit(name, unit));
    p.push_back(with_unit("p_{" + name + "}", momentum_unit(unit)));
  }
  for (std::size_t i = 0; i < k; ++i) {
    const std::string index = "_{" + std::to_string(i + 1) + "}";
    lambda.push_back(std::string("λ").append(index).append(" [energy/g").append(index).append("]"));
  }
  std::vector<TimePanel> panels;
  if (on.configuration) panels.push_back(columns("q", trajectory, trajectory.q, q));
  if (on.momentum) panels.push_back(columns("p", trajectory, trajectory.p, p));
  if (on.multipliers && k > 0)
    panels.push_back(columns("λ", trajectory, trajectory.lambda, lambda));
  if (on.energy) panels.push_back(energy({curve}, {energy_error({curve})}));
  for (TimePanel& panel : panels) panel.shaded = curve.on_limits;
  return panels;
}

void draw(Script& script,
          const Picture& page,
          const TimePanel& panel,
          const Box& box,
          Axis times,
          bool bottom) {
  constexpr double kBesides = 14;
  set_box(script, page, box);
  script << "unset object\n";
  for (const auto& [begin, end] : panel.shaded) {
    script << "set object rectangle from first " << number(times.at(begin), 9)
           << ", graph 0 to first " << number(times.at(end), 9)
           << ", graph 1 behind fc rgb '#fbe6cf' fs solid 1 border rgb '#f0b070'\n";
  }
  set_axis(script, "x", times, box.width, 80);
  set_axis(script, "y", panel.values, box.height, 36);
  if (panel.logarithmic) {
    const double decades = std::log10(panel.values.upper / panel.values.lower);
    script << "set logscale y\nset ytics " << std::pow(10.0, std::ceil(decades / 4)) << "\n";
  }
  script << "set format y '" << (panel.logarithmic ? "10^{%T}" : "%h") << "'\n"
         << "set format x '" << (bottom ? "%h" : "") << "'\n"
         << "set xlabel " << quoted_markup(bottom ? times.label("t", "time") : "") << "\n"
         << "set ylabel " << quoted_markup(panel.label) << "\n"
         << "set grid lc rgb '#e4e4e4' lt 1 lw 0.6\nset tics nomirror out scale 0.6\n"
         << "set border 3 lw 1\nset key at screen " << (box.x + box.width + kBesides) / page.width
         << ", screen " << (box.y + box.height) / page.height
         << " left top vertical Left reverse samplen 1.6\n";
  Plot plot(script, "plot", {times.lower, panel.values.lower});
  for (std::size_t i = 0; i < panel.lines.size(); ++i) {
    Rows points = panel.lines[i].points;
    for (Row& row : points) row[0] = times.at(row[0]);
    const std::string style = "with lines lw 1.8 " + line_color(i);
    plot.add(points, style);
    if (drawable(points)) plot.key(style, panel.lines[i].title);
  }
  if (!panel.zeros.empty()) {
    Rows points = panel.zeros;
    for (Row& row : points) row[0] = times.at(row[0]);
    const std::string color = " lc rgb '#606060'";
    plot.add(points, "with points pt 7 ps 0.35" + color);
    plot.key("with points pt 7 ps 0.7" + color, "exactly 0");
  }
  plot.draw();
  clear_settings(script);
}

}  // namespace

std::size_t count_panels(const Curve& curve, const TimePanels& panels) {
  const auto& lambda = curve.trajectory->lambda;
  const bool has_lambda = !lambda.empty() && !lambda.front().empty();
  return static_cast<std::size_t>(panels.configuration) +
         static_cast<std::size_t>(panels.momentum) +
         static_cast<std::size_t>(panels.multipliers && has_lambda) +
         static_cast<std::size_t>(panels.energy);
}

void draw_time_panels(Script& script,
                      const Picture& page,
                      const SceneInfo& info,
                      const Curve& curve,
                      const Box& box,
                      const TimePanels& on) {
  const std::vector<TimePanel> panels = panels_of(info, curve, on);
  const auto n = static_cast<double>(panels.size());
  const double height = (box.height - (n - 1) * kGap) / n;
  const Axis times(times_of({curve}));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double y = box.y + (n - 1 - static_cast<double>(i)) * (height + kGap);
    draw(script, page, panels[i], {box.x, y, box.width, height}, times, i + 1 == panels.size());
  }
}

Picture time_picture(const SceneInfo& info, const std::vector<Curve>& curves) {
  constexpr std::size_t kMostColumns = 3;
  constexpr double kLeft = 105;    // axis label and numbers
  constexpr double kRight = 225;   // legends
  constexpr double kBelow = 65;    // axis label
  constexpr double kAbove = 75;    // title
  constexpr double kHeight = 150;  // of a panel
  const std::size_t shown = std::min(curves.size(), kMostColumns);
  const double width = shown == 1 ? 590 : 330;
  const double column = kLeft + width + kRight;
  const auto panels = static_cast<double>(count_panels(curves.front(), {}));
  Picture page;
  page.width = static_cast<double>(shown) * column;
  page.height = kBelow + panels * kHeight + (panels - 1) * kGap + kAbove;
  Script script;
  script << "set multiplot\n";
  for (std::size_t i = 0; i < shown; ++i) {
    const double x = static_cast<double>(i) * column + kLeft;
    const double middle = x + width / 2;
    put_text(script, page, middle, page.height - 25, heading(info, curves[i]), "center font ',15'");
    put_text(script, page, middle, page.height - 52, numbers_line(info, curves[i]));
    const Box box{x, kBelow, width, page.height - kBelow - kAbove};
    draw_time_panels(script, page, info, curves[i], box, {});
  }
  script << "unset multiplot\n";
  page.commands = script.text();
  return page;
}

Picture energy_picture(const SceneInfo& info, const std::vector<Curve>& curves) {
  constexpr std::size_t kMostLines = 8;
  const std::size_t shown = std::min(curves.size(), kMostLines);
  const std::vector<Curve> first(curves.begin(),
                                 curves.begin() + static_cast<std::ptrdiff_t>(shown));
  std::vector<std::string> titles;
  for (std::size_t i = 0; i < shown; ++i) {
    const std::string name =
        first[i].name.empty() ? "curve " + std::to_string(i + 1) : first[i].name;
    titles.push_back(shown == 1 ? energy_error(first) : escaped(name));
  }
  TimePanel panel = energy(first, titles);
  panel.label = with_unit(energy_error(first), "energy");
  Picture page;
  page.height = 480;
  Script script;
  put_text(script,
           page,
           410,
           page.height - 30,
           escaped(info.name) + ": energy error",
           "center font ',15'");
  draw(script, page, panel, {110, 65, 600, page.height - 125}, Axis(times_of(first)), true);
  page.commands = script.text();
  return page;
}

}  // namespace carnot::plots
