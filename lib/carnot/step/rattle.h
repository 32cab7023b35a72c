// RATTLE on a system with velocity and holonomic constraints.
//
// The velocity constraints are eliminated by the system (index 1), the holonomic ones h(q) = 0 by
// impulses along the rows of Dh (McLachlan et al. 2013, Prop. 6). A substep of length h reads
//
//   p'  = p0 - Dh(q0)' nu0,                  nu0 = (h/2) mu0 such that h(q1) = 0,
//   (q1, p'') = (q0, p') + L,                L = h f(U),  U = (q0, p') + L/2,
//   p1  = p'' - Dh(q1)' nu1,                 nu1 such that Dh(q1) H_p(q1, p1) = 0.
//
// Second order, symmetric, and symplectic on the manifold h = 0, Dh H_p = 0; a symmetric
// composition of substeps h b_i has the order of the composition. Quadratic invariants whose flow
// leaves h alone are kept, since the midpoint rule and the impulses keep them.
//
// h(q1) is solved for afresh in each substep, so it stays at round-off whatever the number of
// steps, and so does the hidden constraint.
//
// The map is defined near the manifold: it forgets the part of p0 along Dh(q0), and a start off
// h = 0 is pulled back in one step by an impulse of its distance over h. So bring starting values
// to the manifold first (holonomic.h).
#pragma once

#include <algorithm>
#include <array>
#include <cassert>

#include "carnot/step/rattle_midpoint.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

template <HolonomicSystem System_, class T = double>
class Rattle {
 public:
  using System = System_;
  using Scalar = T;
  using Midpoint = RattleMidpoint<System, T>;
  static constexpr int kDof = System::kDof;
  static constexpr int kSize = 2 * kDof;
  static constexpr int kHolonomic = kHolonomicOf<System>;
  using Point = Vector<T, kSize>;
  using Impulse = Vector<T, kHolonomic>;
  using Algebraic = Vector<T, System::kAlgebraic>;
  using Stages = Eigen::Matrix<T, kSize, Eigen::Dynamic, 0, kSize, kMostStages>;

  // Keeps references to both. The tableau is a composition of midpoint rules: mu_ii = 1/2, and
  // mu_ij = 1 for j < i, 0 for j > i.
  Rattle(const System& system, const Tableau<T>& tableau) : system_(system), tableau_(tableau) {
    assert(composes_midpoints(tableau));
    stages_.resize(kSize, tableau.stages());
    increments_.resize(kSize, tableau.stages());
    std::fill_n(stages_.data(), stages_.size(), T(0));
    std::fill_n(increments_.data(), increments_.size(), T(0));
    start_on(filled<System::kAlgebraic>(T(0)));
  }
  Rattle(const System& system, Tableau<T>&& tableau) = delete;  // would dangle

  // The branch of H_y = 0 to begin with; zero leaves the choice to the system.
  void start_on(const Algebraic& y) {
    for (Algebraic& stage : algebraic_) stage = y;
    node_.algebraic = y;
    node_known_ = false;
    last_step_ = T(0);
  }
  // y at the last node.
  [[nodiscard]] const Algebraic& branch() const { return node_.algebraic; }

  // Advances z from t to t + h. On failure z is unchanged. Allocates nothing. In the report,
  // `newton` tells of steps that needed df/dz at more than one point, and `evaluations` leaves out
  // the calls on Jets, one or a few per substep.
  [[nodiscard]] StepReport step(const T& t, const T& h, State<T, kDof>& z) {
    StepReport report;
    if (!all_finite(z.value)) {
      fail(RateStatus::kNotFinite, report);
      return report;
    }
    const Algebraic branch = node_.algebraic;
    State<T, kDof> end = z;
    make_node(t, end, report);
    for (int i = 0; i < tableau_.stages() && report.status == StepStatus::kOk; ++i) {
      nodes_[i] = node_.z;
      node_algebraic_[i] = node_.algebraic;
      substep(i, t, h, end, report);
    }
    if (report.status != StepStatus::kOk) {
      start_on(branch);
      return report;
    }
    nodes_[tableau_.stages()] = node_.z;
    node_algebraic_[tableau_.stages()] = node_.algebraic;
    start_time_ = t;
    last_step_ = h;
    z = end;
    return report;
  }

  // What the last successful step left: the midpoints U_i, h b_i f(U_i), y_i, at times
  // start + c_i h.
  [[nodiscard]] const System& system() const { return system_; }
  [[nodiscard]] const Tableau<T>& tableau() const { return tableau_; }
  [[nodiscard]] const Stages& stages() const { return stages_; }
  [[nodiscard]] Point stage(int i) const { return Point(stages_.data() + kSize * i); }
  [[nodiscard]] const Stages& increments() const { return increments_; }
  [[nodiscard]] Algebraic algebraic(int i) const { return algebraic_[i]; }
  [[nodiscard]] T stage_time(int i) const { return start_time_ + tableau_.c[i] * last_step_; }
  [[nodiscard]] T last_step() const { return last_step_; }

  // The ends of its substeps, i = 0, ..., stages, and what holds there.
  [[nodiscard]] const Point& node(int i) const { return nodes_[i]; }
  [[nodiscard]] const Algebraic& node_algebraic(int i) const { return node_algebraic_[i]; }
  [[nodiscard]] T node_time(int i) const { return start_time_ + node_fraction(i) * last_step_; }
  // nu0 and nu1 of substep i.
  [[nodiscard]] const Impulse& impulse_before(int i) const { return impulse_before_[i]; }
  [[nodiscard]] const Impulse& impulse_after(int i) const { return impulse_after_[i]; }

 private:
  static bool composes_midpoints(const Tableau<T>& tableau) {
    if (tableau.partitioned || tableau.stages() < 1) return false;
    for (int i = 0; i < tableau.stages(); ++i) {
      if (tableau.mu(i, i) != T(1) / T(2) || tableau.b[i] == T(0)) return false;
      for (int j = 0; j < i; ++j) {
        if (tableau.mu(i, j) != T(1) || tableau.mu(j, i) != T(0)) return false;
      }
    }
    return true;
  }

  // Where the end of substep i - 1 is in the step.
  [[nodiscard]] T node_fraction(int i) const {
    return i == tableau_.stages() ? T(1) : tableau_.c[i] - tableau_.b[i] / T(2);
  }

  static void fail(RateStatus rate, StepReport& report) {
    report.rate = rate;
    report.status = StepStatus::kRateFailed;
  }

  // The node where a step starts, unless the last one ended there.
  void make_node(const T& t, const State<T, kDof>& z, StepReport& report) {
    if (node_known_ && node_.z == z.value) return;
    node_known_ = false;
    node_.z = z.value;
    node_.force = filled<kHolonomic>(T(0));
    const RateStatus status = phase_rate(system_, t, node_.z, node_.algebraic, node_.rate);
    ++report.evaluations;
    if (status != RateStatus::kOk) return fail(status, report);
    linearise(t, node_.z, report);
  }

  // A, Dh and the inverse of Dh H_pp Dh' of the node, at a point z that has its q.
  void linearise(const T& t, const Point& z, StepReport& report) {
    const RateStatus status = phase_jacobian(system_, t, z, node_.algebraic, node_.jacobian);
    if (status != RateStatus::kOk) return fail(status, report);
    node_.dh = holonomic_jacobian(system_.scene(), part<0, kDof>(z));
    const Matrix<T, kDof, kDof> h_pp = momentum_hessian<kDof>(node_.jacobian);
    if (!invert_normal_mass(node_.dh, h_pp, node_.inverse)) {
      fail(RateStatus::kConstraintRank, report);
    }
  }

  void substep(int i, const T& t, const T& step, State<T, kDof>& z, StepReport& report) {
    const T h = step * tableau_.b[i];
    if (!midpoint_.solve(system_, node_, t + tableau_.c[i] * step, h, z, report)) return;
    for (int k = 0; k < kSize; ++k) {
      stages_(k, i) = midpoint_.point()[k];
      increments_(k, i) = midpoint_.increment()[k];
    }
    algebraic_[i] = midpoint_.algebraic();
    impulse_before_[i] = midpoint_.impulse();
    Point change = midpoint_.increment();
    apply_impulse(node_.dh, midpoint_.impulse(), change);
    z.add(change);
    finish(i, t + node_fraction(i + 1) * step, z, report);
    for (int k = 0; k < kHolonomic; ++k) node_.force[k] = T(2) / h * impulse_after_[i][k];
  }

  // The impulse after, and the node that it leads to. df/dz is taken where nu0, close to nu1,
  // leads.
  void finish(int i, const T& t, State<T, kDof>& z, StepReport& report) {
    Impulse& nu = impulse_after_[i];
    nu = impulse_before_[i];
    node_.algebraic = algebraic_[i];
    Point guess = z.value;
    const Vector<T, kDof> q = part<0, kDof>(z.value);
    apply_impulse(holonomic_jacobian(system_.scene(), q), nu, guess);
    linearise(t, guess, report);
    if (report.status != StepStatus::kOk) return;
    const RateStatus status = solve_hidden_constraint(system_,
                                                      t,
                                                      node_.dh,
                                                      node_.inverse,
                                                      z,
                                                      nu,
                                                      node_.algebraic,
                                                      node_.rate,
                                                      report.evaluations);
    if (status != RateStatus::kOk) fail(status, report);
    if (status == RateStatus::kNoSolution) report.status = StepStatus::kStagesDiverged;
    node_.z = z.value;
    node_known_ = true;
  }

  const System& system_;
  const Tableau<T>& tableau_;
  Stages stages_;
  Stages increments_;
  std::array<Algebraic, kMostStages> algebraic_;
  std::array<Impulse, kMostStages> impulse_before_;
  std::array<Impulse, kMostStages> impulse_after_;
  std::array<Point, kMostStages + 1> nodes_;
  std::array<Algebraic, kMostStages + 1> node_algebraic_;
  RattleNode<System, T> node_;
  bool node_known_ = false;
  T start_time_ = T(0);
  T last_step_ = T(0);
  Midpoint midpoint_;  // scratch
};

// In rattle_tangent.h: tangent_flow() needs it.
template <class Step>
class Tangent;
template <class System, class T>
class Tangent<Rattle<System, T>>;

}  // namespace carnot
