// A scene and a method behind a handful of function pointers: where templates end.
//
// Relaxation, shooting, NLopt and the apps are compiled once against this struct; make_dynamics.h
// makes one. All arrays are spans of the caller's memory: q, its velocity and p have n entries,
// lambda has k, z = (q, p) has 2n. Sizes are asserted, and so is that an optional call is there.
// One indirect call per trajectory; inside it everything is inlined.
#pragma once

#include <cassert>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "carnot/flow/flow_calls.h"
#include "carnot/scene/scene_info.h"

namespace carnot {

struct SystemFunctions;
struct TranscriptionFunctions;

// H, velocity and multipliers at one phase point.
struct PointValues {
  RateStatus status = RateStatus::kOk;
  std::optional<Regularity> regularity;  // of H_yy, where y is found by Newton's method
  double hamiltonian = std::numeric_limits<double>::quiet_NaN();
};

// How far a phase point is from the manifold of the holonomic constraints. What is relative has no
// unit: an h_i stands against sum_j |d_j h_i| s_j, where s_j is the largest coordinate that has the
// unit of q_j (where that is radian or one, at least 1), and (Dh q')_i against the same of q'.
struct HolonomicResiduals {
  double position = 0;  // max |h(q)|
  double relative_position = 0;
  double relative_velocity = std::numeric_limits<double>::quiet_NaN();  // where there is a rate
};

struct Dynamics {
  int dof = 0;
  int multipliers = 0;
  int transcribed = 0;  // constraints of the midpoint transcription; k for velocity constraints
  int holonomic = 0;    // number of constraints h(q) = 0,
  int forced = 0;       // and of those kept by forces: momenta along their Dh move nothing
  // Whether the forced constraints are kept as Dh q' = 0: then the flow exists beside the manifold,
  // too.
  bool on_leaves = false;
  bool autonomous = true;  // H does not depend on time
  std::string method;
  int order = 0;
  bool symplectic = true;
  SceneInfo info;
  std::shared_ptr<const void> system;  // what the calls take, and the kernel's, too
  const SystemFunctions* functions = nullptr;
  // Null where there is no midpoint transcription.
  const TranscriptionFunctions* transcription = nullptr;
  Kernel kernel;  // the method

  // Advances z in place; on failure z is that of time_reached. No allocation.
  [[nodiscard]] FlowReport flow(const StepPlan& plan, std::span<double> z) const {
    assert(std::ssize(z) == 2 * dof);
    return kernel.calls.flow(system.get(), kernel.method.get(), plan, z.data());
  }
  // The same, and m = dz(end)/dz(start), row-major 2n x 2n. No allocation.
  [[nodiscard]] FlowReport tangent_flow(const StepPlan& plan,
                                        std::span<double> z,
                                        std::span<double> m) const {
    assert(std::ssize(z) == 2 * dof && std::ssize(m) == 4 * dof * dof);
    return kernel.calls.tangent_flow(
        system.get(), kernel.method.get(), plan, z.data(), m.data(), nullptr);
  }
  // The same step by step: row i of `nodes`, plan.count x 2n, is z after step i, and tangents[i],
  // row-major 2n x 2n, is the derivative of that step by the node before. In some 0.6 of the
  // time of a call for each step. No allocation.
  [[nodiscard]] FlowReport tangent_steps(const StepPlan& plan,
                                         std::span<double> z,
                                         std::span<double> nodes,
                                         std::span<double> tangents) const {
    assert(std::ssize(z) == 2 * dof && std::ssize(nodes) == 2 * dof * plan.count);
    assert(std::ssize(tangents) == 4 * dof * dof * plan.count);
    return kernel.calls.tangent_flow(
        system.get(), kernel.method.get(), plan, z.data(), tangents.data(), nodes.data());
  }
  // Advances z with an error of about `tolerance`, constant steps chosen by a trial; see
  // automatic_flow.h. Only where has_automatic_flow(). No allocation.
  [[nodiscard]] AutomaticFlow automatic_flow(double start,
                                             double duration,
                                             double tolerance,
                                             std::span<double> z) const {
    assert(has_automatic_flow() && std::ssize(z) == 2 * dof);
    return kernel.calls.automatic_flow(
        system.get(), kernel.method.get(), start, duration, tolerance, z.data());
  }
  // Of Gauss methods with kLeastSampled stages or more.
  [[nodiscard]] bool has_automatic_flow() const { return kernel.calls.automatic_flow != nullptr; }
  // Advances `count` phase points, one after the other in z, over the plan; on `threads` threads
  // (0: all cores). Those that fail become NaN. z has 2n `count` entries.
  [[nodiscard]] BatchReport flow_batch(const StepPlan& plan,
                                       int count,
                                       std::span<double> z,
                                       int threads = 0) const;
  // The same with an error of about `tolerance` each, side by side with an explicit method of
  // order 8 and adaptive steps: fast, and not symplectic. Only where has_adaptive_batch().
  [[nodiscard]] BatchReport adaptive_batch(double start,
                                           double duration,
                                           double tolerance,
                                           int count,
                                           std::span<double> z,
                                           int threads = 0) const;
  // Of gauss16, where the rates run side by side.
  [[nodiscard]] bool has_adaptive_batch() const { return kernel.fills_packs; }
  // The same as flow(), measured and recorded.
  [[nodiscard]] FlowSummary monitored_flow(const StepPlan& plan,
                                           std::span<double> z,
                                           const MonitorOptions& options) const {
    assert(std::ssize(z) == 2 * dof);
    return kernel.calls.monitored_flow(system.get(), kernel.method.get(), plan, z.data(), options);
  }
  // H, q' and lambda at (t, q, p).
  PointValues evaluate(double t,
                       std::span<const double> q,
                       std::span<const double> p,
                       std::span<double> q_dot,
                       std::span<double> lambda) const;
  // Vanishes where the coordinates are singular; 1 for a scene where they nowhere are. A path from
  // one sign to the other passes such a point.
  [[nodiscard]] double chart(std::span<const double> q) const {
    assert(std::ssize(q) == dof);
    return calls.chart != nullptr ? calls.chart(system.get(), q.data()) : 1.0;
  }
  // p of the velocity, which is projected on the admissible ones first. Returns how far that moved
  // it, relative to it, NaN on failure (system/mass_norm.h).
  double momentum(double t,
                  std::span<const double> q,
                  std::span<double> q_dot,
                  std::span<const double> lambda,
                  std::span<double> p) const {
    assert(std::ssize(q) == dof && std::ssize(q_dot) == dof);
    assert(std::ssize(lambda) == multipliers && std::ssize(p) == dof);
    return calls.momentum(system.get(), t, q.data(), q_dot.data(), lambda.data(), p.data());
  }
  // The same Dynamics on the branch of H_y = 0 through the multipliers nearest to `lambda` at
  // (t, q, p); nothing where the scene has one branch only, or none is found.
  [[nodiscard]] std::optional<Dynamics> on_branch(double t,
                                                  std::span<const double> q,
                                                  std::span<const double> p,
                                                  std::span<const double> lambda) const {
    assert(std::ssize(q) == dof && std::ssize(p) == dof && std::ssize(lambda) == multipliers);
    if (!has_branches()) return std::nullopt;
    Dynamics dynamics = *this;
    dynamics.system = calls.branch(system.get(), t, q.data(), p.data(), lambda.data());
    if (dynamics.system == nullptr) return std::nullopt;
    return dynamics;
  }
  // Whether H_y = 0 may have more than one solution y.
  [[nodiscard]] bool has_branches() const { return calls.branch != nullptr; }

  // With holonomic constraints only, at z = (q, p): residuals; the nearest point of the manifold,
  // false where there is none; the orthogonal projector on its tangent space, 2n x 2n.
  [[nodiscard]] HolonomicResiduals holonomic_residuals(double t, std::span<const double> z) const;
  [[nodiscard]] bool project_on_manifold(double t, std::span<double> z) const {
    assert(has_holonomic() && std::ssize(z) == 2 * dof);
    return calls.project_on_manifold(system.get(), t, z.data());
  }
  [[nodiscard]] bool tangent_projector(double t,
                                       std::span<const double> z,
                                       std::span<double> projector) const {
    assert(has_holonomic() && std::ssize(z) == 2 * dof && std::ssize(projector) == 4 * dof * dof);
    return calls.tangent_projector(system.get(), t, z.data(), projector.data());
  }
  // Whether there are holonomic constraints.
  [[nodiscard]] bool has_holonomic() const { return calls.holonomic != nullptr; }

  // Whether there is a direct midpoint transcription; k stands for `transcribed` in what follows.
  [[nodiscard]] bool has_transcription() const { return transcription != nullptr; }
  // Terms of one midpoint interval at (qm, v): r (n), c (k), V (1), stacked; jacobian row-major
  // (n + k + 1) x 2n with respect to (qm, v), or empty where it is not wanted.
  [[nodiscard]] bool midpoint(std::span<const double> qm,
                              std::span<const double> v,
                              std::span<double> terms,
                              std::span<double> jacobian = {}) const;
  // How many intervals `midpoints` and `discrete_lagrangians` take side by side.
  static constexpr int kMidpointLanes = 8;
  // The same as `midpoint` for kMidpointLanes intervals: number i of interval l is at
  // i * kMidpointLanes + l of each array. False where one of them fails; its terms are NaN then,
  // and those of the others are what they would be without it. Several times as fast.
  [[nodiscard]] bool midpoints(std::span<const double> qm,
                               std::span<const double> v,
                               std::span<double> terms,
                               std::span<double> jacobian = {}) const;
  // Gradient and Hessian of the discrete Lagrangian F_d with respect to x = (q0, q1, lambda), of
  // length 2n + k: the discrete momenta are p0 = -gradient[0..n), p1 = gradient[n..2n). The Hessian
  // is symmetric, (2n + k)^2, or empty where it is not wanted.
  void discrete_lagrangian(double h,
                           std::span<const double> x,
                           std::span<double> gradient,
                           std::span<double> hessian = {}) const;
  // The same for kMidpointLanes intervals side by side.
  void discrete_lagrangians(double h,
                            std::span<const double> x,
                            std::span<double> gradient,
                            std::span<double> hessian = {}) const;
  // The multipliers of the transcription at a phase point.
  void midpoint_multipliers(std::span<const double> q,
                            std::span<const double> p,
                            std::span<double> lambda) const;

  struct Calls {
    Regularity (*regularity)(const void*, double, const double*, const double*);
    double (*chart)(const void*, const double*);
    double (*momentum)(const void*, double, const double*, double*, const double*, double*);
    std::shared_ptr<const void> (*branch)(
        const void*, double, const double*, const double*, const double*);
    // h(q), Dh(q) row by row, and q' at z: NaN where there is no rate.
    void (*holonomic)(const void*, double, const double*, double*, double*, double*);
    bool (*project_on_manifold)(const void*, double, double*);
    bool (*tangent_projector)(const void*, double, const double*, double*);
  };
  Calls calls{};
};

}  // namespace carnot
