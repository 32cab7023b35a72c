#include "carnot/shooting/front/surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>

#include "carnot/shooting/front/image_scale.h"
#include "carnot/shooting/linear/norm.h"

namespace carnot::internal {
namespace {

using Point = std::vector<double>;

// The angle at the edge between two triangles of images, 0 where they lie in one plane: of the
// parts of c - a and d - a across the edge.
double bend(const Point& a, const Point& b, const Point& c, const Point& d) {
  const std::size_t n = a.size();
  double along = 0;
  double on_c = 0;
  double on_d = 0;
  for (std::size_t j = 0; j < n; ++j) {
    along += (b[j] - a[j]) * (b[j] - a[j]);
    on_c += (c[j] - a[j]) * (b[j] - a[j]);
    on_d += (d[j] - a[j]) * (b[j] - a[j]);
  }
  if (!(along > 0)) return 0;
  double cc = 0;
  double dd = 0;
  double cd = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const double x = c[j] - a[j] - on_c / along * (b[j] - a[j]);
    const double y = d[j] - a[j] - on_d / along * (b[j] - a[j]);
    cc += x * x;
    dd += y * y;
    cd += x * y;
  }
  if (!(cc > 0 && dd > 0)) return 0;
  return std::numbers::pi - std::acos(std::clamp(cd / std::sqrt(cc * dd), -1.0, 1.0));
}

struct EdgeHash {
  std::size_t operator()(const Edge& edge) const {
    return std::hash<std::int64_t>()((static_cast<std::int64_t>(edge.first) << 32) + edge.second);
  }
};

// The segments that ask to be cut.
std::vector<Edge> segments_to_cut(const SurfaceRefinement& how, const Surface& surface) {
  std::vector<std::vector<int>> others(surface.vertices.size());
  std::set<Edge> cut;
  const auto image = [&](int i) -> const Point& { return surface.vertices[i].image; };
  for (const auto& [a, b] : surface.segments) {
    others[a].push_back(b);
    others[b].push_back(a);
    if (distance(image(a), image(b)) > how.longest) cut.insert(edge_of(a, b));
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (others[i].size() != 2) continue;
    const int at = static_cast<int>(i);
    const double before = distance(image(at), image(others[i][0]));
    const double after = distance(image(at), image(others[i][1]));
    const double across = distance(image(others[i][0]), image(others[i][1]));
    const double cosine =
        (before * before + after * after - across * across) / (2 * before * after);
    const double turn = std::numbers::pi - std::acos(std::clamp(cosine, -1.0, 1.0));
    if (!(turn > how.sharpest)) continue;
    if (before > how.shortest) cut.insert(edge_of(at, others[i][0]));
    if (after > how.shortest) cut.insert(edge_of(at, others[i][1]));
  }
  return {cut.begin(), cut.end()};
}

// The sides of all triangles, each at the lesser of its two vertices and those of one edge side by
// side, so that edges come in order. A table by hash took a seventh of the time of a caustic.
class Sides {
 public:
  struct Side {
    int far;       // the greater vertex of the edge
    int opposite;  // the third corner of the triangle
  };

  explicit Sides(const Surface& surface)
      : begin_(surface.vertices.size() + 1, 0), sides_(3 * surface.triangles.size()) {
    const auto each = [&](const auto& visit) {
      for (const auto& t : surface.triangles) {
        for (int k = 0; k < 3; ++k) visit(edge_of(t[k], t[(k + 1) % 3]), t[(k + 2) % 3]);
      }
    };
    each([&](const Edge& edge, int) { ++begin_[edge.first + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    std::vector<int> next = begin_;
    each([&](const Edge& edge, int opposite) {
      sides_[next[edge.first]++] = {edge.second, opposite};
    });
    for (std::size_t i = 0; i + 1 < begin_.size(); ++i) {
      std::sort(sides_.begin() + begin_[i],
                sides_.begin() + begin_[i + 1],
                [](const Side& x, const Side& y) {
                  return std::pair(x.far, x.opposite) < std::pair(y.far, y.opposite);
                });
    }
  }

  [[nodiscard]] std::size_t size() const { return sides_.size(); }
  [[nodiscard]] const Side& operator[](int i) const { return sides_[i]; }
  // The place of the first side of an edge that there is.
  [[nodiscard]] int first(const Edge& edge) const {
    int i = begin_[edge.first];
    while (sides_[i].far != edge.second) ++i;
    return i;
  }
  // Calls visit(edge, first, end) with the places of its sides, edge after edge.
  template <class Visit>
  void each_edge(const Visit& visit) const {
    for (std::size_t v = 0; v + 1 < begin_.size(); ++v) {
      for (int i = begin_[v]; i < begin_[v + 1];) {
        int end = i + 1;
        while (end < begin_[v + 1] && sides_[end].far == sides_[i].far) ++end;
        visit(Edge{static_cast<int>(v), sides_[i].far}, i, end);
        i = end;
      }
    }
  }

 private:
  std::vector<int> begin_;  // of the sides of each vertex
  std::vector<Side> sides_;
};

// The edges of triangles that ask to be cut.
std::vector<Edge> edges_to_cut(const SurfaceRefinement& how, const Surface& surface) {
  const Sides sides(surface);
  std::vector<bool> cut(sides.size(), false);  // at the first side of an edge
  const auto image = [&](int i) -> const Point& { return surface.vertices[i].image; };
  sides.each_edge([&](const Edge& edge, int first, int end) {
    const Point& a = image(edge.first);
    const Point& b = image(edge.second);
    const double length = distance(a, b);
    cut[first] = length > how.longest;
    if (!(length > how.shortest)) return;
    const Point& c = image(sides[first].opposite);
    for (int i = first + 1; i < end && !cut[first]; ++i) {
      cut[first] = bend(a, b, c, image(sides[i].opposite)) > how.sharpest;
    }
  });
  // A triangle that is cut is cut on its longest side, too: or it would become a sliver.
  std::vector<bool> longest(sides.size(), false);
  for (const auto& triangle : surface.triangles) {
    std::array<int, 3> side{};
    for (int k = 0; k < 3; ++k) side[k] = sides.first(edge_of(triangle[k], triangle[(k + 1) % 3]));
    if (!cut[side[0]] && !cut[side[1]] && !cut[side[2]]) continue;
    std::array<double, 3> length{};
    for (int k = 0; k < 3; ++k) {
      length[k] = distance(image(triangle[k]), image(triangle[(k + 1) % 3]));
    }
    const auto k = std::max_element(length.begin(), length.end()) - length.begin();
    if (length[k] > how.shortest) longest[side[k]] = true;
  }
  std::vector<Edge> edges;
  sides.each_edge([&](const Edge& edge, int first, int) {
    if (cut[first] || longest[first]) edges.push_back(edge);
  });
  return edges;
}

// The triangle with middles on some of its sides, side k between corners k and k + 1; -1: none.
void divide(const std::array<int, 3>& t,
            const std::array<int, 3>& middle,
            std::vector<std::array<int, 3>>& out) {
  const auto count = std::count_if(middle.begin(), middle.end(), [](int m) { return m >= 0; });
  if (count == 0) {
    out.push_back(t);
  } else if (count == 3) {
    out.push_back({t[0], middle[0], middle[2]});
    out.push_back({middle[0], t[1], middle[1]});
    out.push_back({middle[2], middle[1], t[2]});
    out.push_back(middle);
  } else {
    // Turned so that side 0 has a middle and, of two, side 1 has the other.
    int k = 0;
    while (middle[k] < 0 || (count == 2 && middle[(k + 1) % 3] < 0)) ++k;
    const int a = t[k];
    const int b = t[(k + 1) % 3];
    const int c = t[(k + 2) % 3];
    const int m = middle[k];
    const int next = middle[(k + 1) % 3];
    if (count == 1) {
      out.push_back({a, m, c});
      out.push_back({m, b, c});
    } else {
      out.push_back({m, b, next});
      out.push_back({a, m, next});
      out.push_back({a, next, c});
    }
  }
}

}  // namespace

SurfaceVertex Surface::between(const Between& part) const {
  return {internal::between(vertices[part.a].place, vertices[part.b].place, part.part), {}};
}

std::vector<std::vector<int>> Surface::neighbours() const {
  std::vector<std::set<int>> sets(vertices.size());
  for (const auto& t : triangles) {
    for (const int i : t) sets[i].insert(t.begin(), t.end());
  }
  for (const auto& [a, b] : segments) {
    sets[a].insert(b);
    sets[b].insert(a);
  }
  std::vector<std::vector<int>> lists;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    sets[i].erase(static_cast<int>(i));
    lists.emplace_back(sets[i].begin(), sets[i].end());
  }
  return lists;
}

std::vector<bool> Surface::on_border() const {
  std::vector<bool> border(vertices.size(), false);
  Sides(*this).each_edge([&](const Edge& edge, int first, int end) {
    if (end - first == 1) border[edge.first] = border[edge.second] = true;
  });
  std::vector<int> ends(vertices.size(), 0);
  for (const auto& segment : segments) {
    for (const int i : segment) ++ends[i];
  }
  for (std::size_t i = 0; i < ends.size(); ++i) border[i] = border[i] || ends[i] == 1;
  return border;
}

bool cut_edges(const std::vector<Edge>& cut, const MakeVertices& make, Surface& surface) {
  std::unordered_map<Edge, int, EdgeHash> middle;
  middle.reserve(cut.size());
  std::vector<Between> parents;
  const int first = static_cast<int>(surface.vertices.size());
  for (const Edge& edge : cut) {
    middle[edge] = static_cast<int>(surface.vertices.size());
    parents.push_back({edge.first, edge.second, 0.5});
    surface.vertices.push_back(surface.between(parents.back()));
  }
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : surface.triangles) {
    std::array<int, 3> middles{-1, -1, -1};
    for (int k = 0; k < 3; ++k) {
      const auto found = middle.find(edge_of(t[k], t[(k + 1) % 3]));
      if (found != middle.end()) middles[k] = found->second;
    }
    divide(t, middles, triangles);
  }
  surface.triangles = std::move(triangles);
  std::vector<std::array<int, 2>> segments;
  for (const auto& [a, b] : surface.segments) {
    const auto found = middle.find(edge_of(a, b));
    if (found == middle.end()) {
      segments.push_back({a, b});
    } else {
      segments.push_back({a, found->second});
      segments.push_back({found->second, b});
    }
  }
  surface.segments = std::move(segments);
  return make(first, parents);
}

long refine(const SurfaceRefinement& how, Surface& surface) {
  constexpr int kMostRounds = 24;
  const auto wishes = [&] {
    return surface.segments.empty() ? edges_to_cut(how, surface) : segments_to_cut(how, surface);
  };
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<Edge> cut = wishes();
    if (cut.empty()) return 0;
    if (static_cast<long>(surface.vertices.size() + cut.size()) > how.most) {
      return static_cast<long>(cut.size());
    }
    if (!cut_edges(cut, how.make, surface)) return -1;
  }
  return static_cast<long>(wishes().size());
}

void clip(const std::vector<bool>& inside,
          const std::function<void(std::vector<Between>&)>& locate,
          const MakeVertices& make,
          Surface& surface) {
  std::map<Edge, int> border;
  std::vector<Between> places;
  const int first = static_cast<int>(surface.vertices.size());
  const auto look_at = [&](int a, int b) {
    if (inside[a] == inside[b] || border.contains(edge_of(a, b))) return;
    border[edge_of(a, b)] = first + static_cast<int>(places.size());
    places.push_back({inside[a] ? a : b, inside[a] ? b : a, 0.5});
  };
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) look_at(t[k], t[(k + 1) % 3]);
  }
  for (const auto& [a, b] : surface.segments) look_at(a, b);
  locate(places);
  for (const Between& place : places) surface.vertices.push_back(surface.between(place));
  std::vector<std::array<int, 3>> kept;
  for (const auto& t : surface.triangles) {
    const int count = inside[t[0]] + inside[t[1]] + inside[t[2]];
    if (count == 3) kept.push_back(t);
    if (count == 0 || count == 3) continue;
    int k = 0;  // the corner that is alone
    while ((count == 1) != inside[t[k]]) ++k;
    const int a = t[k];
    const int b = t[(k + 1) % 3];
    const int c = t[(k + 2) % 3];
    const int ab = border.at(edge_of(a, b));
    const int ac = border.at(edge_of(a, c));
    if (count == 1) {
      kept.push_back({a, ab, ac});
    } else {
      kept.push_back({ab, b, c});
      kept.push_back({ab, c, ac});
    }
  }
  surface.triangles = std::move(kept);
  std::vector<std::array<int, 2>> pieces;
  for (const auto& [a, b] : surface.segments) {
    if (inside[a] && inside[b]) pieces.push_back({a, b});
    if (inside[a] == inside[b]) continue;
    const int middle = border.at(edge_of(a, b));
    pieces.push_back(inside[a] ? std::array{a, middle} : std::array{middle, b});
  }
  surface.segments = std::move(pieces);
  (void)make(first, places);
}

void drop_unused(Surface& surface, std::vector<int>& kept) {
  std::vector<int> number(surface.vertices.size(), -1);
  for (const auto& t : surface.triangles) {
    for (const int i : t) number[i] = 0;
  }
  for (const auto& [a, b] : surface.segments) number[a] = number[b] = 0;
  kept.clear();
  std::vector<SurfaceVertex> vertices;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<int>(vertices.size());
    vertices.push_back(std::move(surface.vertices[i]));
    kept.push_back(static_cast<int>(i));
  }
  for (auto& t : surface.triangles) {
    for (int& i : t) i = number[i];
  }
  for (auto& segment : surface.segments) {
    for (int& i : segment) i = number[i];
  }
  surface.vertices = std::move(vertices);
}

}  // namespace carnot::internal
