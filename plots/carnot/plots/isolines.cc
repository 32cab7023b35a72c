#include "carnot/plots/isolines.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

namespace carnot::plots {
namespace {

struct Corner {
  double x = 0;
  double y = 0;
  double height = 0;  // over the level
};

// Four corners around a cell. Where the line crosses two edges there is one piece; where it crosses
// all four, the mean of the corners says which two belong together.
void add_cell(const std::array<Corner, 4>& corners, Isoline& line) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 4> x;
  std::array<double, 4> y;
  std::size_t crossed = 0;
  double mean = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const Corner& a = corners[c];
    const Corner& b = corners[(c + 1) % 4];
    if (!std::isfinite(a.height)) return;
    mean += a.height;
    if ((a.height > 0) == (b.height > 0)) continue;
    const double share = a.height / (a.height - b.height);
    x[crossed] = a.x + share * (b.x - a.x);
    y[crossed++] = a.y + share * (b.y - a.y);
  }
  const auto add = [&](std::size_t from, std::size_t to) {
    line.x.insert(line.x.end(), {x[from], x[to], kGap});
    line.y.insert(line.y.end(), {y[from], y[to], kGap});
  };
  if (crossed == 2) add(0, 1);
  if (crossed < 4) return;
  // Edge c leaves corner c: edges 0 and 1 are beside corner 1, edges 3 and 0 beside corner 0.
  const bool around_first = (mean > 0) != (corners[0].height > 0);
  add(0, around_first ? 3 : 1);
  add(2, around_first ? 1 : 3);
}

}  // namespace

Isoline isoline(const std::vector<double>& x,
                const std::vector<double>& y,
                const std::vector<double>& values,
                double level) {
  if (values.size() != x.size() * y.size()) {
    throw std::invalid_argument(std::to_string(values.size()) + " values on a grid of " +
                                std::to_string(x.size()) + " by " + std::to_string(y.size()));
  }
  Isoline line;
  const auto corner = [&](std::size_t i, std::size_t j) {
    return Corner{x[i], y[j], values[i * y.size() + j] - level};
  };
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    for (std::size_t j = 0; j + 1 < y.size(); ++j) {
      add_cell({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)}, line);
    }
  }
  return line;
}

}  // namespace carnot::plots
