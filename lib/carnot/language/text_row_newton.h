// Newton's method for systems from text at kTapeLanes points side by side.
//
// It takes the steps of stationary_newton.h by the same tests, each lane with a step length of its
// own. Points that need more are left to that method: where steps get too short or too many, where
// factors without pivots lose digits, where the solution may be singular, and starts of its own.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "carnot/language/text_newton.h"
#include "carnot/numerics/pack.h"

namespace carnot::language {

// Factors L D L' without pivots of symmetric matrices that may be indefinite, one in each lane.
class RowFactor {
 public:
  using P = Pack<kTapeLanes>;
  static constexpr int kMost = 8;  // rows: the matrices of both factors of a step take 9 kB
  using Column = std::array<P, kMost>;
  using Square = std::array<Column, kMost>;

  void factor(const Square& a, int size) {
    // A pivot with fewer digits left is no use. The steps of Newton's method mend what is lost.
    constexpr double kLost = 1e-8;
    size_ = size;
    determinant_ = P(1.0);
    regular_ = P(1.0);
    for (int j = 0; j < size; ++j) {
      P pivot = a[j][j];
      P terms = abs(a[j][j]);
      for (int k = 0; k < j; ++k) {
        const P term = lower_[j][k] * scaled_[j][k];
        pivot -= term;
        terms += abs(term);
      }
      regular_ = select(abs(pivot) > P(kLost) * terms, regular_, P(0.0));
      determinant_ *= pivot;
      inverse_[j] = P(1.0) / pivot;
      for (int i = j + 1; i < size; ++i) {
        P entry = a[i][j];
        for (int k = 0; k < j; ++k) entry -= scaled_[i][k] * lower_[j][k];
        scaled_[i][j] = entry;
        lower_[i][j] = entry * inverse_[j];
      }
    }
  }

  // 1 where no pivot lost its digits, else 0. NaN is not regular.
  [[nodiscard]] const P& regular() const { return regular_; }
  [[nodiscard]] const P& determinant() const { return determinant_; }

  [[nodiscard]] Column solve(Column x) const {
    for (int i = 1; i < size_; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= lower_[i][k] * x[k];
    }
    for (int i = size_ - 1; i >= 0; --i) {
      x[i] *= inverse_[i];
      for (int k = i + 1; k < size_; ++k) x[i] -= lower_[k][i] * x[k];
    }
    return x;
  }

 private:
  int size_ = 0;
  Square lower_;
  Square scaled_;  // L D
  Column inverse_;
  P determinant_;
  P regular_;
};

class RowNewton {
 public:
  using P = RowFactor::P;
  using Lanes = std::array<double, kTapeLanes>;  // 1 where something is true, else 0

  // `equations` gives H_y and H_yy row by row for `size` algebraic variables. The one group of
  // `rows`, at kTapeLanes points, that is not read is theirs.
  RowNewton(const Tape& equations, const TextEquations::Groups& rows, int size)
      : equations_(equations), rows_(rows), size_(size) {}

  static bool fits(int size) { return size <= RowFactor::kMost; }

  // In the lanes `which`, from y, whose rows become the solution where the result is 1, and stay
  // what they were elsewhere. Each step costs one call of the tape and one factor.
  Lanes solve(Pursuit pursuit, const Lanes& which, double* y) {
    // Of 2.2 million points on paths with Appell's constraint 2 % are left with these numbers.
    // Twice as many steps, and shorter ones, took as long.
    constexpr int kMostSteps = 32;
    constexpr double kShortest = 1.0 / 1024;
    const P zero(0.0);
    const P one(1.0);
    for (int i = 0; i < size_; ++i) here_.x[i] = P::load(y + i * kTapeLanes);
    open_ = P::load(which.data());
    solved_ = zero;
    linearize(here_);
    const P first = abs(here_.factor.determinant());
    least_ = P(std::cbrt(std::numeric_limits<double>::epsilon())) * first;
    open_ = open_ * here_.factor.regular();
    Column step = here_.factor.solve(minus(here_.residual));
    take_settled(open_, here_, step, y);
    P length = one;
    for (int count = 0; count < kMostSteps && largest(open_) > 0; ++count) {
      for (int i = 0; i < size_; ++i) next_.x[i] = here_.x[i] + length * step[i];
      linearize(next_);
      // What the old factor asks for now, against what it should ask for.
      const Column left = here_.factor.solve(minus(next_.residual));
      P deviation = zero;
      P whole = zero;
      for (int i = 0; i < size_; ++i) {
        const P aside = left[i] - (one - length) * step[i];
        deviation += aside * aside;
        whole += step[i] * step[i];
      }
      P good = select(deviation <= P(0.25) * length * length * whole, open_, zero);
      take_settled(good, next_, left, y);
      good = good * open_;
      if (pursuit == Pursuit::kBranch) {
        const P ratio = next_.factor.determinant() / here_.factor.determinant();
        good = select(ratio > P(0.25), good, zero);
        good = select(ratio < P(4.0), good, zero);
      }
      open_ = open_ - good * (one - next_.factor.regular());
      good = good * open_;
      move(good);
      step = here_.factor.solve(minus(here_.residual));
      length = select(good > zero, min(one, P(2.0) * length), P(0.5) * length);
      open_ = select(length >= P(kShortest), open_, zero);
    }
    Lanes result;
    solved_.store(result.data());
    return result;
  }

 private:
  using Column = RowFactor::Column;
  using Square = RowFactor::Square;
  struct Point {
    Column x;
    Column residual;  // H_y
    Square hessian;   // H_yy
    RowFactor factor;
  };

  [[nodiscard]] Column minus(const Column& x) const {
    Column result;
    for (int i = 0; i < size_; ++i) result[i] = -x[i];
    return result;
  }

  void linearize(Point& at) {
    std::array<double, RowFactor::kMost * kTapeLanes> x;
    std::array<double, RowFactor::kMost * kTapeLanes> first;
    std::array<double, RowFactor::kMost * RowFactor::kMost * kTapeLanes> second;
    for (int i = 0; i < size_; ++i) at.x[i].store(x.data() + i * kTapeLanes);
    rows_[3] = x.data();
    (void)equations_.run_rows(rows_, std::array<double*, 2>{first.data(), second.data()});
    for (int i = 0; i < size_; ++i) {
      at.residual[i] = P::load(first.data() + i * kTapeLanes);
      for (int j = 0; j < size_; ++j) {
        at.hessian[i][j] = P::load(second.data() + (i * size_ + j) * kTapeLanes);
      }
    }
    at.factor.factor(at.hessian, size_);
  }

  // In the lanes `which` the next point becomes the one at hand. Of lanes that are not open no one
  // asks.
  void move(const P& which) {
    if (largest(open_ - which) == 0) {
      std::swap(here_, next_);
      return;
    }
    if (largest(which) == 0) return;
    const auto moved = which > P(0.0);
    for (int i = 0; i < size_; ++i) {
      here_.x[i] = select(moved, next_.x[i], here_.x[i]);
      here_.residual[i] = select(moved, next_.residual[i], here_.residual[i]);
      for (int j = 0; j < size_; ++j) {
        here_.hessian[i][j] = select(moved, next_.hessian[i][j], here_.hessian[i][j]);
      }
    }
    here_.factor.factor(here_.hessian, size_);
  }

  // Those of the lanes `which` where the step or the residual is round-off are solved by x + step.
  void take_settled(const P& which, const Point& at, const Column& step, double* y) {
    const P few(8 * std::numeric_limits<double>::epsilon());
    P longest(0.0);
    P size(0.0);
    P rounded(1.0);
    for (int i = 0; i < size_; ++i) {
      longest = max(longest, abs(step[i]));
      size = max(size, abs(at.x[i]));
      P terms(0.0);
      for (int j = 0; j < size_; ++j) terms += abs(at.hessian[i][j] * at.x[j]);
      rounded = select(abs(at.residual[i]) <= few * terms, rounded, P(0.0));
    }
    const P settled = which * select(longest <= few * size, P(1.0), rounded);
    open_ -= settled;
    // A singular solution is looked at more closely.
    const P sound = select(abs(at.factor.determinant()) > least_, settled, P(0.0));
    const auto now = sound > P(0.0);
    for (int i = 0; i < size_; ++i) {
      double* const row = y + i * kTapeLanes;
      select(now, at.x[i] + step[i], P::load(row)).store(row);
    }
    solved_ += sound;
  }

  const Tape& equations_;
  TextEquations::Groups rows_;
  int size_;
  Point here_;
  Point next_;
  P open_;  // lanes that are neither solved nor left
  P solved_;
  P least_;  // determinant that is not singular
};

}  // namespace carnot::language
