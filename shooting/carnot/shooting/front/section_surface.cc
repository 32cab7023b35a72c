#include "carnot/shooting/front/section_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/front/columns.h"
#include "carnot/shooting/front/ray_ends.h"
#include "carnot/shooting/linear/illinois.h"

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

class LatticeCutter {
 public:
  LatticeCutter(const SectionLattice& lattice, const EndSection& section)
      : lattice_(lattice), section_(section), directions_(lattice.momenta.directions(kDiscs)) {}

  Surface surface() {
    make_places();
    make_values();
    make_tetrahedra();
    for (const Tetrahedron& corners : tetrahedra_) cut(corners);
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

  void make_values() {
    std::vector<std::vector<double>> momenta;
    momenta.reserve(places_.size());
    for (const UnitMomentum& place : places_) momenta.push_back(lattice_.momenta.momentum(place));
    std::vector<std::vector<double>> longest;
    for (std::size_t k = kOnDisc - 1; k < momenta.size(); k += kOnDisc) {
      longest.push_back(momenta[k]);
    }
    const int n = lattice_.dynamics.dof;
    const std::vector<double> ends = ray_ends(
        lattice_.dynamics, lattice_.from, momenta, longest, lattice_.length, lattice_.threads);
    for (std::size_t k = 0; k < places_.size(); ++k) {
      values_.push_back(section_.excess(&ends[k * n]));
    }
  }

  void make_tetrahedra() {
    for (int disc = 0; disc < kDiscs; ++disc) {
      const std::array<int, 2> base{disc * kOnDisc, (disc + 1) % kDiscs * kOnDisc};
      for (auto corners : triangles_of_disc()) {
        // In order, so that neighbouring prisms cut their common side by one diagonal.
        std::sort(corners.begin(), corners.end());
        const auto& [a, b, c] = corners;
        add({base[0] + a, base[0] + b, base[0] + c, base[1] + c});
        add({base[0] + a, base[0] + b, base[1] + b, base[1] + c});
        add({base[0] + a, base[1] + a, base[1] + b, base[1] + c});
      }
    }
  }
  void add(const Tetrahedron& corners) {
    double least = values_[corners[0]];
    double most = least;
    bool known = true;  // where the flow fails nothing is
    for (const int i : corners) {
      known = known && std::isfinite(values_[i]);
      least = std::min(least, values_[i]);
      most = std::max(most, values_[i]);
    }
    // Values further apart than half a turn have a jump between them and no zero.
    known = known && most - least < section_.farthest();
    if (known) tetrahedra_.push_back(corners);
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
      const auto value = [&](double part) {
        const double excess = section_.excess_at(place(part));
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
