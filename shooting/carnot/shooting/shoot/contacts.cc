#include "carnot/shooting/shoot/contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "carnot/shooting/shoot/on_wall.h"

namespace carnot::internal {
namespace {

// Nodes in a row where the multiplier of a wall exceeds its slack.
struct Contact {
  int wall = 0;
  int first = 0;
  int last = 0;
  int strongest = 0;   // where the multiplier is largest
  int first_peak = 0;  // where it is larger than at both neighbours, first and last
  int last_peak = 0;
  double impulse = 0;  // the integral of the multiplier
};

// Whether velocities change the value of the wall there, so that an arc may keep to it.
bool is_of_first_order(const Walls& walls,
                       HamiltonianTerms& terms,
                       const Path& path,
                       const Contact& contact) {
  // ds.H_pp ds over its largest possible value. It vanishes where a wheel passes an obstacle, and
  // is one for the steering angle of a vehicle.
  constexpr double kNone = 1e-2;
  if (contact.first == contact.last) return false;
  const int n = path.dof;
  std::vector<double> z(path.configuration(contact.strongest),
                        path.configuration(contact.strongest) + n);
  z.insert(z.end(), path.momentum(contact.strongest), path.momentum(contact.strongest) + n);
  const WallAt wall = wall_at(walls, n, contact.wall, z.data());
  const Eigen::VectorXd moved = approach(terms, wall, z.data()).by_p;
  double largest = 0;
  for (int a = 0; a < n; ++a) largest = std::max(largest, std::abs(terms.pp(0, a, a)));
  return moved.dot(wall.gradient) > kNone * largest * wall.gradient.squaredNorm();
}

// In order of time. Nothing where two walls are met at once, or one at the start.
std::optional<std::vector<Contact>> contacts_of(const Walls& walls,
                                                const InteriorPointOptions& options,
                                                const LimitedPath& limited,
                                                double h) {
  const int last = limited.path.intervals;
  const int m = walls.size();
  std::vector<Contact> contacts;
  for (int node = 0; node <= last; ++node) {
    int met = -1;
    for (int w = 0; w < m; ++w) {
      const std::size_t i = static_cast<std::size_t>(node) * m + w;
      const double size = options.sizes[w];
      if (!(limited.nu[i] * size / options.rate > limited.sigma[i] / size)) continue;
      if (met >= 0 || node == 0) return std::nullopt;
      met = w;
    }
    if (met < 0) continue;
    const auto nu = [&](int at) { return limited.nu[static_cast<std::size_t>(at) * m + met]; };
    if (contacts.empty() || contacts.back().last + 1 < node) {
      contacts.push_back({met, node, node, node, -1, -1, 0});
    } else if (contacts.back().wall != met) {
      return std::nullopt;
    }
    Contact& contact = contacts.back();
    contact.last = node;
    contact.impulse += h * nu(node);
    if (nu(node) > nu(contact.strongest)) contact.strongest = node;
    if (node < last && nu(node) >= nu(node - 1) && nu(node) >= nu(node + 1)) {
      if (contact.first_peak < 0) contact.first_peak = node;
      contact.last_peak = node;
    }
  }
  for (Contact& contact : contacts) {
    if (contact.first_peak < 0) contact.first_peak = contact.last_peak = contact.strongest;
  }
  return contacts;
}

// The segments of a piece from node `begin` to `end`; on an arc eta grows to that value.
void fill_piece(const Walls& walls,
                const LimitedPath& limited,
                int begin,
                int end,
                double eta,
                int segments,
                Piece& piece) {
  const Path& path = limited.path;
  const double share = static_cast<double>(end - begin) / path.intervals;
  piece.segments = std::max(1, static_cast<int>(std::ceil(segments * share)));
  piece.segments = std::min(piece.segments, std::max(1, end - begin));
  for (int i = 0; i < piece.segments; ++i) {
    const int node = begin + (end - begin) * i / piece.segments;
    std::vector<double> z(path.configuration(node), path.configuration(node) + path.dof);
    z.insert(z.end(), path.momentum(node), path.momentum(node) + path.dof);
    if (piece.wall >= 0) {
      const double reached = eta * (node - begin) / (end - begin);
      const WallAt at = wall_at(walls, path.dof, piece.wall, z.data());
      for (int j = 0; j < path.dof; ++j) z[path.dof + j] += reached * at.gradient[j];
    }
    piece.z.insert(piece.z.end(), z.begin(), z.end());
  }
}

}  // namespace

std::optional<BoundExtremal> pieces_of(const BoundaryValueProblem& problem,
                                       const Walls& walls,
                                       const InteriorPointOptions& options,
                                       const LimitedPath& limited,
                                       Contacts as,
                                       int segments) {
  const Path& path = limited.path;
  const double h = problem.time / path.intervals;
  const auto contacts = contacts_of(walls, options, limited, h);
  if (!contacts) return std::nullopt;
  BoundExtremal extremal;
  HamiltonianTerms terms(problem.dynamics);
  int begin = 0;
  const auto add = [&](Piece piece, int end, double eta) {
    fill_piece(walls, limited, begin, end, eta, segments, piece);
    piece.end = end * h;
    extremal.pieces.push_back(std::move(piece));
    begin = end;
  };
  for (const Contact& contact : *contacts) {
    Piece free;
    const bool arc = as == Contacts::kArcs ||
                     (as == Contacts::kByOrder && is_of_first_order(walls, terms, path, contact));
    const bool stays = contact.last == path.intervals;
    if (stays && !arc) return std::nullopt;
    if (as == Contacts::kPairs) {
      if (contact.first_peak == contact.last_peak) return std::nullopt;
      free.touches = contact.wall;
      free.release = 0.5 * contact.impulse;
      add(free, contact.first_peak, 0);
      add(free, contact.last_peak, 0);
    } else if (!arc) {
      free.touches = contact.wall;
      free.release = contact.impulse;
      add(free, contact.strongest, 0);
    } else {
      if (contact.last == contact.first || contact.first <= begin) return std::nullopt;
      add(free, contact.first, 0);
      Piece held;
      held.wall = contact.wall;
      held.release = contact.impulse;
      add(held, contact.last, contact.impulse);
      if (stays) return extremal;
    }
  }
  add(Piece{}, path.intervals, 0);
  return extremal;
}

}  // namespace carnot::internal
