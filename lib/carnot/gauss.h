// One step of a Gauss method, s stages, order 2s, on an index-1 system.
//
// A Runge-Kutta method applied to J z' = grad H(z), J singular, solves H_y = 0 at every stage, so
// it equals the method applied to the system with y eliminated (McLachlan et al. 2013, Prop. 4):
// order, symplecticity and constraints follow. With L_i = h b_i f(U_i) a step reads
//
//   U_i = z + e + sum_j mu_ij L_j,      z+ = z + e + sum_j L_j,
//
// where e is the rounding error that the last updates left (compensated summation) and
// mu_ij + mu_ji = 1 exactly. The stages are found by fixed-point iteration, started from the
// extrapolated collocation polynomial of the last step. It goes on while for some component the
// largest change over the stages is still falling (Antonana, Makazaga & Murua 2017), so it ends at
// round-off whatever the scale of the components. If that is not reached, Newton's method on
// the 2ns stage equations takes over.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/compensated.h"
#include "carnot/gauss_tableau.h"
#include "carnot/gradient.h"
#include "carnot/index_one_system.h"
#include "carnot/lu.h"

namespace carnot {

enum class StepStatus { kOk, kRateFailed, kStagesDiverged };

struct StepReport {
  StepStatus status = StepStatus::kOk;
  RateStatus rate = RateStatus::kOk;
  int evaluations = 0;
  bool newton = false;
};

// A phase point with its rounding error: z = (q, p) as one vector of length 2n.
template <class T, int n>
using State = Compensated<Vector<T, 2 * n>>;

template <class T, int n>
State<T, n> make_state(const Vector<T, n>& q, const Vector<T, n>& p) {
  State<T, n> z{Vector<T, 2 * n>::Zero(), Vector<T, 2 * n>::Zero()};
  z.value << q, p;
  return z;
}

// dz/dt for z = (q, p); y is scratch and warm start.
template <class System, class T>
RateStatus phase_rate(const System& system,
                      const T& t,
                      const Vector<T, 2 * System::kDof>& z,
                      Vector<T, System::kAlgebraic>& y,
                      Vector<T, 2 * System::kDof>& z_dot) {
  constexpr int n = System::kDof;
  Rate<T, n> rate;
  const RateStatus status = system.rate(
      t, Vector<T, n>(z.template head<n>()), Vector<T, n>(z.template tail<n>()), y, rate);
  z_dot.template head<n>() = rate.q_dot;
  z_dot.template tail<n>() = rate.p_dot;
  return status;
}

// d(dz/dt)/dz, exact: the rate on Jets with 2n directions. y is the solution at z.
template <class System, class T>
RateStatus phase_jacobian(const System& system,
                          const T& t,
                          const Vector<T, 2 * System::kDof>& z,
                          const Vector<T, System::kAlgebraic>& y,
                          Matrix<T, 2 * System::kDof, 2 * System::kDof>& jacobian) {
  constexpr int m = 2 * System::kDof;
  using J = Jet<T, m>;
  Vector<J, m> rate;
  Vector<J, System::kAlgebraic> warm = unseeded<J>(y);
  const RateStatus status = phase_rate(system, J(t), seeded(z), warm, rate);
  for (int i = 0; i < m; ++i) jacobian.row(i) = rate[i].v.transpose();
  return status;
}

template <class System_, int s, class T = double>
class Gauss {
 public:
  using System = System_;
  using Scalar = T;
  static constexpr int kDof = System::kDof;
  static constexpr int kSize = 2 * kDof;
  static constexpr int kStages = s;
  static constexpr int kOrder = 2 * s;
  using Stages = Matrix<T, kSize, s>;

  // Keeps a reference to `system`.
  explicit Gauss(const System& system) : system_(system), tableau_(gauss_tableau<T, s>()) {
    algebraic_.setZero();
  }

  // Advances z from t to t + h. On failure z is unchanged. Allocates nothing.
  [[nodiscard]] StepReport step(const T& t, const T& h, State<T, kDof>& z) {
    StepReport report;
    if (!z.value.allFinite()) {
      report.status = StepStatus::kRateFailed;
      report.rate = RateStatus::kNotFinite;
      return report;
    }
    if (!predict(t, h, z, report)) return report;
    if (!iterate(t, h, z, report)) retry_with_newton(t, h, z, report);
    if (report.status != StepStatus::kOk) {
      last_step_ = T(0);
      return report;
    }
    start_time_ = t;
    last_step_ = h;
    z.add(increments_.rowwise().sum());
    return report;
  }

  // What the last successful step left: U_i, h b_i f(U_i), y_i, at times start + c_i h.
  [[nodiscard]] const System& system() const { return system_; }
  [[nodiscard]] const GaussTableau<T, s>& tableau() const { return tableau_; }
  [[nodiscard]] const Stages& stages() const { return stages_; }
  [[nodiscard]] const Stages& increments() const { return increments_; }
  [[nodiscard]] Vector<T, System::kAlgebraic> algebraic(int i) const { return algebraic_.col(i); }
  [[nodiscard]] T stage_time(int i) const { return start_time_ + tableau_.c[i] * last_step_; }
  [[nodiscard]] T last_step() const { return last_step_; }

 private:
  static constexpr int kMaxIterations = 100;
  static constexpr int kMaxNewton = 20;

  bool evaluate(const T& t, const T& h, int i, StepReport& report) {
    Vector<T, System::kAlgebraic> y = algebraic_.col(i);
    Vector<T, kSize> f;
    report.rate =
        phase_rate(system_, T(t + tableau_.c[i] * h), Vector<T, kSize>(stages_.col(i)), y, f);
    ++report.evaluations;
    if (report.rate != RateStatus::kOk) {
      report.status = StepStatus::kRateFailed;
      return false;
    }
    algebraic_.col(i) = y;
    increments_.col(i) = (h * tableau_.b[i]) * f;
    return true;
  }

  // First guess of the increments: extrapolated, or the rate at the start of the step.
  bool predict(const T& t, const T& h, const State<T, kDof>& z, StepReport& report) {
    if (last_step_ == h) {
      increments_ = Stages(increments_.lazyProduct(tableau_.extrapolation.transpose()));
      return true;
    }
    Vector<T, kSize> f;
    Vector<T, System::kAlgebraic> y = algebraic_.col(0);
    report.rate = phase_rate(system_, t, z.value, y, f);
    ++report.evaluations;
    if (report.rate != RateStatus::kOk) {
      report.status = StepStatus::kRateFailed;
      return false;
    }
    for (int i = 0; i < s; ++i) {
      algebraic_.col(i) = y;
      increments_.col(i) = (h * tableau_.b[i]) * f;
    }
    return true;
  }

  // Fixed point. True when the stages have settled to round-off.
  bool iterate(const T& t, const T& h, const State<T, kDof>& z, StepReport& report) {
    Vector<T, kSize> smallest = Vector<T, kSize>::Constant(std::numeric_limits<T>::max());
    stages_.setConstant(std::numeric_limits<T>::max());
    bool grace = true;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      Stages next = increments_.lazyProduct(tableau_.mu.transpose());
      next.colwise() += z.compensation;
      next.colwise() += z.value;
      const Vector<T, kSize> change = (next - stages_).cwiseAbs().rowwise().maxCoeff();
      stages_ = next;
      bool falling = iteration == 0;
      bool at_rest = true;
      for (int k = 0; k < kSize; ++k) {
        falling = falling || (change[k] > T(0) && change[k] < smallest[k]);
        at_rest = at_rest && change[k] == T(0);
        smallest[k] = std::min(smallest[k], change[k]);
      }
      for (int i = 0; i < s; ++i) {
        if (!evaluate(t, h, i, report)) return false;
      }
      if (at_rest) return true;
      if (!falling) {
        if (!grace) return settled(change);
        grace = false;
      }
    }
    return false;
  }

  // The iteration may have run away, even to where the rate fails: Newton begins again at the
  // start of the step.
  void retry_with_newton(const T& t, const T& h, const State<T, kDof>& z, StepReport& report) {
    report.status = StepStatus::kOk;
    last_step_ = T(0);
    if (predict(t, h, z, report)) newton(t, h, z, report);
  }

  // Stalled changes must be round-off of the stages, else the iteration did not contract.
  [[nodiscard]] bool settled(const Vector<T, kSize>& change) const {
    constexpr int kRoundOff = 1000;
    const T scale = stages_.cwiseAbs().maxCoeff();
    const T limit = T(kRoundOff) * std::numeric_limits<T>::epsilon() * scale;
    return (change.array() <= limit).all();  // false for a NaN, which maxCoeff may skip
  }

  // Solves U_i - z - e - sum_j mu_ij h b_j f(U_j) = 0 for all stages at once.
  void newton(const T& t, const T& h, const State<T, kDof>& z, StepReport& report) {
    report.newton = true;
    T smallest = std::numeric_limits<T>::max();
    stages_ = increments_.lazyProduct(tableau_.mu.transpose()).colwise() + z.value;
    for (int iteration = 0; iteration < kMaxNewton; ++iteration) {
      if (!newton_matrix(t, h, report)) return;
      Stages correction = increments_.lazyProduct(tableau_.mu.transpose());
      correction.colwise() += z.compensation;
      correction = (correction.colwise() + z.value) - stages_;
      if (!lu_solve(kSize * s, newton_matrix_.data(), 1, correction.data())) break;
      stages_ += correction;
      const T change = correction.cwiseAbs().maxCoeff();
      if (!correction.allFinite()) break;
      const bool stalled = change >= smallest;
      smallest = std::min(smallest, change);
      if (change == T(0) || (stalled && settled(Vector<T, kSize>::Constant(change)))) {
        for (int j = 0; j < s; ++j) {
          if (!evaluate(t, h, j, report)) return;
        }
        return;
      }
    }
    report.status = StepStatus::kStagesDiverged;
  }

  // I - mu_ij h b_j df/dz(U_j) in blocks, row-major, and the rates at the stages.
  bool newton_matrix(const T& t, const T& h, StepReport& report) {
    Matrix<T, kSize, kSize> a;
    for (int j = 0; j < s; ++j) {
      if (!evaluate(t, h, j, report)) return false;
      const Vector<T, kSize> u = stages_.col(j);
      report.rate = phase_jacobian(system_, T(t + tableau_.c[j] * h), u, algebraic(j), a);
      for (int i = 0; i < s; ++i) {
        const T weight = tableau_.mu(i, j) * tableau_.b[j] * h;
        for (int r = 0; r < kSize; ++r) {
          for (int c = 0; c < kSize; ++c) {
            const T identity(i == j && r == c ? 1 : 0);
            newton_matrix_[(i * kSize + r) * kSize * s + j * kSize + c] =
                identity - weight * a(r, c);
          }
        }
      }
    }
    return true;
  }

  const System& system_;
  const GaussTableau<T, s>& tableau_;
  Stages stages_ = Stages::Zero();
  Stages increments_ = Stages::Zero();
  Matrix<T, System::kAlgebraic, s> algebraic_;
  std::array<T, kSize * s * kSize * s> newton_matrix_;  // scratch of the fallback
  T start_time_ = T(0);
  T last_step_ = T(0);
};

}  // namespace carnot
