// Limits on configurations: a function of q that stays between two bounds.
//
// A steering angle that ends, a trailer that must not jackknife, an obstacle. Scenes from text have
// `limit` and `disc`; make_limit.h makes one in C++.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace carnot {

struct Dynamics;

struct Limit {
  std::string name;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  // The function at q (length n) and, unless null, its gradient (n) and second derivatives (n x n,
  // row-major). Safe to call from many threads.
  std::function<double(const double* q, double* gradient, double* hessian)> value;
  // What is forbidden in the plane of the drawing: the corners of a region. Empty: nothing is
  // drawn.
  std::vector<std::array<double, 2>> outline{};
  // The scene with its velocities kept along the surfaces where the function is constant, for arcs
  // on a bound: one more velocity constraint. Empty where there is none; throws
  // std::invalid_argument where velocities cannot be kept so.
  std::function<Dynamics()> held{};

  // Of a disc, whose value is the square of the distance to the centre over twice this; 0: of any
  // other function.
  double radius = 0;

  // How far from the nearer bound the value is; negative beyond it. Of a disc it is the distance to
  // its edge.
  [[nodiscard]] double slack(double of) const {
    if (radius > 0) return std::sqrt(2 * radius * of) - std::sqrt(2 * radius * lower);
    return std::min(of - lower, upper - of);
  }
};

// The corners of a circle that looks round, for an outline.
inline std::vector<std::array<double, 2>> circle_outline(const std::array<double, 2>& centre,
                                                         double radius) {
  constexpr int kCorners = 72;
  std::vector<std::array<double, 2>> corners;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    corners.push_back({centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle)});
  }
  return corners;
}

}  // namespace carnot
