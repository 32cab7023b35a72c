// The meshes that a refinement begins with.
#include <map>

#include "carnot/shooting/front/surface.h"

namespace carnot::internal {
namespace {

Surface cylinder(const std::vector<Column>& columns) {
  Surface surface;
  const auto around = static_cast<int>(columns.size());
  for (int i = 0; i < kPlacesOnColumn; ++i) {
    for (const Column& column : columns) surface.vertices.push_back({place_on(column, i), {}});
  }
  for (int i = 0; i + 1 < kPlacesOnColumn; ++i) {
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j;
      const int b = i * around + (j + 1) % around;
      surface.triangles.push_back({a, b, b + around});
      surface.triangles.push_back({a, b + around, a + around});
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
      surface.vertices.push_back({{side * Eigen::Vector3d::Unit(k)}, {}});
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

Surface circle(const UnitMomenta& momenta) {
  Surface surface;
  for (const Column& column : even_columns(momenta, 0)) {
    surface.vertices.push_back({{column.c}, {}});
  }
  const auto around = static_cast<int>(surface.vertices.size());
  for (int j = 0; j < around; ++j) surface.segments.push_back({j, (j + 1) % around});
  return surface;
}

Surface lines(const std::vector<Column>& columns) {
  Surface surface;
  for (const Column& column : columns) {
    const int first = static_cast<int>(surface.vertices.size());
    for (int i = 0; i < kPlacesOnColumn; ++i) {
      surface.vertices.push_back({place_on(column, i), {}});
      if (i > 0) surface.segments.push_back({first + i - 1, first + i});
    }
  }
  return surface;
}

}  // namespace

Surface first_surface(const UnitMomenta& momenta, const std::vector<Column>& columns) {
  if (momenta.dimension() == 2) return momenta.has_line() ? cylinder(columns) : sphere();
  return momenta.has_line() ? lines(columns) : circle(momenta);
}

}  // namespace carnot::internal
