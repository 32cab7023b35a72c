// Multiple shooting by NLopt's SLSQP: the jumps are equality constraints on the unknowns p(0), z_1,
// ..., stacked, and nothing is minimised, so that each iteration is a Newton step of least norm.
#include <algorithm>
#include <cmath>
#include <nlopt.hpp>

#include "carnot/shooting/multiple_shooting.h"
#include "carnot/shooting/shooting_equations.h"

namespace carnot {
namespace {

// Residuals and Jacobian of all segments at stacked unknowns, each divided by its own scale.
class Stacked {
 public:
  Stacked(const ShootingEquations& equations, const double* q0)
      : equations_(equations), q0_(q0, q0 + equations.dof()) {}

  [[nodiscard]] int unknowns() const { return (2 * equations_.segments() - 1) * equations_.dof(); }

  // Jacobian row-major unknowns() x unknowns(), may be null. Where a flow fails: large residuals.
  void evaluate(const double* x, double* residual, double* jacobian) const {
    constexpr double kFailed = 1e3;
    const int n = equations_.dof();
    const int size = unknowns();
    if (jacobian != nullptr) std::fill(jacobian, jacobian + size * size, 0.0);
    std::vector<double> z(4 * n), block(4 * n * n);
    for (int i = 0, row = 0; i < equations_.segments(); row += equations_.residuals(i), ++i) {
      for (int j = 0; j < 4 * n; ++j) {
        const int column = (2 * i - 1) * n + j;
        if (column < size) z[j] = column < 0 ? q0_[j] : x[column] * equations_.scale(j % (2 * n));
      }
      if (!equations_.evaluate(i,
                               z.data(),
                               z.data() + 2 * n,
                               residual + row,
                               jacobian != nullptr ? block.data() : nullptr)) {
        std::fill(residual + row, residual + row + equations_.residuals(i), kFailed);
        continue;
      }
      for (int r = 0; jacobian != nullptr && r < equations_.residuals(i); ++r) {
        for (int j = 0; j < 4 * n; ++j) {
          const int column = (2 * i - 1) * n + j;
          if (column < 0 || column >= size) continue;
          const double inner = j < 2 * n ? block[r * 2 * n + j] * equations_.scale(j) : 0;
          jacobian[(row + r) * size + column] = j < 2 * n ? inner : (j - 2 * n == r ? -1 : 0);
        }
      }
    }
  }

  [[nodiscard]] std::vector<double> pack(const Knots& knots) const {
    std::vector<double> x(knots.z.begin() + equations_.dof(), knots.z.end() - 2 * knots.dof);
    for (int c = 0; c < unknowns(); ++c) x[c] /= scale_of(c);
    return x;
  }
  void unpack(const std::vector<double>& x, Knots& knots) const {
    for (int c = 0; c < unknowns(); ++c) knots.z[equations_.dof() + c] = x[c] * scale_of(c);
  }

 private:
  [[nodiscard]] double scale_of(int column) const {
    return equations_.scale((column + equations_.dof()) % (2 * equations_.dof()));
  }

  const ShootingEquations& equations_;
  std::vector<double> q0_;
};

double nothing(unsigned size, const double* /*x*/, double* gradient, void* /*data*/) {
  if (gradient != nullptr) std::fill(gradient, gradient + size, 0.0);
  return 0;
}

void jumps(
    unsigned /*m*/, double* out, unsigned /*size*/, const double* x, double* gradient, void* data) {
  static_cast<const Stacked*>(data)->evaluate(x, out, gradient);
}

}  // namespace

Shooting shoot_with_nlopt(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots) {
  const ShootingEquations equations(problem, knots, options.steps);
  Stacked stacked(equations, knots.at(0));
  nlopt::opt solver(nlopt::LD_SLSQP, stacked.unknowns());
  std::vector<double> x = stacked.pack(knots);
  const double each = options.tolerance / std::sqrt(static_cast<double>(stacked.unknowns()));
  solver.set_min_objective(nothing, nullptr);
  solver.add_equality_mconstraint(jumps, &stacked, std::vector<double>(stacked.unknowns(), each));
  solver.set_stopval(0);
  solver.set_maxeval(2 * options.max_iterations);
  Shooting result;
  double value = 0;
  try {
    solver.optimize(x, value);
  } catch (const std::exception&) {
    // NLopt throws when round-off stops it; x is its best point so far and is judged below.
  }
  result.iterations = solver.get_numevals();
  stacked.unpack(x, knots);
  std::vector<double> residual(stacked.unknowns());
  stacked.evaluate(x.data(), residual.data(), nullptr);
  for (const double r : residual) result.residual = std::hypot(result.residual, r);
  result.converged = equations.complete(knots) && result.residual <= options.tolerance;
  return result;
}

}  // namespace carnot
