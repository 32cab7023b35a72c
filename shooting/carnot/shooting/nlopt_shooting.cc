// Multiple shooting by NLopt, on the unknowns p(0), z_1, ..., stacked.
#include <algorithm>
#include <cmath>
#include <map>
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

double sum_of_squares(unsigned size, const double* x, double* gradient, void* data) {
  const auto& stacked = *static_cast<const Stacked*>(data);
  std::vector<double> residual(size);
  std::vector<double> jacobian(gradient != nullptr ? size * size : 0);
  stacked.evaluate(x, residual.data(), gradient != nullptr ? jacobian.data() : nullptr);
  double sum = 0;
  for (unsigned r = 0; r < size; ++r) sum += 0.5 * residual[r] * residual[r];
  for (unsigned c = 0; gradient != nullptr && c < size; ++c) {
    gradient[c] = 0;
    for (unsigned r = 0; r < size; ++r) gradient[c] += residual[r] * jacobian[r * size + c];
  }
  return sum;
}

// Feasibility is all that SLSQP is asked for.
double nothing(unsigned size, const double* /*x*/, double* gradient, void* /*data*/) {
  if (gradient != nullptr) std::fill(gradient, gradient + size, 0.0);
  return 0;
}

void jumps(
    unsigned m, double* result, unsigned /*size*/, const double* x, double* gradient, void* data) {
  static_cast<const Stacked*>(data)->evaluate(x, result, gradient);
  (void)m;
}

nlopt::algorithm algorithm_of(const std::string& minimiser) {
  const std::map<std::string, nlopt::algorithm> names{{"nlopt:lbfgs", nlopt::LD_LBFGS},
                                                      {"nlopt:tnewton", nlopt::LD_TNEWTON_PRECOND},
                                                      {"nlopt:var2", nlopt::LD_VAR2}};
  const auto found = names.find(minimiser);
  return found != names.end() ? found->second : nlopt::LD_SLSQP;
}

}  // namespace

Shooting shoot_with_nlopt(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots) {
  const ShootingEquations equations(problem, knots, options.steps);
  Stacked stacked(equations, knots.at(0));
  const nlopt::algorithm algorithm = algorithm_of(options.minimiser);
  nlopt::opt solver(algorithm, stacked.unknowns());
  std::vector<double> x = stacked.pack(knots);
  const double cost = 0.5 * options.tolerance * options.tolerance;
  if (algorithm == nlopt::LD_SLSQP) {
    const double each = options.tolerance / std::sqrt(static_cast<double>(stacked.unknowns()));
    solver.set_min_objective(nothing, nullptr);
    solver.add_equality_mconstraint(
        jumps, &stacked, std::vector<double>(stacked.unknowns(), each));
    solver.set_stopval(0);
    solver.set_maxeval(2 * options.max_iterations);
  } else {
    solver.set_min_objective(sum_of_squares, &stacked);
    solver.set_stopval(cost);
    solver.set_maxeval(10 * options.max_iterations);
  }
  Shooting result;
  double value = 0;
  try {
    solver.optimize(x, value);
  } catch (const std::exception&) {
    // NLopt throws when round-off stops it; x is its best point so far and is judged below.
  }
  result.iterations = solver.get_numevals();
  stacked.unpack(x, knots);
  result.residual = std::sqrt(2 * sum_of_squares(stacked.unknowns(), x.data(), nullptr, &stacked));
  result.converged = equations.complete(knots) && result.residual <= options.tolerance;
  return result;
}

}  // namespace carnot
