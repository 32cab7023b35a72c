// Slices of a grid of geodesics: lines of equal distance, and where the shortest ones change.
#pragma once

#include <string>
#include <vector>

#include "atlas/problem_list.h"
#include "carnot/plots/series_plot.h"
#include "carnot/scene/scene_info.h"

namespace carnot::apps {

// What a picture needs of all the points; 8 (n + 1) bytes each.
class AtlasPlot {
 public:
  // Of a grid with two axes at least; n coordinates.
  AtlasPlot(SceneInfo info, std::vector<Axis> axes, int n);

  // The record of the next point, as atlas_record() makes it.
  void add(const Json& record);
  // Draws x, y where the grid has the coordinates that the scene is drawn in, else its first two
  // axes; up to six slices across the first of the others, and the middle of the rest. Returns
  // gnuplot's warnings.
  [[nodiscard]] std::string draw(const std::string& file) const;

 private:
  struct Slice;

  [[nodiscard]] std::vector<Slice> slices() const;
  [[nodiscard]] std::vector<double> distances(const Slice& slice) const;
  // Of six points of the slice in a row, whether the shortest geodesic changes between the third
  // and the fourth.
  [[nodiscard]] bool is_cut(const Slice& slice, std::size_t first, std::size_t stride) const;
  [[nodiscard]] plots::Series cut_locus(const Slice& slice) const;
  [[nodiscard]] plots::Series isolines(const Slice& slice, double step, double largest) const;

  SceneInfo info_;
  std::vector<Axis> axes_;
  int n_;
  bool lengths_ = true;  // every geodesic has one
  std::vector<double> distance_;
  std::vector<double> p0_;
};

}  // namespace carnot::apps
