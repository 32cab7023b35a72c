// Newton's method for coupled stages, where their fixed-point iteration does not contract well.
//
// The equations U = arguments(L), L = h omega f(U) (runge_kutta.h) are linearized in U:
//
//   simplified   one Jacobian for all stages and iterations: systems of one stage's size, for the
//                methods that allow it (decoupled_stages.h);
//   full         the Jacobians of all stages in each iteration: one system for all.
//
// Both go on until corrections stall at round-off, or are as small as the kernel asks for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/step/decoupled_stages.h"
#include "carnot/step/stage_equations.h"
#include "carnot/step/step_report.h"

namespace carnot {

// A part of RungeKutta, for up to `most` stages, which calls it with itself and its block.
template <class T, int size, int most>
class StageNewton {
 public:
  // True when the stages have settled, with L and y there; full coupling only.
  template <class Kernel, class Block>
  [[nodiscard]] bool simplified(Kernel& kernel, const Block& block, StepReport& report) {
    if (!prepared_) suited_ = decoupled_.set_method(kernel.tableau_);
    prepared_ = true;
    if (!suited_ || !begin(kernel, block, report)) return false;
    const int count = block.end() - block.begin();
    Point mean = Point::Zero();
    for (int j = block.begin(); j < block.end(); ++j) {
      for (int i = 0; i < size; ++i) mean[i] += kernel.stages_(i, j) / T(count);
    }
    Square a;
    if (!jacobian(kernel, block.t + block.h / T(2), mean, block.end() / 2, report, a)) return false;
    if (!decoupled_.factor(block.h, a)) return false;
    const auto linearize = [&] { return kernel.evaluate_all(block, report); };
    return iterate(kernel, block, report, true, linearize, [&](T* x) {
      decoupled_.solve(x);
      return true;
    });
  }

  template <class Kernel, class Block>
  [[nodiscard]] bool full(Kernel& kernel, const Block& block, StepReport& report) {
    if (!begin(kernel, block, report)) return false;
    const auto linearize = [&] {
      for (int j = block.begin(); j < block.end(); ++j) {
        Square a;
        const T time = block.t + kernel.tableau_.c[j] * block.h;
        if (!kernel.evaluate(block, j, report)) return false;
        if (!jacobian(kernel, time, kernel.stages_.col(j), j, report, a)) return false;
        const T weight = block.h * kernel.tableau_.omega[j];
        system_.set_column(kernel.tableau_, block.begin(), block.end(), j, weight, a);
      }
      return true;
    };
    return iterate(kernel, block, report, false, linearize, [&](T* x) {
      return system_.solve(block.end() - block.begin(), x);
    });
  }

 private:
  static constexpr int kMostIterations = 20;
  using Point = Vector<T, size>;
  using Square = Matrix<T, size, size>;

  template <class Kernel, class Block>
  static bool begin(Kernel& kernel, const Block& block, StepReport& report) {
    report.status = StepStatus::kOk;
    if (!kernel.predict(block, false, report)) return false;
    kernel.set_stages(block, kernel.stages_);
    return true;
  }

  // df/dz, on the branch of stage j.
  template <class Kernel>
  static bool jacobian(
      Kernel& kernel, const T& time, const Point& at, int j, StepReport& report, Square& a) {
    const RateStatus rate = phase_jacobian(kernel.system_, time, at, kernel.algebraic(j), a);
    return rate == RateStatus::kOk || kernel.fail(rate, report);
  }

  // monotone: ends without success where a correction is not smaller than those before.
  template <class Kernel, class Block, class Linearize, class Solve>
  static bool iterate(Kernel& kernel,
                      const Block& block,
                      StepReport& report,
                      bool monotone,
                      const Linearize& linearize,
                      const Solve& solve) {
    using std::abs;
    T smallest = std::numeric_limits<T>::max();
    auto next = kernel.stages_;
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      if (!linearize()) return false;
      kernel.set_stages(block, next);
      // Stage by stage, as the rows of the systems.
      std::array<T, size * most> correction;
      T* to = correction.data();
      for (int j = block.begin(); j < block.end(); ++j) {
        for (int i = 0; i < size; ++i) *to++ = next(i, j) - kernel.stages_(i, j);
      }
      if (!solve(correction.data())) return false;
      T change(0);
      const T* from = correction.data();
      for (int j = block.begin(); j < block.end(); ++j) {
        for (int i = 0; i < size; ++i, ++from) {
          if (!(abs(*from) <= std::numeric_limits<T>::max())) return false;
          change = std::max(change, abs(*from));
          kernel.stages_(i, j) += *from;
        }
      }
      const bool stalled = change >= smallest;
      smallest = std::min(smallest, change);
      if (change <= kernel.stop_ || (stalled && is_round_off(change, kernel.scale_of(block)))) {
        return kernel.evaluate_all(block, report);
      }
      if (stalled && monotone) return false;
    }
    return false;
  }

  StageEquations<T, size, most> system_;  // scratch
  DecoupledStages<T, size, most> decoupled_;
  bool prepared_ = false;
  bool suited_ = false;
};

}  // namespace carnot
