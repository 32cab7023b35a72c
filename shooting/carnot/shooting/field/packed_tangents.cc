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

constexpr int W = kErasedLanes;
constexpr int kOrder = 8;
// Of 140,000 packs of a field of vehicles 97.5 per cent needed fewer than 86 coarse steps; the
// others, most of them with momenta that lead nowhere, took half of all the time.
constexpr double kMostCoarseSteps = 128;

struct alignas(64) Row : std::array<double, W> {};

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

Eigen::Index largest_of(const SmallVector& p0) {
  Eigen::Index largest = 0;
  (void)p0.cwiseAbs().maxCoeff(&largest);
  return largest;
}

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

// Flows of a few extremals and of their neighbours, which fill the lanes one after the other.
std::optional<int> flow_tangents(const BoundaryValueProblem& problem,
                                 std::span<const SmallVector> p0,
                                 const std::vector<std::size_t>& some,
                                 std::span<PackedTangent> tangents) {
  // Of the largest momentum; between the square root of round-off and what bends.
  constexpr double kDifference = 1e-7;
  const int n = problem.dynamics.dof;
  const auto count = static_cast<int>(some.size());
  // Idle lanes repeat the last one.
  const auto extremal_of = [n, count](int lane) { return std::min(lane / n, count - 1); };
  Lanes lanes(problem);
  std::array<double, W> moved{};
  for (int lane = 0; lane < W; ++lane) {
    const int i = extremal_of(lane);
    SmallVector p = p0[some[i]];
    if (lane / n < count && lane % n > 0) {
      const Eigen::Index own = largest_of(p);
      const Eigen::Index c = lane % n - 1 + (lane % n - 1 < own ? 0 : 1);
      moved[lane] = kDifference * std::abs(p[own]);
      p[c] += moved[lane];
    }
    lanes.begin(lane, p);
  }
  if (const auto fails = lanes.flow(kCoarseFlow)) return extremal_of(*fails);
  if (!lanes.find_rates()) return 0;
  for (int i = 0; i < count; ++i) {
    PackedTangent& tangent = tangents[some[i]];
    const SmallVector& p = p0[some[i]];
    const int first = i * n;
    tangent.reached = true;
    tangent.q1.resize(n);
    tangent.p1.resize(n);
    tangent.j.resize(n, n);
    tangent.k.resize(n, n);
    const Eigen::Index own = largest_of(p);
    for (int r = 0; r < n; ++r) {
      tangent.q1[r] = lanes.z(r, first);
      tangent.p1[r] = lanes.z(n + r, first);
      tangent.j(r, own) = problem.time * lanes.rate(r, first);
      tangent.k(r, own) = lanes.z(n + r, first) + problem.time * lanes.rate(n + r, first);
    }
    for (int lane = first + 1; lane < first + n; ++lane) {
      const Eigen::Index c = lane - first - 1 + (lane - first - 1 < own ? 0 : 1);
      for (int r = 0; r < n; ++r) {
        tangent.j(r, c) = (lanes.z(r, lane) - lanes.z(r, first)) / moved[lane];
        tangent.k(r, c) = (lanes.z(n + r, lane) - lanes.z(n + r, first)) / moved[lane];
      }
      tangent.j.col(own) -= p[c] * tangent.j.col(c);
      tangent.k.col(own) -= p[c] * tangent.k.col(c);
    }
    tangent.j.col(own) /= p[own];
    tangent.k.col(own) /= p[own];
  }
  return std::nullopt;
}

}  // namespace

bool has_packs(const Dynamics& dynamics) {
  return dynamics.has_adaptive_batch() && dynamics.dof <= W;
}

std::vector<PackedEnd> packed_ends(const BoundaryValueProblem& problem,
                                   std::span<const SmallVector> p0,
                                   double tolerance) {
  const int n = problem.dynamics.dof;
  std::vector<PackedEnd> ends(p0.size());
  in_packs(by_size(p0), W, [&](const std::vector<std::size_t>& some) -> std::optional<int> {
    Lanes lanes(problem);
    for (int lane = 0; lane < W; ++lane) {
      lanes.begin(lane, p0[some[std::min<std::size_t>(lane, some.size() - 1)]]);
    }
    if (const auto fails = lanes.flow(tolerance)) {
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
                                           std::span<const SmallVector> p0) {
  std::vector<PackedTangent> tangents(p0.size());
  in_packs(by_size(p0), W / problem.dynamics.dof, [&](const std::vector<std::size_t>& some) {
    return flow_tangents(problem, p0, some, tangents);
  });
  return tangents;
}

}  // namespace carnot::internal
