// Lines in the plane along which values on a grid have one height.
#pragma once

#include <vector>

namespace carnot::plots {

// Pieces of lines as a path with gaps: NaN between pieces.
struct Isoline {
  std::vector<double> x;
  std::vector<double> y;
};

// Of values at (x_i, y_j), value i * y.size() + j, which are linear along the edges of each cell.
// Cells with a corner that is not finite have no line. Throws std::invalid_argument where there are
// not x.size() y.size() values.
Isoline isoline(const std::vector<double>& x,
                const std::vector<double>& y,
                const std::vector<double>& values,
                double level);

}  // namespace carnot::plots
