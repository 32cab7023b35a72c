// Multiple shooting by NLopt.
//
// SLSQP takes the jumps as equality constraints on the unknowns at the start, z_1, ..., stacked,
// and minimises nothing, so that each iteration is a Newton step of least norm. The others minimise
// half the sum of the squared jumps: L-BFGS over the same unknowns; MLSL, ISRES and CRS, which
// search a box, over the unknowns of the start only, in a box around the guess. What they reach,
// SLSQP joins.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlopt.hpp>
#include <utility>

#include "carnot/shooting/shoot/multiple_shooting.h"
#include "carnot/shooting/shoot/shooting_equations.h"

namespace carnot::internal {
namespace {

// Residuals and Jacobian of all segments at stacked unknowns, each divided by its own scale.
class Stacked {
 public:
  Stacked(const ShootingEquations& equations, Knots knots)
      : equations_(equations), knots_(std::move(knots)) {}

  [[nodiscard]] int unknowns() const { return equations_.unknowns(); }

  // Jacobian row-major unknowns() x unknowns(), may be null. Where a flow fails: large residuals.
  void evaluate(const double* x, double* residual, double* jacobian) const {
    constexpr double kFailed = 1e3;
    const int n = equations_.dof();
    const int size = unknowns();
    if (jacobian != nullptr) std::fill(jacobian, jacobian + size * size, 0.0);
    std::vector<double> block(4 * n * n);
    Knots knots = knots_;
    for (int c = 0; c < size; ++c) knots.z[equations_.place(c)] = x[c] * equations_.unit(c);
    for (int i = 0, row = 0; i < equations_.segments(); row += equations_.residuals(i), ++i) {
      if (!equations_.evaluate(i,
                               knots.at(i),
                               knots.at(i + 1),
                               residual + row,
                               jacobian != nullptr ? block.data() : nullptr)) {
        std::fill(residual + row, residual + row + equations_.residuals(i), kFailed);
        continue;
      }
      for (int r = 0; jacobian != nullptr && r < equations_.residuals(i); ++r) {
        for (int j = 0; j < 4 * n; ++j) {
          const int column = (2 * i - 1) * n + j;
          if (column < 0 || column >= size) continue;
          const int place = equations_.place(column) - 2 * n * i;
          const double inner = j < 2 * n ? block[r * 2 * n + place] * equations_.scale(place) : 0;
          jacobian[(row + r) * size + column] = j < 2 * n ? inner : (j - 2 * n == r ? -1 : 0);
        }
      }
    }
  }

  [[nodiscard]] std::vector<double> pack(const Knots& knots) const {
    std::vector<double> x(unknowns());
    for (int c = 0; c < unknowns(); ++c) x[c] = knots.z[equations_.place(c)] / equations_.unit(c);
    return x;
  }
  void unpack(const std::vector<double>& x, Knots& knots) const {
    for (int c = 0; c < unknowns(); ++c) knots.z[equations_.place(c)] = x[c] * equations_.unit(c);
  }

 private:
  const ShootingEquations& equations_;
  Knots knots_;  // with what is fixed at the start
};

double nothing(unsigned size, const double* /*x*/, double* gradient, void* /*data*/) {
  if (gradient != nullptr) std::fill(gradient, gradient + size, 0.0);
  return 0;
}

void jumps(
    unsigned /*m*/, double* out, unsigned /*size*/, const double* x, double* gradient, void* data) {
  static_cast<const Stacked*>(data)->evaluate(x, out, gradient);
}

double half_square(unsigned size, const double* x, double* gradient, void* data) {
  std::vector<double> residual(size), jacobian(gradient != nullptr ? size * size : 0);
  static_cast<const Stacked*>(data)->evaluate(
      x, residual.data(), gradient != nullptr ? jacobian.data() : nullptr);
  double sum = 0;
  for (const double r : residual) sum += 0.5 * r * r;
  if (gradient != nullptr) std::fill(gradient, gradient + size, 0.0);
  for (unsigned i = 0; gradient != nullptr && i < size; ++i) {
    for (unsigned j = 0; j < size; ++j) gradient[j] += jacobian[i * size + j] * residual[i];
  }
  return sum;
}

// Runs the solver; x is its best point. NLopt throws when round-off stops it.
int run(nlopt::opt& solver, std::vector<double>& x) {
  double value = 0;
  try {
    solver.optimize(x, value);
  } catch (const std::exception&) {
    // x is the best point so far and is judged by its residual.
  }
  return solver.get_numevals();
}

struct Choice {
  const char* name;
  nlopt::algorithm algorithm;
  bool in_a_box;
};
constexpr std::array kChoices{Choice{"nlopt:lbfgs", nlopt::LD_LBFGS, false},
                              Choice{"nlopt:mlsl", nlopt::GD_MLSL_LDS, true},
                              Choice{"nlopt:isres", nlopt::GN_ISRES, true},
                              Choice{"nlopt:crs", nlopt::GN_CRS2_LM, true}};

// Minimises the squared jumps over all unknowns.
int descend(const BoundaryValueProblem& problem, const ShootingOptions& options, Knots& knots) {
  const ShootingEquations equations(problem, knots, options);
  Stacked stacked(equations, knots);
  nlopt::opt solver(nlopt::LD_LBFGS, stacked.unknowns());
  solver.set_min_objective(half_square, &stacked);
  solver.set_stopval(0.5 * options.tolerance * options.tolerance);
  solver.set_maxeval(10 * options.max_iterations);
  std::vector<double> x = stacked.pack(knots);
  const int evaluations = run(solver, x);
  stacked.unpack(x, knots);
  return evaluations;
}

// Searches a box around p(0) for the least miss at the end.
int search_box(const BoundaryValueProblem& problem,
               const ShootingOptions& options,
               nlopt::algorithm algorithm,
               Knots& knots) {
  constexpr double kHalfWidth = 0.5;  // of the box, relative to the largest momentum
  constexpr unsigned long kSeed = 1;  // of NLopt's generator, one for each thread
  Knots single = knots_of(problem, start_unknowns(problem, knots.at(0)), 1, options.steps);
  const ShootingEquations equations(problem, single, options);
  Stacked stacked(equations, single);
  std::vector<double> x = stacked.pack(single);
  std::vector<double> lower = x;
  std::vector<double> upper = x;
  for (double& bound : lower) bound -= kHalfWidth;
  for (double& bound : upper) bound += kHalfWidth;
  nlopt::srand(kSeed);
  nlopt::opt solver(algorithm, stacked.unknowns());
  nlopt::opt local(nlopt::LD_LBFGS, stacked.unknowns());
  local.set_maxeval(options.max_iterations);
  if (algorithm == nlopt::GD_MLSL_LDS) solver.set_local_optimizer(local);
  solver.set_lower_bounds(lower);
  solver.set_upper_bounds(upper);
  solver.set_min_objective(half_square, &stacked);
  solver.set_stopval(options.tolerance);
  solver.set_maxeval(20 * options.max_iterations);
  const int evaluations = run(solver, x);
  stacked.unpack(x, single);
  knots = knots_of(problem, start_unknowns(problem, single.at(0)), knots.segments, options.steps);
  return evaluations;
}

}  // namespace

Shooting shoot_with_nlopt(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots) {
  Shooting result;
  for (const Choice& choice : kChoices) {
    if (options.minimiser != choice.name) continue;
    result.iterations = choice.in_a_box ? search_box(problem, options, choice.algorithm, knots)
                                        : descend(problem, options, knots);
  }
  const ShootingEquations equations(problem, knots, options);
  Stacked stacked(equations, knots);
  nlopt::opt solver(nlopt::LD_SLSQP, stacked.unknowns());
  std::vector<double> x = stacked.pack(knots);
  const double each = options.tolerance / std::sqrt(static_cast<double>(stacked.unknowns()));
  solver.set_min_objective(nothing, nullptr);
  solver.add_equality_mconstraint(jumps, &stacked, std::vector<double>(stacked.unknowns(), each));
  solver.set_stopval(0);
  solver.set_maxeval(2 * options.max_iterations);
  result.iterations += run(solver, x);
  stacked.unpack(x, knots);
  std::vector<double> residual(stacked.unknowns());
  stacked.evaluate(x.data(), residual.data(), nullptr);
  for (const double r : residual) result.residual = std::hypot(result.residual, r);
  result.converged = equations.complete(knots) && result.residual <= options.tolerance;
  return result;
}

}  // namespace carnot::internal
