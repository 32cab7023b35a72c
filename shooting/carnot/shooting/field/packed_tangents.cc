#include "carnot/shooting/field/packed_tangents.h"

#include <algorithm>
#include <array>
#include <vector>

#include "carnot/flow/dop853_adaptive.h"

namespace carnot::internal {
namespace {

constexpr int W = kErasedLanes;

struct alignas(64) Row : std::array<double, W> {};

}  // namespace

int packed_extremals(const Dynamics& dynamics) {
  return dynamics.has_adaptive_batch() ? W / (dynamics.dof + 1) : 0;
}

void packed_tangents(const BoundaryValueProblem& problem,
                     std::span<const SmallVector> p0,
                     std::span<PackedTangent> tangents) {
  constexpr double kTolerance = 1e-6;
  // Of the largest momentum; between the square root of round-off and what bends.
  constexpr double kDifference = 1e-7;
  const Dynamics& dynamics = problem.dynamics;
  const int n = dynamics.dof;
  const auto count = static_cast<int>(p0.size());
  std::vector<Row> memory(2 * n + adaptive_rows(*dynamics.functions));
  std::array<double, W> moved{};
  for (int lane = 0; lane < W; ++lane) {
    const int i = std::min(lane / (n + 1), count - 1);  // idle lanes repeat the last one
    const int c = lane / (n + 1) < count ? lane % (n + 1) - 1 : -1;
    moved[lane] = kDifference * p0[i].cwiseAbs().maxCoeff();
    for (int j = 0; j < n; ++j) {
      memory[j][lane] = problem.from[j];
      memory[n + j][lane] = p0[i][j] + (j == c ? moved[lane] : 0);
    }
  }
  const AdaptiveFlow flow{*dynamics.functions, dynamics.system.get(), 0, problem.time, kTolerance};
  double* const z = memory.front().data();
  const bool known = dop853_adaptive(flow, z, z + 2L * n * W).completed;
  for (int i = 0; i < count; ++i) {
    PackedTangent& tangent = tangents[i];
    tangent.known = known;
    if (!known) continue;
    const int own = i * (n + 1);
    tangent.q1.resize(n);
    tangent.j.resize(n, n);
    tangent.k.resize(n, n);
    for (int r = 0; r < n; ++r) {
      tangent.q1[r] = memory[r][own];
      for (int c = 0; c < n; ++c) {
        const int lane = own + 1 + c;
        tangent.j(r, c) = (memory[r][lane] - memory[r][own]) / moved[lane];
        tangent.k(r, c) = (memory[n + r][lane] - memory[n + r][own]) / moved[lane];
      }
    }
  }
}

}  // namespace carnot::internal
