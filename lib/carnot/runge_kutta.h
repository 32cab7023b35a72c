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
// the scale of the components. If that is not reached, Newton's method takes over.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "carnot/lu.h"
#include "carnot/phase_space.h"
#include "carnot/tableau.h"

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
  using Point = Vector<T, kSize>;
  using Algebraic = Vector<T, System::kAlgebraic>;
  using Stages = Eigen::Matrix<T, kSize, s, 0, kSize, kMaxStages>;  // a column each

  // Keeps references to both.
  RungeKutta(const System& system, const Tableau<T, s>& tableau)
      : system_(system), tableau_(tableau) {
    assert(tableau.coupling == Coupling::kFull || (s == kAnyStages && !tableau.partitioned));
    assert(tableau.stages() <= (coupled() ? kMaxCoupled : kMaxStages));
    stages_ = Stages::Zero(kSize, tableau.stages());
    increments_ = stages_;
    start_on(Algebraic::Zero());
  }
  RungeKutta(const System& system, Tableau<T, s>&& tableau) = delete;  // would dangle

  // The branch of H_y = 0 to begin with; zero leaves the choice to the system.
  void start_on(const Algebraic& y) {
    algebraic_.fill(y);
    branch_ = y;
    last_step_ = T(0);
  }
  // y at the last stage of the last successful step.
  [[nodiscard]] const Algebraic& branch() const { return branch_; }

  // Advances z from t to t + h. On failure z and the branch are unchanged. Allocates nothing.
  [[nodiscard]] StepReport step(const T& t, const T& h, State<T, kDof>& z) {
    StepReport report;
    if (!z.value.allFinite()) {
      fail(RateStatus::kNotFinite, report);
      return report;
    }
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
      end.add(sum_of_increments());
      if (!end.value.allFinite()) fail(RateStatus::kNotFinite, report);
    }
    if (report.status != StepStatus::kOk) {
      start_on(branch_);
      return report;
    }
    z = end;
    start_time_ = t;
    last_step_ = h;
    branch_ = algebraic_[count - 1];
    return report;
  }

  // What the last successful step left: U_i, h omega_i f(U_i), y_i, at times start + c_i h. After a
  // failure there is nothing to be read here, and last_step() is zero.
  [[nodiscard]] const System& system() const { return system_; }
  [[nodiscard]] const Tableau<T, s>& tableau() const { return tableau_; }
  [[nodiscard]] const Stages& stages() const { return stages_; }
  [[nodiscard]] const Stages& increments() const { return increments_; }
  [[nodiscard]] Algebraic algebraic(int i) const { return algebraic_[i]; }
  [[nodiscard]] T stage_time(int i) const { return start_time_ + tableau_.c[i] * last_step_; }
  [[nodiscard]] T last_step() const { return last_step_; }

 private:
  static constexpr int kMaxIterations = 100;
  static constexpr int kMaxNewton = 20;

  // Stages that are found together: `count` from `first` on, of the step of h from z at t. They
  // depend on each other and on those before.
  struct Block {
    const T& t;
    const T& h;
    const State<T, kDof>& z;
    int first;
    int count;

    [[nodiscard]] int begin() const { return s == kAnyStages ? first : 0; }
    [[nodiscard]] int end() const { return s == kAnyStages ? first + count : s; }
    // The columns of these stages, a fixed number where s is fixed.
    template <class M>
    [[nodiscard]] auto of(M& all) const {
      return all.template middleCols<s>(begin(), end() - begin());
    }
  };

  [[nodiscard]] bool coupled() const {
    return s != kAnyStages || tableau_.coupling == Coupling::kFull;
  }

  static void fail(RateStatus rate, StepReport& report) {
    report.status = StepStatus::kRateFailed;
    report.rate = rate;
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
    report.status = StepStatus::kOk;
    if (predict(block, false, report)) newton(block, report);
  }

  // U of the block from the increments.
  void set_stages(const Block& block, Stages& u) const {
    if (coupled()) {
      u = coupled_stages(block.z);
    } else {
      u.col(block.first) = stage(block.z, block.first);
    }
  }

  [[nodiscard]] Stages coupled_stages(const State<T, kDof>& z) const {
    Stages u = increments_.lazyProduct(tableau_.mu.transpose());
    if (tableau_.partitioned) {
      u.template bottomRows<kDof>() =
          increments_.template bottomRows<kDof>().lazyProduct(tableau_.mu_p.transpose());
    }
    u.colwise() += z.compensation;
    u.colwise() += z.value;
    return u;
  }

  // One stage from those before and itself. The increments of those after it are not of this step.
  [[nodiscard]] Point stage(const State<T, kDof>& z, int i) const {
    Point sum = z.compensation;
    for (int j = 0; j <= i; ++j) {
      if (tableau_.mu(i, j) != T(0)) sum += tableau_.mu(i, j) * increments_.col(j);
    }
    return sum + z.value;
  }

  [[nodiscard]] Point sum_of_increments() const {
    if constexpr (s == kAnyStages) {
      return increments_.lazyProduct(tableau_.update);
    } else {
      return increments_.rowwise().sum();
    }
  }

  // y_i and L_i at U_i.
  bool evaluate(const Block& block, int i, StepReport& report) {
    const T time = block.t + tableau_.c[i] * block.h;
    const Point u = stages_.col(i);
    Point f;
    Algebraic y = algebraic_[i];
    const RateStatus rate = phase_rate(system_, time, u, y, f);
    ++report.evaluations;
    if (rate != RateStatus::kOk) {
      fail(rate, report);
      return false;
    }
    report.rate = rate;
    algebraic_[i] = y;
    increments_.col(i) = (block.h * tableau_.omega[i]) * f;
    return true;
  }

  // y of the stage before: for stages that are found one after the other.
  void warm_start(int i) { algebraic_[i] = i == 0 ? branch_ : algebraic_[i - 1]; }

  // First guess of the increments: from the last step, where this one repeats its length, or from
  // the rate at the start; of stages that are found one after the other, from the stage before.
  bool predict(const Block& block, bool repeated, StepReport& report) {
    if (coupled()) {
      if (!repeated) return constant_guess(block, report);
      increments_ = Stages(increments_.lazyProduct(tableau_.extrapolation.transpose()));
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
    if (rate != RateStatus::kOk) {
      fail(rate, report);
      return false;
    }
    for (int i = block.begin(); i < block.end(); ++i) {
      algebraic_[i] = y;
      increments_.col(i) = (block.h * tableau_.omega[i]) * f;
    }
    return true;
  }

  // Fixed point. True when the stages have settled to round-off.
  bool iterate(const Block& block, StepReport& report) {
    constexpr T kFar = std::numeric_limits<T>::max();
    Point smallest = Point::Constant(kFar);
    T last_change = kFar;
    T change_before = kFar;
    block.of(stages_).setConstant(kFar);
    Stages next = stages_;
    bool grace = true;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      set_stages(block, next);
      const Point change = (block.of(next) - block.of(stages_)).cwiseAbs().rowwise().maxCoeff();
      block.of(stages_) = block.of(next);
      bool falling = iteration == 0;
      bool at_rest = true;
      for (int k = 0; k < kSize; ++k) {
        falling = falling || (change[k] > T(0) && change[k] < smallest[k]);
        at_rest = at_rest && change[k] == T(0);
        smallest[k] = std::min(smallest[k], change[k]);
      }
      for (int i = block.begin(); i < block.end(); ++i) {
        if (!evaluate(block, i, report)) return false;
      }
      if (at_rest) return true;
      const T largest = change.maxCoeff();
      if (!falling) {
        // Where q' depends on p alone and p' on q alone, the errors of q and p take turns, and one
        // of them may be zero by luck: the other one still contracts.
        const bool contracts = largest < change_before / T(4);
        if (!grace && !contracts) return settled(block, change);
        if (!grace) smallest.setConstant(kFar);
        grace = false;
      }
      change_before = last_change;
      last_change = largest;
    }
    return false;
  }

  // Stalled changes must be round-off of the stages, else the iteration did not contract.
  [[nodiscard]] bool settled(const Block& block, const Point& change) const {
    constexpr int kRoundOff = 1000;
    const T scale = block.of(stages_).cwiseAbs().maxCoeff();
    const T limit = T(kRoundOff) * std::numeric_limits<T>::epsilon() * scale;
    return (change.array() < limit).all();  // false for a NaN and for infinite stages
  }

  // Solves U_i - z - e - sum_j mu_ij h omega_j f(U_j) = 0 for the stages of the block at once.
  void newton(const Block& block, StepReport& report) {
    report.newton = true;
    T smallest = std::numeric_limits<T>::max();
    set_stages(block, stages_);
    Stages next = stages_;
    for (int iteration = 0; iteration < kMaxNewton; ++iteration) {
      if (!newton_matrix(block, report)) return;
      set_stages(block, next);
      Stages correction = block.of(next) - block.of(stages_);  // the residual, then its solution
      const int size = kSize * static_cast<int>(correction.cols());
      if (!lu_solve(size, newton_matrix_.data(), 1, correction.data())) break;
      block.of(stages_) += correction;
      if (!correction.allFinite()) break;
      const T change = correction.cwiseAbs().maxCoeff();
      const bool stalled = change >= smallest;
      smallest = std::min(smallest, change);
      if (change == T(0) || (stalled && settled(block, Point::Constant(change)))) {
        for (int i = block.begin(); i < block.end(); ++i) {
          if (!evaluate(block, i, report)) return;
        }
        return;
      }
    }
    report.status = StepStatus::kStagesDiverged;
  }

  // I - mu_ij h omega_j df/dz(U_j) in blocks, row-major, and the rates at the stages.
  bool newton_matrix(const Block& block, StepReport& report) {
    const int width = kSize * (block.end() - block.begin());
    Matrix<T, kSize, kSize> a;
    for (int j = block.begin(); j < block.end(); ++j) {
      if (!evaluate(block, j, report)) return false;
      const T time = block.t + tableau_.c[j] * block.h;
      const RateStatus rate =
          phase_jacobian(system_, time, Point(stages_.col(j)), algebraic_[j], a);
      if (rate != RateStatus::kOk) {
        fail(rate, report);
        return false;
      }
      a *= block.h * tableau_.omega[j];
      for (int i = block.begin(); i < block.end(); ++i) {
        T* const corner = newton_matrix_.data() + (i - block.begin()) * kSize * width +
                          (j - block.begin()) * kSize;
        for (int r = 0; r < kSize; ++r) {
          const T mu = r < kDof ? tableau_.mu(i, j) : tableau_.momentum_mu(i, j);
          for (int c = 0; c < kSize; ++c) {
            corner[r * width + c] = T(i == j && r == c ? 1 : 0) - mu * a(r, c);
          }
        }
      }
    }
    return true;
  }

  const System& system_;
  const Tableau<T, s>& tableau_;
  Stages stages_;
  Stages increments_;
  std::array<Algebraic, kMaxStages> algebraic_;
  Algebraic branch_;
  T start_time_ = T(0);
  T last_step_ = T(0);
  std::array<T, kSize * kMaxCoupled * kSize * kMaxCoupled> newton_matrix_;  // scratch
};

}  // namespace carnot
