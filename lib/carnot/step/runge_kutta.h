// One step of any Runge-Kutta method, given as a Tableau, on an index-1 system.
//
// A Runge-Kutta method applied to J z' = grad H(z), J singular, solves H_y = 0 at every stage, so
// it equals the method applied to the system with y eliminated (McLachlan et al. 2013, Prop. 4):
// order, symplecticity and constraints follow; of a partitioned method the multipliers belong to
// the pairs (Q_i, P_i) (their section 7). With L_i = h omega_i f(U_i) a step reads
//
//   U_i = z + e + sum_j mu_ij L_j,      z+ = z + e + sum_j u_j L_j,
//
// where e is the rounding error that the last updates left (compensated summation). Implicit stages
// are found by fixed-point iteration, started from the extrapolated collocation polynomial of the
// last step, or from the stage before. It goes on while for some component the largest change over
// the stages is still falling (Antonana, Makazaga & Murua 2017), so it ends at round-off whatever
// the scale of the components; or, where a run is asked for a tolerance, until no stage changes by
// more than stop_at(). If that is not reached, or slowly, Newton's method takes over
// (stage_newton.h).
//
// Rates of coupled stages are evaluated side by side in packs where the system allows it, and one
// by one where one of them fails, which tells the reason.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <type_traits>

#include "carnot/numerics/scalar.h"
#include "carnot/step/packed_stages.h"
#include "carnot/step/stage_equations.h"
#include "carnot/step/stage_newton.h"
#include "carnot/step/stage_workspace.h"
#include "carnot/step/step_report.h"
#include "carnot/system/packed_iteration.h"
#include "carnot/system/packed_rate.h"
#include "carnot/system/phase_space.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// s: the number of stages where the compiler is to know it (full coupling only), else kAnyStages.
template <class System_, int s = kAnyStages, class T = double>
class RungeKutta {
 public:
  using Workspace = StageWorkspace<System_, s, T>;
  using System = System_;
  using Scalar = T;
  using Algebraic = typename Workspace::Algebraic;
  using Stages = typename Workspace::Stages;
  using Point = typename Workspace::Point;
  static constexpr int kDof = System::kDof;
  static constexpr int kSize = Workspace::kSize;
  static constexpr int kMaxStages = Workspace::kMaxStages;
  static constexpr int kMaxCoupled = Workspace::kMaxCoupled;
  static constexpr int kLanes = Workspace::kLanes;
  static constexpr bool kPacks = Workspace::kPacks;
  static constexpr bool kRows = Workspace::kRows;

  // Keeps references to both.
  RungeKutta(const System& system, const Tableau<T, s>& tableau) : work_(system, tableau) {
    assert(tableau.coupling == Coupling::kFull || (s == kAnyStages && !tableau.partitioned));
    assert(tableau.stages() <= (work_.coupled() ? kMaxCoupled : kMaxStages));
  }
  RungeKutta(const System& system, Tableau<T, s>&& tableau) = delete;  // would dangle

  // The branch of H_y = 0 to begin with; zero leaves the choice to the system.
  void start_on(const Algebraic& y) {
    work_.start_on(y);
    last_step_ = T(0);
  }
  // The largest change of a stage, in absolute value, at which the iteration ends; 0: at round-off.
  void stop_at(T change) { work_.stop = change; }
  // A first guess for steps so long that the polynomial of the last one is no good beyond it.
  void extrapolate_cautiously() { work_.extrapolation = &work_.tableau.cautious; }
  // Gives up after so many iterations; no Newton's method.
  void only_iterate(int most) {
    most_iterations_ = most;
    work_.with_newton = false;
  }
  // y at the last stage of the last successful step.
  [[nodiscard]] const Algebraic& branch() const { return work_.branch; }

  // Advances z from t to t + h. On failure z and the branch are unchanged. Allocates nothing.
  [[nodiscard]] StepReport step(const T& t, const T& h, State<T, kDof>& z) {
    StepReport report;
    if (!all_finite(z.value)) (void)work_.fail(RateStatus::kNotFinite, report);
    if (report.status != StepStatus::kOk) return report;
    const int count = work_.tableau.stages();
    if (work_.coupled()) {
      solve({t, h, z, 0, count}, report);
    } else {
      for (int i = 0; i < count && report.status == StepStatus::kOk; ++i) {
        solve({t, h, z, i, 1}, report);
      }
    }
    State<T, kDof> end = z;
    if (report.status == StepStatus::kOk) {
      end.add(work_.update());
      if (!all_finite(end.value)) (void)work_.fail(RateStatus::kNotFinite, report);
    }
    if (report.status != StepStatus::kOk) {
      start_on(work_.branch);
      return report;
    }
    z = end;
    start_time_ = t;
    last_step_ = h;
    work_.branch = work_.algebraic(count - 1);
    return report;
  }

  // What the last successful step left: U_i, h omega_i f(U_i), y_i, at times start + c_i h. After a
  // failure there is nothing to be read here, and last_step() is zero.
  [[nodiscard]] const System& system() const { return work_.system; }
  [[nodiscard]] const Tableau<T, s>& tableau() const { return work_.tableau; }
  [[nodiscard]] const Stages& stages() const { return work_.stages; }
  [[nodiscard]] Point stage(int i) const { return work_.stage(i); }
  [[nodiscard]] const Stages& increments() const { return work_.increments; }
  [[nodiscard]] Algebraic algebraic(int i) const { return work_.algebraic(i); }
  [[nodiscard]] const auto& algebraic() const { return work_.all_algebraic; }
  [[nodiscard]] T stage_time(int i) const { return start_time_ + work_.tableau.c[i] * last_step_; }
  [[nodiscard]] T last_step() const { return last_step_; }

 private:
  using Block = typename Workspace::Block;
  static constexpr int kMaxIterations = 100;

  void solve(const Block& block, StepReport& report) {
    if (!work_.coupled() && work_.tableau.coupling == Coupling::kExplicit) {
      work_.warm_start(block.first);
      work_.set_stages(block, work_.stages);
      work_.evaluate(block, block.first, report);
      return;
    }
    const bool repeated = last_step_ == block.h && last_step_ != T(0);
    if (!work_.predict(block, repeated, report)) return;
    if (iterate(block, report)) return;
    // The iteration may have run away, even to where the rate fails: Newton begins again.
    if (!work_.with_newton) {
      if (report.status == StepStatus::kOk) report.status = StepStatus::kStagesDiverged;
      return;
    }
    newton(block, report);
  }

  // Fixed point. True when the stages have settled.
  bool iterate(const Block& block, StepReport& report) {
    const IterationLimits<T> limits{work_.stop, most_iterations_, work_.with_newton};
    if constexpr (kRows) {
      packed_beginning<kSize, s>(block.t,
                                 block.h,
                                 work_.tableau.c.data(),
                                 work_.tableau.omega.data(),
                                 times_.data(),
                                 weights_.data(),
                                 work_.stages.data());
      const StageData data{times_.data(),
                           work_.tableau.mu.data(),
                           weights_.data(),
                           block.z.value.data(),
                           block.z.compensation.data(),
                           work_.stages.data(),
                           work_.all_algebraic.data(),
                           work_.increments.data()};
      const StageReport done = packed_iteration<s>(work_.system, data, limits);
      report.evaluations += work_.tableau.stages() * done.sweeps;
      report.rate = RateStatus::kOk;
      if (done.end != IterationEnd::kRateFailed) return done.end == IterationEnd::kSettled;
      if (!work_.with_newton) return work_.fail(RateStatus::kNotFinite, report);
      // One by one, which tells the reason, or goes on where only the pack could not.
      if (!work_.evaluate_all(block, report)) return false;
    } else {
      for (int i = 0; i < kSize; ++i) {
        for (int j = block.begin(); j < block.end(); ++j) {
          work_.stages(i, j) = std::numeric_limits<T>::max();
        }
      }
    }
    return iterate_one_by_one(block, limits, report);
  }

  bool iterate_one_by_one(const Block& block,
                          const IterationLimits<T>& limits,
                          StepReport& report) {
    Stages next = work_.stages;
    const auto sweep = [&](T* change) {
      work_.set_stages(block, next);
      T most(0);
      for (int i = 0; i < kSize; ++i) {
        T moved(0);
        for (int j = block.begin(); j < block.end(); ++j) {
          moved = maximum<T>(moved, work_.abs_of(next(i, j) - work_.stages(i, j)));
        }
        if (change != nullptr) change[i] = moved;
        most = maximum(most, moved);
      }
      for (int j = block.begin(); j < block.end(); ++j) {
        for (int i = 0; i < kSize; ++i) work_.stages(i, j) = next(i, j);
      }
      return work_.evaluate_all(block, report) ? most : std::numeric_limits<T>::quiet_NaN();
    };
    return iterate_stages<T, kSize>(limits, sweep, [&] { return work_.scale_of(block); }) ==
           IterationEnd::kSettled;
  }

  void newton(const Block& block, StepReport& report) {
    report.newton = true;
    if (work_.coupled() && newton_.simplified(work_, block, report)) return;
    if (newton_.full(work_, block, report) || report.status != StepStatus::kOk) return;
    report.status = StepStatus::kStagesDiverged;
  }

  Workspace work_;
  alignas(64) StageVector<T, s> times_;    // t + c_i h, of stages in rows,
  alignas(64) StageVector<T, s> weights_;  // h omega_i
  int most_iterations_ = kMaxIterations;
  T start_time_ = T(0);
  T last_step_ = T(0);
  StageNewton<T, kSize, kMaxCoupled> newton_;
};

}  // namespace carnot
