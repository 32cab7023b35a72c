#include "carnot/shooting/front/section_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/front/columns.h"
#include "carnot/shooting/front/ray_ends.h"
#include "carnot/shooting/linear/illinois.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {
namespace {

// The lattice: discs of rings about their middle. With 24 discs of 8 rings of 12 places, 840 places
// of the refined front of the vehicle are not led back to the section; with these, none.
constexpr int kDiscs = 48;
constexpr int kAround = 24;
constexpr int kRings = 12;
constexpr int kOnDisc = 1 + kRings * kAround;
constexpr double kAside = 0.37;  // of the angle between two ways out: none of them is an axis

constexpr int kDoublings = 12;   // of the first guess, one turn in a length
constexpr double kFarthest = 4;  // that a disc reaches out, in units of the axes

Eigen::Vector2d at_angle(double angle) { return {std::cos(angle), std::sin(angle)}; }
Eigen::Vector2d way_out(int j) { return at_angle(2 * std::numbers::pi * (j + kAside) / kAround); }

// The triangles of a disc: vertex 0 is the middle, and ring i has 1 + i kAround and those after it.
std::vector<std::array<int, 3>> triangles_of_disc() {
  std::vector<std::array<int, 3>> triangles;
  triangles.reserve(kAround * (2 * kRings - 1));
  const auto on_ring = [](int i, int j) { return 1 + i * kAround + j % kAround; };
  for (int j = 0; j < kAround; ++j) triangles.push_back({0, on_ring(0, j), on_ring(0, j + 1)});
  for (int i = 0; i + 1 < kRings; ++i) {
    for (int j = 0; j < kAround; ++j) {
      triangles.push_back({on_ring(i, j), on_ring(i + 1, j), on_ring(i + 1, j + 1)});
      triangles.push_back({on_ring(i, j), on_ring(i + 1, j + 1), on_ring(i, j + 1)});
    }
  }
  return triangles;
}

using Tetrahedron = std::array<int, 4>;
constexpr std::array<std::pair<int, int>, 6> kSides{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// Where two sheets of the section pass between the ends of an edge, these are on one side of both.
// Then the sheets would be joined. So such edges are split, and the parts of their neighbours in
// the next round. On the vehicle at length 1 this adds 2,311 tetrahedra to 79,488 in four rounds.
// Edges of the section that are longer than 0.09 and whose middle is led away by a quarter of their
// length or more were 155 before, and are 16 now.
constexpr int kRounds = 4;

double length_between(const UnitMomentum& a, const UnitMomentum& b) {
  return std::hypot((a.c - b.c).norm(), (a.w - b.w).norm());
}

class LatticeCutter {
 public:
  LatticeCutter(const SectionLattice& lattice, const EndSection& section)
      : lattice_(lattice), section_(section), directions_(lattice.momenta.directions(kDiscs)) {}

  Surface surface() {
    make_places();
    values_ = values_at(places_);
    make_tetrahedra();
    for (int round = 0; round < kRounds && split_edges(); ++round) {
    }
    for (const Tetrahedron& corners : tetrahedra_) {
      if (is_known(corners)) cut(corners);
    }
    return {zeros(), std::move(triangles_), {}};
  }

 private:
  template <class Work>
  void for_all(int count, const Work& work) const {
    parallel_for(count, thread_count(lattice_.threads), work);
  }

  void make_places() {
    std::vector<double> reach(kDiscs * kAround, 1.0);
    if (lattice_.conjugate > 0) {
      for_all(kDiscs * kAround, [&](int k) {
        reach[k] = bound_along(lattice_.dynamics,
                               lattice_.from,
                               lattice_.momenta,
                               lattice_.conjugate,
                               {directions_[k / kAround], way_out(k % kAround)},
                               kDoublings);
        // The axes are as long as most are. A direction beside an abnormal one has no end.
        reach[k] = std::min(reach[k], kFarthest);
      });
    }
    for (int disc = 0; disc < kDiscs; ++disc) {
      places_.push_back({directions_[disc]});
      for (int i = 1; i <= kRings; ++i) {
        for (int j = 0; j < kAround; ++j) {
          const double part = reach[disc * kAround + j] * i / kRings;
          places_.push_back({directions_[disc], part * way_out(j)});
        }
      }
    }
  }

  // Of the condition, at these places.
  [[nodiscard]] std::vector<double> values_at(const std::vector<UnitMomentum>& places) const {
    std::vector<std::vector<double>> momenta;
    momenta.reserve(places.size());
    for (const UnitMomentum& place : places) momenta.push_back(lattice_.momenta.momentum(place));
    std::vector<std::vector<double>> longest;
    for (int k = kOnDisc - 1; k < kDiscs * kOnDisc; k += kOnDisc) {
      longest.push_back(lattice_.momenta.momentum(places_[k]));
    }
    const int n = lattice_.dynamics.dof;
    const std::vector<double> ends = ray_ends(
        lattice_.dynamics, lattice_.from, momenta, longest, lattice_.length, lattice_.threads);
    std::vector<double> values(places.size());
    for (std::size_t k = 0; k < places.size(); ++k) values[k] = section_.excess(&ends[k * n]);
    return values;
  }

  void make_tetrahedra() {
    for (int disc = 0; disc < kDiscs; ++disc) {
      const std::array<int, 2> base{disc * kOnDisc, (disc + 1) % kDiscs * kOnDisc};
      for (auto corners : triangles_of_disc()) {
        // In order, so that neighbouring prisms cut their common side by one diagonal.
        std::sort(corners.begin(), corners.end());
        const auto& [a, b, c] = corners;
        tetrahedra_.push_back({base[0] + a, base[0] + b, base[0] + c, base[1] + c});
        tetrahedra_.push_back({base[0] + a, base[0] + b, base[1] + b, base[1] + c});
        tetrahedra_.push_back({base[0] + a, base[1] + a, base[1] + b, base[1] + c});
      }
    }
  }

  // Whether the condition may vanish in between. Where the flow fails nothing is known, and values
  // further apart than half a turn have a jump between them and no zero.
  [[nodiscard]] bool is_known(const Tetrahedron& corners) const {
    double least = values_[corners[0]];
    double most = least;
    bool known = true;
    for (const int i : corners) {
      known = known && std::isfinite(values_[i]);
      least = std::min(least, values_[i]);
      most = std::max(most, values_[i]);
    }
    return known && most - least < section_.farthest();
  }

  // Splits the edges between whose ends the condition vanishes twice. False where there are none.
  bool split_edges() {
    std::vector<Edge> edges;
    std::vector<UnitMomentum> middles;
    for (const Tetrahedron& corners : tetrahedra_) {
      for (const auto& [i, j] : kSides) {
        const Edge edge = edge_of(corners[i], corners[j]);
        if (!seen_.insert(edge).second) continue;
        edges.push_back(edge);
        middles.push_back(between(places_[edge.first], places_[edge.second], 0.5));
      }
    }
    const std::vector<double> found = values_at(middles);
    std::map<Edge, SplitEdge> split;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const auto& [a, b] = edges[k];
      if (!vanishes_twice(values_[a], found[k], values_[b])) continue;
      const double length = length_between(places_[a], places_[b]);
      split.emplace(edges[k], SplitEdge{length, static_cast<int>(places_.size())});
      places_.push_back(middles[k]);
      values_.push_back(found[k]);
    }
    std::vector<Tetrahedron> whole;
    whole.swap(tetrahedra_);
    for (const Tetrahedron& corners : whole) add_parts(corners, split);
    return !split.empty();
  }

  // Whether the parabola through three values vanishes twice between the outer ones.
  [[nodiscard]] bool vanishes_twice(double a, double middle, double b) const {
    const bool jumps =
        !(std::abs(a - b) < section_.farthest()) || !(std::abs(a - middle) < section_.farthest());
    if (jumps || (a > 0) != (b > 0)) return false;
    if ((middle > 0) != (a > 0)) return true;
    // It is a + slope x + curvature x^2 with x from 0 to 1, and its extreme value is looked at.
    const double slope = 4 * middle - 3 * a - b;
    const double curvature = 2 * (a + b) - 4 * middle;
    const double at = -0.5 * slope / curvature;
    return at > 0 && at < 1 && (a + 0.5 * slope * at > 0) != (a > 0);
  }

  struct SplitEdge {
    double length;
    int middle;  // its place
  };
  // Each part is cut in two by its longest edge that is split. So neighbours agree on their common
  // side.
  void add_parts(const Tetrahedron& corners, const std::map<Edge, SplitEdge>& split) {
    const SplitEdge* longest = nullptr;
    std::pair<int, int> side;
    for (const auto& ends : kSides) {
      const auto found = split.find(edge_of(corners[ends.first], corners[ends.second]));
      if (found == split.end()) continue;
      const SplitEdge& one = found->second;
      const bool longer = longest == nullptr || one.length > longest->length ||
                          (one.length == longest->length && one.middle < longest->middle);
      if (!longer) continue;
      longest = &one;
      side = ends;
    }
    if (longest == nullptr) {
      tetrahedra_.push_back(corners);
      return;
    }
    for (const int end : {side.first, side.second}) {
      Tetrahedron part = corners;
      part[end] = longest->middle;
      add_parts(part, split);
    }
  }

  // The vertex on an edge of the lattice.
  int zero_on(int a, int b) {
    const Edge edge = edge_of(a, b);
    const auto [found, is_new] = zeros_.emplace(edge, static_cast<int>(edges_.size()));
    if (is_new) edges_.push_back(edge);
    return found->second;
  }

  void cut(const Tetrahedron& corners) {
    std::vector<int> above;
    std::vector<int> below;
    for (const int i : corners) (values_[i] > 0 ? above : below).push_back(i);
    if (above.size() == 2) {
      const std::array side{zero_on(above[0], below[0]),
                            zero_on(above[0], below[1]),
                            zero_on(above[1], below[1]),
                            zero_on(above[1], below[0])};
      triangles_.push_back({side[0], side[1], side[2]});
      triangles_.push_back({side[0], side[2], side[3]});
    } else if (above.size() == 1 || below.size() == 1) {
      const int alone = above.size() == 1 ? above[0] : below[0];
      const std::vector<int>& others = above.size() == 1 ? below : above;
      triangles_.push_back(
          {zero_on(alone, others[0]), zero_on(alone, others[1]), zero_on(alone, others[2])});
    }
  }

  [[nodiscard]] std::vector<SurfaceVertex> zeros() const {
    constexpr double kEnough = 1e-12;  // of an edge
    std::vector<SurfaceVertex> vertices(edges_.size());
    for_all(static_cast<int>(edges_.size()), [&](int k) {
      const int a = edges_[k].first;
      const int b = edges_[k].second;
      const auto place = [&](double part) { return between(places_[a], places_[b], part); };
      long steps = kFewestSteps;
      const auto value = [&](double part) {
        const double excess = section_.excess_at(place(part), steps);
        return std::isfinite(excess) ? std::optional(excess) : std::nullopt;
      };
      vertices[k].place = place(illinois(0, values_[a], 1, values_[b], kEnough, value));
    });
    return vertices;
  }

  const SectionLattice& lattice_;
  const EndSection& section_;
  std::vector<Eigen::Vector3d> directions_;
  std::vector<UnitMomentum> places_;
  std::vector<double> values_;  // of the condition
  std::vector<Tetrahedron> tetrahedra_;
  std::set<Edge> seen_;        // edges whose middles were looked at
  std::map<Edge, int> zeros_;  // the vertex of an edge that is crossed
  std::vector<Edge> edges_;    // in the order of vertices
  std::vector<std::array<int, 3>> triangles_;
};

}  // namespace

Eigen::Matrix2d plane_axes(const Dynamics& dynamics,
                           const std::vector<double>& from,
                           const UnitMomenta& momenta,
                           double conjugate,
                           int threads) {
  constexpr int kAngles = 12;
  constexpr int kHalvings = 5;
  constexpr int kDirections = 8;
  // How far it is out at an angle, to either side: the middle one of all directions.
  const auto width = [&](double angle) {
    std::vector<double> bounds = bounds_along(
        dynamics, from, momenta, conjugate, at_angle(angle), kDirections, kDoublings, threads);
    std::nth_element(bounds.begin(), bounds.begin() + kDirections, bounds.end());
    return std::min(bounds[kDirections], std::ldexp(1, kDoublings) / conjugate);
  };
  double best = 0;
  double widest = 0;
  const auto look_at = [&](double angle) {
    const double found = width(angle);
    if (!(found > widest)) return;
    widest = found;
    best = angle;
  };
  double step = std::numbers::pi / kAngles;
  for (int k = 0; k < kAngles; ++k) look_at(step * k);
  for (int i = 0; i < kHalvings; ++i) {
    step *= 0.5;
    const double middle = best;
    look_at(middle - step);
    look_at(middle + step);
  }
  const double across = best + 0.5 * std::numbers::pi;
  Eigen::Matrix2d axes;
  axes << widest * at_angle(best), width(across) * at_angle(across);
  return axes;
}

Surface section_surface(const SectionLattice& lattice, const EndSection& section) {
  return LatticeCutter(lattice, section).surface();
}

}  // namespace carnot::internal
