#include "carnot/plots/figure.h"

#include <stdexcept>

#include "carnot/plots/animation.h"
#include "carnot/plots/instants.h"
#include "carnot/plots/panels.h"
#include "carnot/plots/path_plot.h"
#include "carnot/plots/space_plot.h"
#include "carnot/plots/time_plot.h"

namespace carnot::plots {
namespace {

using View = Drawing::View;

constexpr std::size_t kMostRows = 4000;  // more points than a page can show only swell the file

void validate_curves(const SceneInfo& info, const std::vector<Curve>& curves, Figure figure) {
  if (curves.empty()) throw std::invalid_argument("a plot of " + info.name + " needs a curve");
  for (const Curve& curve : curves) {
    if (curve.trajectory == nullptr || curve.trajectory->t.empty()) {
      throw std::invalid_argument("a plot of " + info.name + " needs curves with points");
    }
  }
  const bool path = figure == Figure::kPath || figure == Figure::kOverview;
  if (path && info.drawing.view == View::kTimeOnly) {
    throw std::invalid_argument("scene " + info.name + " has no path to draw, plot it over time");
  }
}

// Path on the left, time panels on the right.
Picture overview_picture(const SceneInfo& info, const Curve& curve) {
  constexpr double kBelow = 100;
  constexpr double kAbove = 75;
  constexpr TimePanels kPanels{};
  const double inside = 135 * static_cast<double>(count_panels(curve, kPanels)) + 20;
  Picture page;
  page.width = 1420;
  page.height = kBelow + inside + kAbove;
  Script script;
  script << "set multiplot\n";
  put_title(script, page, info, curve);
  script << "set key off\n";
  const Box left{90, kBelow, 480, inside};
  if (info.drawing.view == View::kPlane) {
    const PlaneFrame frame(PlaneExtent(info, {curve}, kBodies), left);
    set_time_colors(script,
                    page,
                    times_of({curve}),
                    {frame.box.x + frame.box.width + 18, frame.box.y, 14, frame.box.height});
    set_plane(script, page, info, frame);
    draw_path(script, info, curve, frame, kBodies);
    draw_legend(script, page, 340, 640, path_legend(info, curve, frame));
  } else {
    const SpaceView view(SpaceFrame(info, {curve}), {15, kBelow - 40, 585, inside + 40});
    const Box& box = view.box();
    set_time_colors(
        script, page, times_of({curve}), {box.x + box.width + 10, box.y, 14, box.height});
    draw_space(script,
               page,
               info,
               *curve.trajectory,
               view,
               curve.trajectory->t.size() - 1,
               body_instants(info, *curve.trajectory, kBodies));
    draw_legend(script, page, 340, 640, space_legend(info));
  }
  draw_time_panels(script, page, info, curve, {785, kBelow - 35, 405, inside + 35}, kPanels);
  script << "unset multiplot\n";
  page.commands = script.text();
  return page;
}

Picture path_figure(const SceneInfo& info, const std::vector<Curve>& curves, bool film) {
  if (info.drawing.view == View::kPlane) {
    return film ? plane_animation(info, curves.front()) : path_picture(info, curves);
  }
  return film ? space_animation(info, curves.front()) : space_picture(info, curves);
}

Picture picture_of(const SceneInfo& info,
                   const std::vector<Curve>& curves,
                   Figure figure,
                   bool film) {
  switch (figure) {
    case Figure::kTime:
      return time_picture(info, curves);
    case Figure::kEnergy:
      return energy_picture(info, curves);
    case Figure::kOverview:
      return overview_picture(info, curves.front());
    default:
      return path_figure(info, curves, film);
  }
}

}  // namespace

std::string write_figure(const std::string& file,
                         const SceneInfo& info,
                         const std::vector<Curve>& curves,
                         Figure figure) {
  validate_plot_file(file);
  if (figure == Figure::kAutomatic) {
    figure = info.drawing.view == View::kTimeOnly ? Figure::kTime : Figure::kPath;
  }
  validate_curves(info, curves, figure);
  std::vector<Trajectory> thin;
  thin.reserve(curves.size());
  for (const Curve& curve : curves) thin.push_back(thinned(*curve.trajectory, kMostRows));
  std::vector<Curve> drawn = curves;
  for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i].trajectory = &thin[i];
  return write_picture(file, picture_of(info, drawn, figure, is_gif(file)));
}

}  // namespace carnot::plots
