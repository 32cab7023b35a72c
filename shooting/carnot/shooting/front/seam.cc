#include "carnot/shooting/front/seam.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace carnot::internal {
namespace {

constexpr double kSameVertex = 1e-6;  // of c, and of w in units of its bound

// How often each edge is in a triangle.
std::map<Edge, int> edges_of(const Surface& surface) {
  std::map<Edge, int> edges;
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[edge_of(t[k], t[(k + 1) % 3])];
  }
  return edges;
}

using Difference = Eigen::Matrix<double, 5, 1>;
using Heights = Eigen::Vector2d;

// The largest |w| of a surface, of either axis.
Heights heights_of(const Surface& surface) {
  Heights heights = Heights::Constant(1e-300);
  for (const SurfaceVertex& v : surface.vertices) heights = heights.cwiseMax(v.place.w.cwiseAbs());
  return heights;
}

// b - a, w in units of `heights`.
Difference difference(const UnitMomentum& a, const UnitMomentum& b, const Heights& heights) {
  Difference apart;
  apart << b.c - a.c, (b.w - a.w).cwiseQuotient(heights);
  return apart;
}

// A place on an edge of the border.
struct Foot {
  Edge edge;
  double part = 0;
  double distance = std::numeric_limits<double>::infinity();
};

class Border {
 public:
  explicit Border(const Surface& surface) : surface_(surface), heights_(heights_of(surface)) {
    for (const auto& [edge, count] : edges_of(surface)) {
      if (count == 1) edges_.push_back(edge);
    }
  }

  [[nodiscard]] const UnitMomentum& place(int i) const { return surface_.vertices[i].place; }
  [[nodiscard]] const Heights& heights() const { return heights_; }
  [[nodiscard]] Foot foot(const UnitMomentum& of) const {
    Foot nearest;
    for (const Edge& edge : edges_) {
      const Difference along = difference(place(edge.first), place(edge.second), heights_);
      const Difference to = difference(place(edge.first), of, heights_);
      const double square = along.squaredNorm();
      const double part = square > 0 ? std::clamp(along.dot(to) / square, 0.0, 1.0) : 0;
      const double distance = (to - part * along).norm();
      if (distance < nearest.distance) nearest = {edge, part, distance};
    }
    return nearest;
  }

 private:
  const Surface& surface_;
  std::vector<Edge> edges_;
  Heights heights_;
};

// A fan in the place of each triangle with new vertices on a border edge.
void split(const std::map<Edge, std::multimap<double, int>>& on_edge, Surface& surface) {
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 3>> work(surface.triangles.rbegin(), surface.triangles.rend());
  while (!work.empty()) {
    const auto t = work.back();
    work.pop_back();
    bool whole = true;
    for (int k = 0; k < 3 && whole; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      const int c = t[(k + 2) % 3];
      const auto found = on_edge.find(edge_of(a, b));
      if (found == on_edge.end()) continue;
      whole = false;
      std::vector<int> chain;
      for (const auto& [part, vertex] : found->second) chain.push_back(vertex);
      if (a > b) std::reverse(chain.begin(), chain.end());  // parts begin at the lesser one
      chain.push_back(b);
      int last = a;
      for (const int next : chain) {
        work.push_back({last, next, c});  // may have another border edge
        last = next;
      }
    }
    if (whole) triangles.push_back(t);
  }
  surface.triangles = std::move(triangles);
}

int root_of(std::vector<int>& classes, int i) {
  while (classes[i] != i) i = classes[i] = classes[classes[i]];
  return i;
}

void unite(std::vector<int>& classes, int a, int b) {
  const int x = root_of(classes, a);
  const int y = root_of(classes, b);
  classes[std::max(x, y)] = std::min(x, y);
}

// Unites each end of a curve with the end that its partner is.
void join_ends(const std::vector<BorderVertex>& border,
               const Surface& surface,
               std::vector<int>& classes) {
  Heights heights = Heights::Constant(1e-300);
  for (const BorderVertex& one : border) {
    heights = heights.cwiseMax(surface.vertices[one.vertex].place.w.cwiseAbs());
  }
  for (const BorderVertex& one : border) {
    if (one.at_conjugate) continue;
    const auto far = [&](const BorderVertex& other) {
      return difference(surface.vertices[other.vertex].place, one.partner, heights).norm();
    };
    const auto nearest = std::min_element(
        border.begin(), border.end(), [&](const BorderVertex& a, const BorderVertex& b) {
          return far(a) < far(b);
        });
    if (far(*nearest) < kSameVertex) unite(classes, one.vertex, nearest->vertex);
  }
}

}  // namespace

std::vector<int> sew(const std::vector<BorderVertex>& border,
                     const std::function<void(int first, const std::vector<int>& of)>& make,
                     Surface& surface) {
  if (!surface.segments.empty()) {
    std::vector<int> classes(surface.vertices.size());
    std::iota(classes.begin(), classes.end(), 0);
    join_ends(border, surface, classes);
    for (int& one : classes) one = root_of(classes, one);
    return classes;
  }
  const Border sides(surface);
  const int first = static_cast<int>(surface.vertices.size());
  std::map<Edge, std::multimap<double, int>> on_edge;
  std::vector<std::pair<int, int>> pairs;
  std::vector<int> of;
  std::vector<SurfaceVertex> added;
  for (const BorderVertex& one : border) {
    if (one.at_conjugate) continue;
    const Foot foot = sides.foot(one.partner);
    int same = -1;
    for (const int end : {foot.edge.first, foot.edge.second}) {
      if (difference(sides.place(end), one.partner, sides.heights()).norm() < kSameVertex)
        same = end;
    }
    if (same >= 0) {
      pairs.emplace_back(one.vertex, same);
      continue;
    }
    // Two partners may be as good as one place, or beyond one end; then they follow each other.
    const int vertex = first + static_cast<int>(added.size());
    on_edge[foot.edge].emplace(foot.part, vertex);
    added.push_back({one.partner, {}});
    of.push_back(one.vertex);
    pairs.emplace_back(one.vertex, vertex);
  }
  surface.vertices.insert(surface.vertices.end(), added.begin(), added.end());
  split(on_edge, surface);
  make(first, of);
  std::vector<int> classes(surface.vertices.size());
  std::iota(classes.begin(), classes.end(), 0);
  for (const auto& [a, b] : pairs) unite(classes, a, b);
  // A family of conjugate momenta arrives at one point.
  const std::map<Edge, int> edges = edges_of(surface);
  std::set<int> conjugate;
  for (const BorderVertex& one : border) {
    if (one.at_conjugate) conjugate.insert(one.vertex);
  }
  for (const auto& [edge, count] : edges) {
    if (count == 1 && conjugate.contains(edge.first) && conjugate.contains(edge.second)) {
      unite(classes, edge.first, edge.second);
    }
  }
  for (std::size_t i = 0; i < classes.size(); ++i) {
    classes[i] = root_of(classes, static_cast<int>(i));
  }
  return classes;
}

std::vector<Edge> doubled_edges(const std::vector<int>& classes, const Surface& surface) {
  const std::map<Edge, int> edges = edges_of(surface);
  std::map<Edge, int> merged;
  const auto image = [&](const Edge& edge) {
    return edge_of(classes[edge.first], classes[edge.second]);
  };
  for (const auto& [edge, count] : edges) merged[image(edge)] += count;
  std::vector<Edge> doubled;
  for (const auto& [edge, count] : edges) {
    const Edge one = image(edge);
    if (count == 2 && one.first != one.second && merged[one] > 2) doubled.push_back(edge);
  }
  return doubled;
}

void merge(const std::vector<int>& classes, Surface& surface) {
  std::vector<std::array<int, 3>> kept;
  for (auto t : surface.triangles) {
    for (int& i : t) i = classes[i];
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) kept.push_back(t);
  }
  surface.triangles = std::move(kept);
  for (auto& segment : surface.segments) {
    for (int& i : segment) i = classes[i];
  }
  std::erase_if(surface.segments, [](const auto& one) { return one[0] == one[1]; });
}

Topology topology_of(const Surface& surface) {
  Topology topology;
  if (!surface.segments.empty()) {
    std::map<int, int> ends;
    for (const auto& segment : surface.segments) {
      for (const int i : segment) ++ends[i];
    }
    topology.closed =
        std::all_of(ends.begin(), ends.end(), [](const auto& end) { return end.second == 2; });
    topology.euler = static_cast<int>(ends.size()) - static_cast<int>(surface.segments.size());
    return topology;
  }
  const std::map<Edge, int> edges = edges_of(surface);
  std::set<int> vertices;
  for (const auto& t : surface.triangles) vertices.insert(t.begin(), t.end());
  topology.closed = !edges.empty() && std::all_of(edges.begin(), edges.end(), [](const auto& edge) {
    return edge.second == 2;
  });
  topology.euler = static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) +
                   static_cast<int>(surface.triangles.size());
  return topology;
}

}  // namespace carnot::internal
