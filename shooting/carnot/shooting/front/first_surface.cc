// The meshes that a refinement begins with.
#include <cmath>
#include <map>
#include <numbers>

#include "carnot/shooting/front/surface.h"

namespace carnot::internal {
namespace {

constexpr int kAround = 48;  // vertices
constexpr int kAlong = 33;

// In general position: no vertex is an abnormal extremal, whose neighbours have other cut times.
UnitMomentum on_circle(int j, int around) {
  const double phi = 2 * std::numbers::pi * (j + 0.37) / around;
  return {{std::cos(phi), std::sin(phi), 0}, 0};
}

// From -bound to bound.
double along(int i, double bound) { return bound * (2.0 * i / (kAlong - 1) - 1); }

Surface cylinder(double bound) {
  Surface surface;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAround; ++j) {
      UnitMomentum place = on_circle(j, kAround);
      place.w = along(i, bound);
      surface.vertices.push_back({place, {}});
    }
  }
  for (int i = 0; i + 1 < kAlong; ++i) {
    for (int j = 0; j < kAround; ++j) {
      const int a = i * kAround + j;
      const int b = i * kAround + (j + 1) % kAround;
      surface.triangles.push_back({a, b, b + kAround});
      surface.triangles.push_back({a, b + kAround, a + kAround});
    }
  }
  return surface;
}

// An octahedron whose triangles are cut in four so often.
Surface sphere() {
  constexpr int kCuts = 4;
  Surface surface;
  for (int k = 0; k < 3; ++k) {
    for (const double side : {1.0, -1.0}) {
      surface.vertices.push_back({{side * Eigen::Vector3d::Unit(k), 0}, {}});
    }
  }
  for (int octant = 0; octant < 8; ++octant) {
    const int x = octant & 1;
    const int y = 2 + (octant >> 1 & 1);
    const int z = 4 + (octant >> 2);
    const bool odd = (x + y + z) % 2 != 0;
    surface.triangles.push_back({x, odd ? z : y, odd ? y : z});
  }
  for (int cut = 0; cut < kCuts; ++cut) {
    std::map<Edge, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] =
          middles.emplace(edge_of(a, b), static_cast<int>(surface.vertices.size()));
      if (is_new) surface.vertices.push_back(surface.between({a, b, 0.5}));
      return found->second;
    };
    std::vector<std::array<int, 3>> triangles;
    for (const auto& [a, b, c] : surface.triangles) {
      const std::array m{middle(a, b), middle(b, c), middle(c, a)};
      triangles.push_back({a, m[0], m[2]});
      triangles.push_back({m[0], b, m[1]});
      triangles.push_back({m[2], m[1], c});
      triangles.push_back(m);
    }
    surface.triangles = std::move(triangles);
  }
  return surface;
}

Surface circle() {
  Surface surface;
  for (int j = 0; j < kAround; ++j) {
    surface.vertices.push_back({on_circle(j, kAround), {}});
    surface.segments.push_back({j, (j + 1) % kAround});
  }
  return surface;
}

Surface two_lines(double bound) {
  Surface surface;
  for (const double side : {1.0, -1.0}) {
    const int first = static_cast<int>(surface.vertices.size());
    for (int i = 0; i < kAlong; ++i) {
      surface.vertices.push_back({{side * Eigen::Vector3d::UnitX(), along(i, bound)}, {}});
      if (i > 0) surface.segments.push_back({first + i - 1, first + i});
    }
  }
  return surface;
}

}  // namespace

Surface first_surface(const UnitMomenta& momenta, double bound) {
  if (momenta.dimension() == 2) return momenta.has_line() ? cylinder(bound) : sphere();
  return momenta.has_line() ? two_lines(bound) : circle();
}

}  // namespace carnot::internal
