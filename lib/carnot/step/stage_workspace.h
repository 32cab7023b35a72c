// The stages of one step, as Newton's method and the fixed-point iteration share them: where they
// are kept, how they are guessed and how they are evaluated.
//
// Notation: tableau.h, runge_kutta.h. Loops over entries: see linear_algebra.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "carnot/step/packed_stages.h"
#include "carnot/step/stage_equations.h"
#include "carnot/step/step_report.h"
#include "carnot/system/packed_rate.h"
#include "carnot/system/phase_space.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// A part of RungeKutta, which says what its parameters are. Keeps references to the system and the
// tableau.
template <class System_, int s, class T>
struct StageWorkspace {
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

  StageWorkspace(const System& of, const Tableau<T, s>& method) : system(of), tableau(method) {
    stages.resize(kSize, tableau.c.size());
    increments.resize(kSize, tableau.c.size());
    std::fill_n(stages.data(), stages.size(), T(0));
    std::fill_n(increments.data(), increments.size(), T(0));
    all_algebraic.resize(System::kAlgebraic, tableau.c.size());
    start_on(filled<System::kAlgebraic>(T(0)));
  }

  // The branch of H_y = 0 to begin with.
  void start_on(const Algebraic& y) {
    for (int i = 0; i < all_algebraic.cols(); ++i) set_algebraic(i, y);
    branch = y;
  }

  // Whether all stages are one block.
  [[nodiscard]] bool coupled() const {
    return s != kAnyStages || tableau.coupling == Coupling::kFull;
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

  // U_i.
  [[nodiscard]] Point stage(int i) const {
    Point u;
    for (int k = 0; k < kSize; ++k) u[k] = stages(k, i);
    return u;
  }
  // y_i.
  [[nodiscard]] Algebraic algebraic(int i) const {
    Algebraic y;
    for (int k = 0; k < System::kAlgebraic; ++k) y[k] = all_algebraic(k, i);
    return y;
  }

  // U of the block from the increments.
  void set_stages(const Block& block, Stages& u) const {
    if (coupled()) {
      stage_arguments(tableau, increments, block.z, u);
    } else if constexpr (s == kAnyStages) {
      const Point argument = stage_argument(tableau, increments, block.z, block.first);
      for (int k = 0; k < kSize; ++k) u(k, block.first) = argument[k];
    }
  }

  // y_i and L_i at U_i.
  bool evaluate(const Block& block, int i, StepReport& report) {
    const T time = block.t + tableau.c[i] * block.h;
    const Point u = stage(i);
    Point f;
    Algebraic y = algebraic(i);
    const RateStatus rate = phase_rate(system, time, u, y, f);
    ++report.evaluations;
    if (rate != RateStatus::kOk) return fail(rate, report);
    report.rate = rate;
    set_algebraic(i, y);
    set_increment(i, block.h * tableau.omega[i], f);
    return true;
  }

  // The same for all stages of the block.
  bool evaluate_all(const Block& block, StepReport& report) {
    if constexpr (kPacks) {
      if (block.end() - block.begin() > 1) {
        if (evaluate_packs(block, report)) return true;
        if (!with_newton) return fail(RateStatus::kNotFinite, report);
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
      for (int l = 0; l < count; ++l) time[l] = block.t + tableau.c[first + l] * block.h;
      const double* const t = time.data();
      if (!packed_columns(system, t, first, count, stages, all_algebraic, increments)) return false;
      for (int i = first; i < first + count; ++i) {
        const T weight = block.h * tableau.omega[i];
        for (int k = 0; k < kSize; ++k) increments(k, i) *= weight;
      }
      report.evaluations += count;
    }
    report.rate = RateStatus::kOk;
    return true;
  }

  // By which z moves.
  [[nodiscard]] Point update() const {
    if constexpr (kRows) {
      Point sums;
      packed_sums<kSize, s>(increments.data(), sums.data());
      return sums;
    } else {
      return sum_of_increments(tableau, increments);
    }
  }

  // y of the stage before: for stages that are found one after the other.
  void warm_start(int i) { set_algebraic(i, i == 0 ? branch : algebraic(i - 1)); }

  void set_algebraic(int i, const Algebraic& y) {
    for (int k = 0; k < System::kAlgebraic; ++k) all_algebraic(k, i) = y[k];
  }
  // L_i = weight f.
  void set_increment(int i, const T& weight, const Point& f) {
    for (int k = 0; k < kSize; ++k) increments(k, i) = weight * f[k];
  }

  // First guess of the increments: from the last step, where this one repeats its length, or from
  // the rate at the start; of stages that are found one after the other, from the stage before.
  bool predict(const Block& block, bool repeated, StepReport& report) {
    if (coupled()) {
      if (!repeated) return constant_guess(block, report);
      if constexpr (kRows) {
        packed_extrapolation<kSize, s>(extrapolation->data(), increments.data());
      } else {
        extrapolate();
      }
      return true;
    }
    const int i = block.first;
    warm_start(i);
    if (i == 0 && !repeated) return constant_guess(block, report);
    const int before = i == 0 ? tableau.stages() - 1 : i - 1;
    const T ratio = tableau.omega[i] / tableau.omega[before];
    for (int k = 0; k < kSize; ++k) increments(k, i) = ratio * increments(k, before);
    return true;
  }

  void extrapolate() {
    const Stages last = increments;
    for (int i = 0; i < last.cols(); ++i) {
      std::array<T, kSize> sum;
      sum.fill(T(0));
      for (int j = 0; j < last.cols(); ++j) {
        const T weight = (*extrapolation)(i, j);
        for (int k = 0; k < kSize; ++k) sum[k] += weight * last(k, j);
      }
      for (int k = 0; k < kSize; ++k) increments(k, i) = sum[k];
    }
  }

  // The rate at the start of the step, for every stage of the block.
  bool constant_guess(const Block& block, StepReport& report) {
    Point f;
    Algebraic y = branch;
    const RateStatus rate = phase_rate(system, block.t, block.z.value, y, f);
    ++report.evaluations;
    if (rate != RateStatus::kOk) return fail(rate, report);
    for (int i = block.begin(); i < block.end(); ++i) {
      set_algebraic(i, y);
      set_increment(i, block.h * tableau.omega[i], f);
    }
    return true;
  }

  // The largest entry of the stages.
  [[nodiscard]] T scale_of(const Block& block) const {
    T scale(0);
    for (int j = block.begin(); j < block.end(); ++j) {
      for (int i = 0; i < kSize; ++i) scale = std::max(scale, abs_of(stages(i, j)));
    }
    return scale;
  }

  const System& system;
  const Tableau<T, s>& tableau;
  const StageMatrix<T, s>* extrapolation = &tableau.extrapolation;
  alignas(64) Stages stages;                                                  // U_i
  alignas(64) Stages increments;                                              // L_i
  alignas(64) StageRows<T, System::kAlgebraic, s, kMaxStages> all_algebraic;  // y_i
  Algebraic branch;         // y at the start of the step
  T stop = T(0);            // the largest change of a stage at which iterations end
  bool with_newton = true;  // Newton's method goes on where the iteration fails
};

}  // namespace carnot
