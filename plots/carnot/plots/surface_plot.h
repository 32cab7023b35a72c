// Pictures of surfaces of triangles in space, shaded and sorted by depth, with a section beside
// them; and of curves in the plane.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "carnot/scene/scene_info.h"

namespace carnot::plots {

struct SurfaceSheet {
  std::string title;                          // markup, for the section's legend
  std::vector<std::array<double, 3>> points;  // places that are not finite are left out
  std::vector<double> values;                 // what the colour tells, one for each point
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> segments;  // of a curve in the plane, instead of triangles
};

struct SurfacePage {
  std::string title;     // markup
  std::string subtitle;  // markup
  std::array<Coordinate, 3> axes;
  std::string color;  // what the values are, markup
  std::vector<SurfaceSheet> sheets;
  // The section is where axis `across` has the value `at`. With `halved` only what is behind it is
  // drawn: so one sees inside, and sheets do not hide each other.
  int across = 1;
  double at = 0;
  bool halved = false;
  // Lines in space and single points that are drawn over the sheets, also where these hide them.
  std::vector<std::vector<std::array<double, 3>>> lines;
  std::vector<std::array<double, 3>> points;
  bool plane = false;  // sheets are curves on the first two axes
  // Of a .gif: one sheet after the other, with the sections or curves of those before.
  bool growing = false;
};

// Ends of the pieces of the section of a sheet: two points each, on the other two axes.
std::vector<std::array<std::array<double, 2>, 2>> section_of(const SurfaceSheet& sheet,
                                                             int across,
                                                             double at);

// The endings of files, what is returned and what is thrown are those of plot_file.h.
std::string write_surfaces(const std::string& file, const SurfacePage& page);

}  // namespace carnot::plots
