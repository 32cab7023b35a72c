// Multiple shooting by Newton's method on the banded equations.
//
// A step is halved until the residual or, as its affine invariant measure, the next step with the
// same Jacobian is shorter (Deuflhard, Newton Methods for Nonlinear Problems, 3.3).
#include <algorithm>
#include <cmath>

#include "carnot/shooting/linear/banded_lu.h"
#include "carnot/shooting/linear/norm.h"
#include "carnot/shooting/shoot/multiple_shooting.h"
#include "carnot/shooting/shoot/shooting_equations.h"

namespace carnot::internal {
namespace {

// The unknowns at the start, z_1, ..., in units of their scale, and the jumps.
class Banded {
 public:
  Banded(const ShootingEquations& equations, const Knots& knots)
      : equations_(equations),
        n_(knots.dof),
        size_(equations.unknowns()),
        matrix_(size_, 3 * n_ - 1, 3 * n_ - 1),
        block_(static_cast<std::size_t>(4) * n_ * n_) {}

  // Residuals at `knots` and, where asked for, the Jacobian and its growth.
  [[nodiscard]] bool evaluate(const Knots& knots, bool with_matrix, std::vector<double>& residual) {
    residual.resize(size_);
    if (with_matrix) matrix_.clear();
    growth_ = with_matrix ? 0 : growth_;
    for (int i = 0; i < knots.segments; ++i) {
      const int row = 2 * n_ * i;
      double* jacobian = with_matrix ? block_.data() : nullptr;
      if (!equations_.evaluate(i, knots.at(i), knots.at(i + 1), &residual[row], jacobian)) {
        return false;
      }
      if (!with_matrix) continue;
      growth_ = std::max(growth_, equations_.growth(i, jacobian));
      for (int r = 0; r < equations_.residuals(i); ++r) {
        for (int c = i == 0 ? n_ : 0; c < 2 * n_; ++c) {
          const int unknown = row - n_ + c;
          const int place = equations_.place(unknown) % (2 * n_);
          matrix_(row + r, unknown) = block_[r * 2 * n_ + place] * equations_.scale(place);
        }
        if (i + 1 < knots.segments) matrix_(row + r, row + n_ + r) = -1;
      }
    }
    return true;
  }

  void move(const Knots& from, const std::vector<double>& step, double share, Knots& to) const {
    for (int c = 0; c < size_; ++c) {
      const int place = equations_.place(c);
      to.z[place] = from.z[place] - share * step[c] * equations_.unit(c);
    }
  }

  [[nodiscard]] bool factor() { return matrix_.factor(); }
  void substitute(std::vector<double>& b) { matrix_.substitute(b); }
  [[nodiscard]] double growth() const { return growth_; }

 private:
  const ShootingEquations& equations_;
  int n_;
  int size_;
  BandedLu matrix_;
  std::vector<double> block_;
  double growth_ = 0;
};

}  // namespace

Shooting shoot_with_newton(const BoundaryValueProblem& problem,
                           const ShootingOptions& options,
                           Knots& knots) {
  constexpr double kShortestStep = 1.0 / 32;
  const ShootingEquations equations(problem, knots, options);
  Banded system(equations, knots);
  std::vector<double> residual;
  Shooting result;
  if (!system.evaluate(knots, true, residual)) return result;
  result.residual = norm(residual);
  result.growth = system.growth();
  const double first = result.residual;
  Knots trial = knots;
  std::vector<double> step;
  std::vector<double> simplified;
  while (result.residual > options.tolerance && result.iterations < options.max_iterations) {
    if (result.growth > options.max_growth) break;
    const bool hardly_smaller = result.residual > kHardlySmaller * first;
    if (options.near && result.iterations == kTrials && hardly_smaller) break;
    ++result.iterations;
    step = residual;
    if (!system.factor()) break;
    system.substitute(step);
    const double length = norm(step);
    double share = 1;
    double reached = 0;
    for (; share >= kShortestStep; share *= 0.5) {
      system.move(knots, step, share, trial);
      if (!system.evaluate(trial, false, residual)) continue;
      reached = norm(residual);
      if (reached < (1 - 0.1 * share) * result.residual) break;
      simplified = residual;
      system.substitute(simplified);
      if (norm(simplified) < (1 - 0.25 * share) * length && length > options.tolerance) break;
    }
    if (share < kShortestStep) break;
    std::swap(knots.z, trial.z);
    if (!system.evaluate(knots, true, residual)) break;
    result.residual = norm(residual);
    result.growth = system.growth();
  }
  result.converged = equations.complete(knots) && result.residual <= options.tolerance;
  return result;
}

}  // namespace carnot::internal
