// Newton's method for coupled stages, where their fixed-point iteration does not contract well.
//
// The equations U = arguments(L), L = h omega f(U) (runge_kutta.h) are linearized in U:
//
//   simplified   one Jacobian for all stages and iterations: systems of one stage's size, for the
//                methods that allow it (decoupled_stages.h);
//   full         the Jacobians of all stages in each iteration: one system for all.
//
// Both go on until corrections stall at round-off, or are as small as the workspace asks for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/step/decoupled_stages.h"
#include "carnot/step/stage_equations.h"
#include "carnot/step/step_report.h"

namespace carnot {

// For up to `most` stages. Works on a StageWorkspace, and on the stages of one of its blocks.
template <class T, int size, int most>
class StageNewton {
 public:
  // True when the stages have settled, with L and y there; full coupling only.
  template <class Workspace, class Block>
  [[nodiscard]] bool simplified(Workspace& work, const Block& block, StepReport& report) {
    if (!prepared_) suited_ = decoupled_.set_method(work.tableau);
    prepared_ = true;
    if (!suited_ || !begin(work, block, report)) return false;
    const int count = block.end() - block.begin();
    Point mean;
    for (int i = 0; i < size; ++i) mean[i] = T(0);
    for (int j = block.begin(); j < block.end(); ++j) {
      for (int i = 0; i < size; ++i) mean[i] += work.stages(i, j) / T(count);
    }
    Square a;
    if (!jacobian(work, block.t + block.h / T(2), mean, block.end() / 2, report, a)) return false;
    if (!decoupled_.factor(block.h, a)) return false;
    const auto linearize = [&] { return work.evaluate_all(block, report); };
    return iterate(work, block, report, true, linearize, [&](T* x) {
      decoupled_.solve(x);
      return true;
    });
  }

  template <class Workspace, class Block>
  [[nodiscard]] bool full(Workspace& work, const Block& block, StepReport& report) {
    if (!begin(work, block, report)) return false;
    const auto linearize = [&] {
      for (int j = block.begin(); j < block.end(); ++j) {
        Square a;
        const T time = block.t + work.tableau.c[j] * block.h;
        if (!work.evaluate(block, j, report)) return false;
        if (!jacobian(work, time, work.stage(j), j, report, a)) return false;
        const T weight = block.h * work.tableau.omega[j];
        system_.set_column(work.tableau, block.begin(), block.end(), j, weight, a);
      }
      return true;
    };
    return iterate(work, block, report, false, linearize, [&](T* x) {
      return system_.solve(block.end() - block.begin(), x);
    });
  }

 private:
  static constexpr int kMostIterations = 20;
  using Point = Vector<T, size>;
  using Square = Matrix<T, size, size>;

  template <class Workspace, class Block>
  static bool begin(Workspace& work, const Block& block, StepReport& report) {
    report.status = StepStatus::kOk;
    if (!work.predict(block, false, report)) return false;
    work.set_stages(block, work.stages);
    return true;
  }

  // df/dz, on the branch of stage j.
  template <class Workspace>
  static bool jacobian(
      Workspace& work, const T& time, const Point& at, int j, StepReport& report, Square& a) {
    const RateStatus rate = phase_jacobian(work.system, time, at, work.algebraic(j), a);
    return rate == RateStatus::kOk || work.fail(rate, report);
  }

  // monotone: ends without success where a correction is not smaller than those before.
  template <class Workspace, class Block, class Linearize, class Solve>
  static bool iterate(Workspace& work,
                      const Block& block,
                      StepReport& report,
                      bool monotone,
                      const Linearize& linearize,
                      const Solve& solve) {
    using std::abs;
    T smallest = std::numeric_limits<T>::max();
    auto next = work.stages;
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      if (!linearize()) return false;
      work.set_stages(block, next);
      // Stage by stage, as the rows of the systems.
      std::array<T, size * most> correction;
      T* to = correction.data();
      for (int j = block.begin(); j < block.end(); ++j) {
        for (int i = 0; i < size; ++i) *to++ = next(i, j) - work.stages(i, j);
      }
      if (!solve(correction.data())) return false;
      T change(0);
      const T* from = correction.data();
      for (int j = block.begin(); j < block.end(); ++j) {
        for (int i = 0; i < size; ++i, ++from) {
          if (!(abs(*from) <= std::numeric_limits<T>::max())) return false;
          change = std::max(change, abs(*from));
          work.stages(i, j) += *from;
        }
      }
      const bool stalled = change >= smallest;
      smallest = std::min(smallest, change);
      if (change <= work.stop || (stalled && is_round_off(change, work.scale_of(block)))) {
        return work.evaluate_all(block, report);
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
