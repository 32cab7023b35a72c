// A page of one large panel, or of small multiples, with title, legend and the colour bar of time.
#pragma once

#include <functional>
#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"

namespace carnot::plots {

// At most six curves get a panel: the first ones.
std::vector<Curve> shown_curves(const std::vector<Curve>& curves);
// Times of all the curves.
Interval times_of(const std::vector<Curve>& curves);
// Inside width of each panel.
double panel_width(std::size_t panels);

// Sets axes and draws one curve. `left`, `bottom`: the panel carries the labels of its axes.
struct Panel {
  Box box;
  bool left = true;
  bool bottom = true;
};
using DrawPanel = std::function<void(Script&, const Picture&, const Curve&, const Panel&)>;

// Two lines of title for a page with one curve.
void put_title(Script& script, const Picture& page, const SceneInfo& info, const Curve& curve);
// One entry of a legend: a line or point style and its title (markup).
struct LegendEntry {
  std::string style;
  std::string title;
};
// A legend in one row, centred at x in the foot of the page; a plot of its own in a multiplot.
void draw_legend(Script& script,
                 const Picture& page,
                 double x,
                 const std::vector<LegendEntry>& entries);
// Colour by time, with a bar at the given place.
void set_time_colors(Script& script, const Picture& page, const Interval& times, const Box& bar);

Picture draw_panels(const SceneInfo& info,
                    const std::vector<Curve>& curves,
                    double height,
                    const std::vector<LegendEntry>& legend,
                    const DrawPanel& draw);

}  // namespace carnot::plots
