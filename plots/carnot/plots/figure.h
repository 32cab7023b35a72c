// The one entry point: curves of a scene to a picture in a file.
#pragma once

#include <string>
#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/plot_file.h"

namespace carnot::plots {

enum class Figure {
  kAutomatic,  // kPath where the scene can be drawn, else kTime
  kPath,       // in the plane or in space; a .gif is animated and shows the first curve
  kTime,       // q(t), p(t), lambda(t), energy error
  kEnergy,     // energy error of all the curves
  kOverview    // path and time panels of the first curve on one page
};

// Throws std::invalid_argument for a bad file name (see validate_plot_file), no curves, a curve
// without points, or kPath and kOverview of a scene that has no drawing; std::runtime_error when
// gnuplot fails. The file appears whole or not at all. Returns gnuplot's warnings, usually none.
std::string write_figure(const std::string& file,
                         const SceneInfo& info,
                         const std::vector<Curve>& curves,
                         Figure figure = Figure::kAutomatic);

}  // namespace carnot::plots
