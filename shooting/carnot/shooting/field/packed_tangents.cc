#include "carnot/shooting/field/packed_tangents.h"

#include <algorithm>
#include <array>
#include <vector>

#include "carnot/flow/dop853_adaptive.h"

namespace carnot::internal {
namespace {

constexpr int W = kErasedLanes;
constexpr double kTolerance = 1e-6;
// Of 140,000 packs of a field of vehicles 97.5 per cent needed fewer than 86; the others, most of
// them with momenta that lead nowhere, took half of all the time.
constexpr long kMostSteps = 128;

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
  // False where that fails in one of them.
  bool flow() {
    const Dynamics& dynamics = problem_.dynamics;
    const AdaptiveFlow flow{
        *dynamics.functions, dynamics.system.get(), 0, problem_.time, kTolerance, kMostSteps};
    return dop853_adaptive(flow, rows(0), rows(4 * n_)).completed;
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

}  // namespace

int ends_of_a_pack(const Dynamics& dynamics) { return dynamics.has_adaptive_batch() ? W : 0; }

int tangents_of_a_pack(const Dynamics& dynamics) {
  return dynamics.has_adaptive_batch() ? W / dynamics.dof : 0;
}

bool packed_ends(const BoundaryValueProblem& problem,
                 std::span<const SmallVector> p0,
                 std::span<SmallVector> q1) {
  const int n = problem.dynamics.dof;
  const auto count = static_cast<int>(p0.size());
  Lanes lanes(problem);
  for (int lane = 0; lane < W; ++lane) lanes.begin(lane, p0[std::min(lane, count - 1)]);
  if (!lanes.flow()) return false;
  for (int i = 0; i < count; ++i) {
    q1[i].resize(n);
    for (int r = 0; r < n; ++r) q1[i][r] = lanes.z(r, i);
  }
  return true;
}

bool packed_tangents(const BoundaryValueProblem& problem,
                     std::span<const SmallVector> p0,
                     std::span<PackedTangent> tangents) {
  // Of the largest momentum; between the square root of round-off and what bends.
  constexpr double kDifference = 1e-7;
  const int n = problem.dynamics.dof;
  const auto count = static_cast<int>(p0.size());
  Lanes lanes(problem);
  std::array<double, W> moved{};
  for (int lane = 0; lane < W; ++lane) {
    const int i = std::min(lane / n, count - 1);  // idle lanes repeat the last one
    SmallVector p = p0[i];
    if (lane / n < count && lane % n > 0) {
      const Eigen::Index own = largest_of(p);
      const Eigen::Index c = lane % n - 1 + (lane % n - 1 < own ? 0 : 1);
      moved[lane] = kDifference * std::abs(p[own]);
      p[c] += moved[lane];
    }
    lanes.begin(lane, p);
  }
  if (!lanes.flow() || !lanes.find_rates()) return false;
  for (int i = 0; i < count; ++i) {
    PackedTangent& tangent = tangents[i];
    const int first = i * n;
    tangent.q1.resize(n);
    tangent.j.resize(n, n);
    tangent.k.resize(n, n);
    const Eigen::Index own = largest_of(p0[i]);
    for (int r = 0; r < n; ++r) {
      tangent.q1[r] = lanes.z(r, first);
      tangent.j(r, own) = problem.time * lanes.rate(r, first);
      tangent.k(r, own) = lanes.z(n + r, first) + problem.time * lanes.rate(n + r, first);
    }
    for (int lane = first + 1; lane < first + n; ++lane) {
      const Eigen::Index c = lane - first - 1 + (lane - first - 1 < own ? 0 : 1);
      for (int r = 0; r < n; ++r) {
        tangent.j(r, c) = (lanes.z(r, lane) - lanes.z(r, first)) / moved[lane];
        tangent.k(r, c) = (lanes.z(n + r, lane) - lanes.z(n + r, first)) / moved[lane];
      }
      tangent.j.col(own) -= p0[i][c] * tangent.j.col(c);
      tangent.k.col(own) -= p0[i][c] * tangent.k.col(c);
    }
    tangent.j.col(own) /= p0[i][own];
    tangent.k.col(own) /= p0[i][own];
  }
  return true;
}

}  // namespace carnot::internal
