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

#include "carnot/step/packed_stages.h"
#include "carnot/step/stage_equations.h"
#include "carnot/step/stage_newton.h"
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
  using System = System_;
  using Scalar = T;
  static constexpr int kDof = System::kDof;
  static constexpr int kSize = 2 * kDof;
  static constexpr int kMaxStages = s == kAnyStages ? kMostStages : s;
  static constexpr int kMaxCoupled = s == kAnyStages ? kMostCoupledStages : s;
  static constexpr int kLanes = 8;
  static constexpr bool kPacks = PacksRates<System> && std::is_same_v<T, double>;
  // Stages lie in memory as packs do. Those that are idle stay at the start of the step.
  static constexpr bool kRows = kPacks && s == kLanes;
  using Point = Vector<T, kSize>;
  using Algebraic = Vector<T, System::kAlgebraic>;
  using Stages = StageRows<T, kSize, s, kMaxStages>;  // a column each

  // Keeps references to both.
  RungeKutta(const System& system, const Tableau<T, s>& tableau)
      : system_(system), tableau_(tableau) {
    assert(tableau.coupling == Coupling::kFull || (s == kAnyStages && !tableau.partitioned));
    assert(tableau.stages() <= (coupled() ? kMaxCoupled : kMaxStages));
    stages_ = Stages::Zero(kSize, tableau.c.size());
    increments_ = stages_;
    algebraic_.resize(System::kAlgebraic, tableau.c.size());
    start_on(Algebraic::Zero());
  }
  RungeKutta(const System& system, Tableau<T, s>&& tableau) = delete;  // would dangle

  // The branch of H_y = 0 to begin with; zero leaves the choice to the system.
  void start_on(const Algebraic& y) {
    if constexpr (System::kAlgebraic > 0) algebraic_.colwise() = y;
    branch_ = y;
    last_step_ = T(0);
  }
  // The largest change of a stage, in absolute value, at which the iteration ends; 0: at round-off.
  void stop_at(T change) { stop_ = change; }
  // A first guess for steps so long that the polynomial of the last one is no good beyond it.
  void extrapolate_cautiously() { extrapolation_ = &tableau_.cautious; }
  // Gives up after so many iterations; no Newton's method.
  void only_iterate(int most) {
    most_iterations_ = most;
    with_newton_ = false;
  }
  // y at the last stage of the last successful step.
  [[nodiscard]] const Algebraic& branch() const { return branch_; }

  // Advances z from t to t + h. On failure z and the branch are unchanged. Allocates nothing.
  [[nodiscard]] StepReport step(const T& t, const T& h, State<T, kDof>& z) {
    StepReport report;
    if (!all_finite(z.value)) (void)fail(RateStatus::kNotFinite, report);
    if (report.status != StepStatus::kOk) return report;
    const int count = tableau_.stages();
    if (coupled()) {
      solve({t, h, z, 0, count}, report);
    } else {
      for (int i = 0; i < count && report.status == StepStatus::kOk; ++i) {
        solve({t, h, z, i, 1}, report);
      }
    }
    State<T, kDof> end = z;
    if (report.status == StepStatus::kOk) {
      end.add(sum_of_increments(tableau_, increments_));
      if (!all_finite(end.value)) (void)fail(RateStatus::kNotFinite, report);
    }
    if (report.status != StepStatus::kOk) {
      start_on(branch_);
      return report;
    }
    z = end;
    start_time_ = t;
    last_step_ = h;
    branch_ = algebraic(count - 1);
    return report;
  }

  // What the last successful step left: U_i, h omega_i f(U_i), y_i, at times start + c_i h. After a
  // failure there is nothing to be read here, and last_step() is zero.
  [[nodiscard]] const System& system() const { return system_; }
  [[nodiscard]] const Tableau<T, s>& tableau() const { return tableau_; }
  [[nodiscard]] const Stages& stages() const { return stages_; }
  [[nodiscard]] const Stages& increments() const { return increments_; }
  [[nodiscard]] Algebraic algebraic(int i) const {
    // Where there are none, Eigen does not know how many columns there are.
    if constexpr (System::kAlgebraic == 0) {
      return {};
    } else {
      return algebraic_.col(i);
    }
  }
  [[nodiscard]] const auto& algebraic() const { return algebraic_; }
  [[nodiscard]] T stage_time(int i) const { return start_time_ + tableau_.c[i] * last_step_; }
  [[nodiscard]] T last_step() const { return last_step_; }

 private:
  friend class StageNewton<T, kSize, kMaxCoupled>;
  static constexpr int kMaxIterations = 100;

  // Stages that are found together: `count` from `first` on, of the step of h from z at t. They
  // depend on each other and on those before.
  struct Block {
    const T& t;
    const T& h;
    const State<T, kDof>& z;
    int first;
    int count;

    [[nodiscard]] int begin() const { return first; }
    [[nodiscard]] int end() const { return first + count; }
  };

  [[nodiscard]] bool coupled() const {
    return s != kAnyStages || tableau_.coupling == Coupling::kFull;
  }
  static T abs_of(const T& x) {
    using std::abs;
    return abs(x);
  }
  static bool fail(RateStatus rate, StepReport& report) {
    report.status = StepStatus::kRateFailed;
    report.rate = rate;
    return false;
  }

  void solve(const Block& block, StepReport& report) {
    if (!coupled() && tableau_.coupling == Coupling::kExplicit) {
      warm_start(block.first);
      set_stages(block, stages_);
      evaluate(block, block.first, report);
      return;
    }
    const bool repeated = last_step_ == block.h && last_step_ != T(0);
    if (!predict(block, repeated, report)) return;
    if (iterate(block, report)) return;
    // The iteration may have run away, even to where the rate fails: Newton begins again.
    if (!with_newton_) {
      if (report.status == StepStatus::kOk) report.status = StepStatus::kStagesDiverged;
      return;
    }
    newton(block, report);
  }

  // U of the block from the increments.
  void set_stages(const Block& block, Stages& u) const {
    if (coupled()) {
      stage_arguments(tableau_, increments_, block.z, u);
    } else if constexpr (s == kAnyStages) {
      u.col(block.first) = stage_argument(tableau_, increments_, block.z, block.first);
    }
  }

  // y_i and L_i at U_i.
  bool evaluate(const Block& block, int i, StepReport& report) {
    const T time = block.t + tableau_.c[i] * block.h;
    const Point u = stages_.col(i);
    Point f;
    Algebraic y = algebraic(i);
    const RateStatus rate = phase_rate(system_, time, u, y, f);
    ++report.evaluations;
    if (rate != RateStatus::kOk) return fail(rate, report);
    report.rate = rate;
    set_algebraic(i, y);
    increments_.col(i) = (block.h * tableau_.omega[i]) * f;
    return true;
  }

  // The same for all stages of the block.
  bool evaluate_all(const Block& block, StepReport& report) {
    if constexpr (kPacks) {
      if (block.end() - block.begin() > 1) {
        if (evaluate_packs(block, report)) return true;
        if (!with_newton_) return fail(RateStatus::kNotFinite, report);
      }
    }
    for (int i = block.begin(); i < block.end(); ++i) {
      if (!evaluate(block, i, report)) return false;
    }
    return true;
  }

  // Side by side, eight at a time. False where a rate fails.
  bool evaluate_packs(const Block& block, StepReport& report) {
    for (int first = block.begin(); first < block.end(); first += kLanes) {
      const int count = std::min(kLanes, block.end() - first);
      std::array<T, kLanes> time;
      for (int l = 0; l < count; ++l) time[l] = block.t + tableau_.c[first + l] * block.h;
      const double* const t = time.data();
      if (!packed_columns(system_, t, first, count, stages_, algebraic_, increments_)) return false;
      for (int i = first; i < first + count; ++i) {
        increments_.col(i) *= block.h * tableau_.omega[i];
      }
      report.evaluations += count;
    }
    report.rate = RateStatus::kOk;
    return true;
  }

  // y of the stage before: for stages that are found one after the other.
  void warm_start(int i) { set_algebraic(i, i == 0 ? branch_ : algebraic(i - 1)); }

  void set_algebraic(int i, const Algebraic& y) {
    if constexpr (System::kAlgebraic > 0) algebraic_.col(i) = y;
  }

  // First guess of the increments: from the last step, where this one repeats its length, or from
  // the rate at the start; of stages that are found one after the other, from the stage before.
  bool predict(const Block& block, bool repeated, StepReport& report) {
    if (coupled()) {
      if (!repeated) return constant_guess(block, report);
      if constexpr (kRows) {
        packed_extrapolation<kSize, s>(extrapolation_->data(), increments_.data());
      } else {
        increments_ = Stages(increments_.lazyProduct(extrapolation_->transpose()));
      }
      return true;
    }
    const int i = block.first;
    warm_start(i);
    if (i == 0 && !repeated) return constant_guess(block, report);
    const int before = i == 0 ? tableau_.stages() - 1 : i - 1;
    increments_.col(i) = (tableau_.omega[i] / tableau_.omega[before]) * increments_.col(before);
    return true;
  }

  // The rate at the start of the step, for every stage of the block.
  bool constant_guess(const Block& block, StepReport& report) {
    Point f;
    Algebraic y = branch_;
    const RateStatus rate = phase_rate(system_, block.t, block.z.value, y, f);
    ++report.evaluations;
    if (rate != RateStatus::kOk) return fail(rate, report);
    for (int i = block.begin(); i < block.end(); ++i) {
      set_algebraic(i, y);
      increments_.col(i) = (block.h * tableau_.omega[i]) * f;
    }
    return true;
  }

  // Fixed point. True when the stages have settled.
  bool iterate(const Block& block, StepReport& report) {
    for (int i = 0; i < kSize; ++i) {
      for (int j = block.begin(); j < block.end(); ++j) {
        stages_(i, j) = std::numeric_limits<T>::max();
      }
    }
    const IterationLimits<T> limits{stop_, most_iterations_, with_newton_};
    if constexpr (kRows) {
      for (int j = 0; j < s; ++j) {
        times_[j] = block.t + block.h * tableau_.c[j];
        weights_[j] = block.h * tableau_.omega[j];
      }
      const StageData data{times_.data(),
                           tableau_.mu.data(),
                           weights_.data(),
                           block.z.value.data(),
                           block.z.compensation.data(),
                           stages_.data(),
                           algebraic_.data(),
                           increments_.data()};
      const StageReport done = packed_iteration<s>(system_, data, limits);
      report.evaluations += tableau_.stages() * done.sweeps;
      report.rate = RateStatus::kOk;
      if (done.end != IterationEnd::kRateFailed) return done.end == IterationEnd::kSettled;
      if (!with_newton_) return fail(RateStatus::kNotFinite, report);
      // One by one, which tells the reason, or goes on where only the pack could not.
      if (!evaluate_all(block, report)) return false;
    }
    return iterate_one_by_one(block, limits, report);
  }

  bool iterate_one_by_one(const Block& block,
                          const IterationLimits<T>& limits,
                          StepReport& report) {
    Stages next = stages_;
    const auto sweep = [&](T* change) {
      set_stages(block, next);
      T most(0);
      for (int i = 0; i < kSize; ++i) {
        T moved(0);
        for (int j = block.begin(); j < block.end(); ++j) {
          const T away = abs_of(next(i, j) - stages_(i, j));
          if (!(away <= moved)) moved = away;  // a NaN stays
        }
        if (change != nullptr) change[i] = moved;
        if (!(moved <= most)) most = moved;
      }
      for (int j = block.begin(); j < block.end(); ++j) stages_.col(j) = next.col(j);
      return evaluate_all(block, report) ? most : std::numeric_limits<T>::quiet_NaN();
    };
    return iterate_stages<T, kSize>(limits, sweep, [&] { return scale_of(block); }) ==
           IterationEnd::kSettled;
  }

  // The largest entry of the stages.
  [[nodiscard]] T scale_of(const Block& block) const {
    T scale(0);
    for (int j = block.begin(); j < block.end(); ++j) {
      for (int i = 0; i < kSize; ++i) scale = std::max(scale, abs_of(stages_(i, j)));
    }
    return scale;
  }

  void newton(const Block& block, StepReport& report) {
    report.newton = true;
    if (coupled() && newton_.simplified(*this, block, report)) return;
    if (newton_.full(*this, block, report) || report.status != StepStatus::kOk) return;
    report.status = StepStatus::kStagesDiverged;
  }

  const System& system_;
  const Tableau<T, s>& tableau_;
  const StageMatrix<T, s>* extrapolation_ = &tableau_.extrapolation;
  alignas(64) Stages stages_;
  alignas(64) Stages increments_;
  alignas(64) StageRows<T, System::kAlgebraic, s, kMaxStages> algebraic_;
  alignas(64) StageVector<T, s> times_;    // t + c_i h, of stages in rows,
  alignas(64) StageVector<T, s> weights_;  // h omega_i
  Algebraic branch_;
  T stop_ = T(0);
  int most_iterations_ = kMaxIterations;
  bool with_newton_ = true;
  T start_time_ = T(0);
  T last_step_ = T(0);
  StageNewton<T, kSize, kMaxCoupled> newton_;
};

}  // namespace carnot
