// A page of one large panel, or of small multiples, with title, legend and the colour bar of time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"

namespace carnot::plots {

// At most six curves get a panel: the first ones.
std::vector<Curve> shown_curves(const std::vector<Curve>& curves);
// Times of all the curves.
Interval times_of(const std::vector<Curve>& curves);

// What a page leaves free around its panels.
struct Sheet {
  double left = 90;    // axis label and numbers
  double right = 125;  // colour bar
  double below = 100;  // axis label, legend
  double above = 75;   // title
  double gap_x = 60;
  double gap_y = 72;
};

// How wide each of the panels may be on a page of the usual width.
double panel_room(std::size_t panels, const Sheet& sheet);

// Sets axes and draws one curve. `left`, `bottom`: the panel carries the labels of its axes.
struct Panel {
  Box box;
  bool left = true;
  bool bottom = true;
};
using DrawPanel = std::function<void(Script&, const Picture&, const Curve&, const Panel&)>;

// Two lines of title for a page with one curve.
void put_title(Script& script, const Picture& page, const SceneInfo& info, const Curve& curve);
// One entry of a legend: a line style, points upon each other or both, and its title (markup).
struct LegendEntry {
  std::string line;                 // "with lines ...", may be empty
  std::vector<std::string> points;  // "with points ...", may be empty
  std::string title;
};
// A legend centred at x in the foot of the page, in one row or in as many as it needs to be no
// wider than `width`; a plot of its own in a multiplot.
void draw_legend(Script& script,
                 const Picture& page,
                 double x,
                 double width,
                 const std::vector<LegendEntry>& entries);
// Colour by time, with a bar at the given place.
void set_time_colors(Script& script, const Picture& page, const Interval& times, const Box& bar);

// The page of all the curves, with panels of the given inside size. It is as wide as they need.
Picture draw_panels(const SceneInfo& info,
                    const std::vector<Curve>& curves,
                    const Sheet& sheet,
                    double width,
                    double height,
                    const std::vector<LegendEntry>& legend,
                    const DrawPanel& draw);

}  // namespace carnot::plots
