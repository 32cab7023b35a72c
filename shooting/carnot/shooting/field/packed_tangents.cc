#include "carnot/shooting/field/packed_tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "carnot/flow/dop853_adaptive.h"

namespace carnot::internal {
namespace {

constexpr int kLanes = kErasedLanes;
constexpr int kOrder = 8;
// Of 140,000 packs of a field of vehicles 97.5 per cent needed fewer than 86 coarse steps; the
// others, most of them with momenta that lead nowhere, took half of all the time.
constexpr double kMostCoarseSteps = 128;

struct alignas(64) Row : std::array<double, kLanes> {};

// Phase points side by side, and what their flow needs besides.
class Lanes {
 public:
  explicit Lanes(const BoundaryValueProblem& problem)
      : problem_(problem),
        n_(problem.dynamics.dof),
        memory_(4 * n_ + adaptive_rows(*problem.dynamics.functions)) {}

  void begin(int lane, const SmallVector& p0) {
    for (int j = 0; j < n_; ++j) {
      memory_[j][lane] = problem_.from[j];
      memory_[n_ + j][lane] = p0[j];
    }
  }
  // Where that fails, the lane that it fails in.
  std::optional<int> flow(double tolerance) {
    const Dynamics& dynamics = problem_.dynamics;
    const double most = kMostCoarseSteps * std::pow(kCoarseFlow / tolerance, 1.0 / kOrder);
    const AdaptiveFlow flow{*dynamics.functions,
                            dynamics.system.get(),
                            0,
                            problem_.time,
                            tolerance,
                            static_cast<long>(most)};
    const AdaptiveReport report = dop853_adaptive(flow, rows(0), rows(4 * n_));
    if (report.completed) return std::nullopt;
    return report.hardest;
  }
  // z' at the end of the flow. False where that fails in one of them.
  bool find_rates() {
    const Dynamics& dynamics = problem_.dynamics;
    Row time;
    time.fill(problem_.time);
    return dynamics.functions->rates(
        dynamics.system.get(), time.data(), rows(0), rows(4 * n_), rows(2 * n_));
  }
  // Entry k of z, and of z'.
  [[nodiscard]] double z(int k, int lane) const { return memory_[k][lane]; }
  [[nodiscard]] double rate(int k, int lane) const { return memory_[2 * n_ + k][lane]; }

 private:
  double* rows(int first) { return memory_[first].data(); }

  const BoundaryValueProblem& problem_;
  int n_;
  std::vector<Row> memory_;  // z, z', and what the flow works with
};

// Those of the list in packs, so many in each. `flow` returns which of them it fails with; the
// others are tried again without it.
template <class Flow>
void in_packs(const std::vector<std::size_t>& list, std::size_t together, const Flow& flow) {
  std::vector<std::size_t> some;
  for (std::size_t next = 0; next < list.size() || !some.empty();) {
    while (some.size() < together && next < list.size()) some.push_back(list[next++]);
    const std::optional<int> fails = flow(some);
    if (fails) {
      some.erase(some.begin() + *fails);
    } else {
      some.clear();
    }
  }
}

// Indices of these momenta, small ones first.
std::vector<std::size_t> by_size(std::span<const SmallVector> p0) {
  std::vector<std::size_t> order(p0.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return p0[a].squaredNorm() < p0[b].squaredNorm();
  });
  return order;
}

double least_of(std::span<const double> tolerances, const std::vector<std::size_t>& some) {
  double least = tolerances[some[0]];
  for (const std::size_t i : some) least = std::min(least, tolerances[i]);
  return least;
}

// The columns of a basis, as long as makes differences that are neither round-off nor bent.
SmallMatrix moves_along(const SmallMatrix& basis, const SmallVector& p0) {
  // Of a column that moves the end by one: round-off of 1e-16, which stiff extremals make a million
  // times as large, leaves four digits.
  constexpr double kDifference = 1e-6;
  constexpr double kMost = 1e-5;  // of the momentum
  SmallMatrix moves = basis;
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    moves.col(c) *= std::min(kDifference, kMost * p0.norm() / basis.col(c).norm());
  }
  return moves;
}

// Flows of a few extremals and of their neighbours, which fill the lanes one after the other.
std::optional<int> flow_tangents(const BoundaryValueProblem& problem,
                                 std::span<const SmallVector> p0,
                                 std::span<const SmallMatrix> bases,
                                 std::span<const double> tolerances,
                                 const std::vector<std::size_t>& some,
                                 std::span<PackedTangent> tangents) {
  const int n = problem.dynamics.dof;
  const auto count = static_cast<int>(some.size());
  // Idle lanes repeat the last one.
  const auto extremal_of = [n, count](int lane) { return std::min(lane / n, count - 1); };
  // Lane 1, 2, ... of an extremal moves along column 0, 1, ... without its own one.
  const auto column_of = [n](int lane, Eigen::Index own) {
    const Eigen::Index c = lane % n - 1;
    return c < own ? c : c + 1;
  };
  Lanes lanes(problem);
  std::vector<SmallVector> parts(count);  // of p0 along the columns
  std::vector<Eigen::Index> own(count);
  for (int i = 0; i < count; ++i) {
    PackedTangent& tangent = tangents[some[i]];
    tangent.d = moves_along(bases[some[i]], p0[some[i]]);
    parts[i] = small_lu_solve(tangent.d, p0[some[i]]);
    (void)parts[i].cwiseAbs().maxCoeff(&own[i]);
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const int i = extremal_of(lane);
    SmallVector p = p0[some[i]];
    if (lane / n < count && lane % n > 0) p += tangents[some[i]].d.col(column_of(lane, own[i]));
    lanes.begin(lane, p);
  }
  if (const auto fails = lanes.flow(least_of(tolerances, some))) return extremal_of(*fails);
  if (!lanes.find_rates()) return 0;
  for (int i = 0; i < count; ++i) {
    PackedTangent& tangent = tangents[some[i]];
    const int first = i * n;
    tangent.reached = true;
    tangent.q1.resize(n);
    tangent.p1.resize(n);
    tangent.j.resize(n, n);
    tangent.k.resize(n, n);
    for (int r = 0; r < n; ++r) {
      tangent.q1[r] = lanes.z(r, first);
      tangent.p1[r] = lanes.z(n + r, first);
      tangent.j(r, own[i]) = problem.time * lanes.rate(r, first);
      tangent.k(r, own[i]) = lanes.z(n + r, first) + problem.time * lanes.rate(n + r, first);
    }
    for (int lane = first + 1; lane < first + n; ++lane) {
      const Eigen::Index c = column_of(lane, own[i]);
      for (int r = 0; r < n; ++r) {
        tangent.j(r, c) = lanes.z(r, lane) - lanes.z(r, first);
        tangent.k(r, c) = lanes.z(n + r, lane) - lanes.z(n + r, first);
      }
      tangent.j.col(own[i]) -= parts[i][c] * tangent.j.col(c);
      tangent.k.col(own[i]) -= parts[i][c] * tangent.k.col(c);
    }
    tangent.j.col(own[i]) /= parts[i][own[i]];
    tangent.k.col(own[i]) /= parts[i][own[i]];
  }
  return std::nullopt;
}

}  // namespace

bool has_packs(const Dynamics& dynamics) {
  return dynamics.has_adaptive_batch() && dynamics.dof <= kLanes;
}

std::vector<PackedEnd> packed_ends(const BoundaryValueProblem& problem,
                                   std::span<const SmallVector> p0,
                                   std::span<const double> tolerances) {
  const int n = problem.dynamics.dof;
  std::vector<PackedEnd> ends(p0.size());
  in_packs(by_size(p0), kLanes, [&](const std::vector<std::size_t>& some) -> std::optional<int> {
    Lanes lanes(problem);
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes.begin(lane, p0[some[std::min<std::size_t>(lane, some.size() - 1)]]);
    }
    if (const auto fails = lanes.flow(least_of(tolerances, some))) {
      return std::min(*fails, static_cast<int>(some.size()) - 1);
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
      PackedEnd& end = ends[some[i]];
      end.reached = true;
      end.q1.resize(n);
      end.p1.resize(n);
      for (int r = 0; r < n; ++r) {
        end.q1[r] = lanes.z(r, static_cast<int>(i));
        end.p1[r] = lanes.z(n + r, static_cast<int>(i));
      }
    }
    return std::nullopt;
  });
  return ends;
}

std::vector<PackedTangent> packed_tangents(const BoundaryValueProblem& problem,
                                           std::span<const SmallVector> p0,
                                           std::span<const SmallMatrix> bases,
                                           std::span<const double> tolerances) {
  std::vector<PackedTangent> tangents(p0.size());
  in_packs(by_size(p0), kLanes / problem.dynamics.dof, [&](const std::vector<std::size_t>& some) {
    return flow_tangents(problem, p0, bases, tolerances, some, tangents);
  });
  return tangents;
}

}  // namespace carnot::internal
