#include "carnot/shooting/path/interior_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/shooting/linear/banded_ldlt.h"
#include "carnot/shooting/path/discrete_equations.h"

namespace carnot::internal {
namespace {

class Method {
 public:
  Method(const BoundaryValueProblem& problem,
         const Walls& walls,
         const InteriorPointOptions& options,
         LimitedPath& limited)
      : problem_(problem),
        walls_(walls),
        options_(options),
        limited_(limited),
        n_(limited.path.dof),
        m_(walls.size()),
        nodes_(limited.path.intervals + 1),
        h_(problem.time / limited.path.intervals),
        equations_(problem, limited.path.intervals),
        matrix_(equations_.matrix()),
        s_(size()),
        gradients_(size() * n_),
        hessians_(gradients_.size() * n_),
        sigma_step_(size()),
        nu_step_(size()) {}

  InteriorPoint run();

 private:
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(nodes_) * m_; }
  // Whether a node may move at all.
  [[nodiscard]] bool moves(int node) const {
    for (int j = 0; j < n_; ++j) {
      if (equations_.of_node(node, j) >= 0) return true;
    }
    return false;
  }
  [[nodiscard]] double size_of(int wall) const { return options_.sizes[wall]; }
  // nu in this unit is one where a wall takes as much as the action itself.
  [[nodiscard]] double force_of(int wall) const { return options_.rate / size_of(wall); }
  [[nodiscard]] double product() const { return mu_ * options_.rate; }

  void set_walls();
  void start();
  // Everything but the complementarity; the residual of the equations of the path in `residual_`.
  double evaluate(bool with_matrix);
  [[nodiscard]] double complementarity() const;
  void add_walls();
  void eliminate(const std::vector<double>& direction);
  // The longest step that leaves x positive.
  [[nodiscard]] double longest(const std::vector<double>& x, const std::vector<double>& step) const;
  // Moves on, and `worst` from what evaluate() says before to what it says after that.
  bool advance(const std::vector<double>& direction, double& worst);
  // Whether the matrix has as many negative eigenvalues as F_d has multipliers.
  [[nodiscard]] bool has_right_inertia();
  void assemble();

  const BoundaryValueProblem& problem_;
  const Walls& walls_;
  const InteriorPointOptions& options_;
  LimitedPath& limited_;
  int n_;
  int m_;
  int nodes_;
  double h_;
  DiscreteEquations equations_;
  BandedLu matrix_;
  std::vector<double> s_;
  std::vector<double> gradients_;
  std::vector<double> hessians_;
  std::vector<double> sigma_step_;
  std::vector<double> nu_step_;
  std::vector<double> residual_;
  double mu_ = 0;
  double scale_ = 1;
};

void Method::set_walls() {
  for (int node = 0; node < nodes_; ++node) {
    const std::size_t at = static_cast<std::size_t>(node) * m_;
    walls_.evaluate(
        limited_.path.configuration(node), &s_[at], &gradients_[at * n_], &hessians_[at * n_ * n_]);
  }
}

void Method::start() {
  constexpr double kLeastSlack = 0.1;  // of the size of the wall
  mu_ = options_.first_mu;
  set_walls();
  if (!limited_.sigma.empty()) return;
  limited_.sigma.resize(size());
  limited_.nu.resize(size());
  for (std::size_t i = 0; i < size(); ++i) {
    const int wall = static_cast<int>(i) % m_;
    limited_.sigma[i] = std::max(s_[i], kLeastSlack * size_of(wall));
    const bool fixed = !moves(static_cast<int>(i) / m_);
    limited_.nu[i] = fixed ? 0 : product() / limited_.sigma[i];
  }
}

double Method::evaluate(bool with_matrix) {
  scale_ = equations_.evaluate(limited_.path, residual_, with_matrix ? &matrix_ : nullptr);
  double worst = 0;
  for (int node = 0; node < nodes_; ++node) {
    if (!moves(node)) continue;
    for (int w = 0; w < m_; ++w) {
      const std::size_t i = static_cast<std::size_t>(node) * m_ + w;
      for (int j = 0; j < n_; ++j) {
        const int row = equations_.of_node(node, j);
        if (row >= 0) residual_[row] -= h_ * limited_.nu[i] * gradients_[i * n_ + j];
      }
      worst = std::max(worst, std::abs(s_[i] - limited_.sigma[i]) / size_of(w));
    }
  }
  for (const double r : residual_) {
    worst = std::abs(r) / scale_ <= worst ? worst : std::abs(r) / scale_;
  }
  return worst;
}

double Method::complementarity() const {
  double worst = 0;
  for (int node = 0; node < nodes_; ++node) {
    if (!moves(node)) continue;
    for (int w = 0; w < m_; ++w) {
      const std::size_t i = static_cast<std::size_t>(node) * m_ + w;
      worst = std::max(worst, std::abs(limited_.nu[i] * limited_.sigma[i] - product()));
    }
  }
  return worst / options_.rate;
}

// To the matrix, and to the residual what is left of the other equations.
void Method::add_walls() {
  for (int node = 0; node < nodes_; ++node) {
    if (!moves(node)) continue;
    for (int w = 0; w < m_; ++w) {
      const std::size_t i = static_cast<std::size_t>(node) * m_ + w;
      const double nu = limited_.nu[i];
      const double sigma = limited_.sigma[i];
      const double pull = nu / sigma;
      const double left = (nu * sigma - product() + nu * (s_[i] - sigma)) / sigma;
      for (int a = 0; a < n_; ++a) {
        const int row = equations_.of_node(node, a);
        if (row < 0) continue;
        const double by_a = gradients_[i * n_ + a];
        residual_[row] += h_ * left * by_a;
        for (int b = 0; b < n_; ++b) {
          const int column = equations_.of_node(node, b);
          if (column < 0) continue;
          const double bent = nu * hessians_[(i * n_ + a) * n_ + b];
          matrix_(row, column) += h_ * (pull * by_a * gradients_[i * n_ + b] - bent);
        }
      }
    }
  }
}

void Method::eliminate(const std::vector<double>& direction) {
  std::fill(sigma_step_.begin(), sigma_step_.end(), 0.0);
  std::fill(nu_step_.begin(), nu_step_.end(), 0.0);
  for (int node = 0; node < nodes_; ++node) {
    if (!moves(node)) continue;
    for (int w = 0; w < m_; ++w) {
      const std::size_t i = static_cast<std::size_t>(node) * m_ + w;
      double along = s_[i] - limited_.sigma[i];
      for (int j = 0; j < n_; ++j) {
        const int at = equations_.of_node(node, j);
        if (at >= 0) along -= gradients_[i * n_ + j] * direction[at];
      }
      sigma_step_[i] = along;
      nu_step_[i] = (product() - limited_.nu[i] * (limited_.sigma[i] + along)) / limited_.sigma[i];
    }
  }
}

double Method::longest(const std::vector<double>& x, const std::vector<double>& step) const {
  const double share = std::max(0.99, 1 - mu_);
  double longest = 1;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (step[i] < 0) longest = std::min(longest, -share * x[i] / step[i]);
  }
  return longest;
}

bool Method::advance(const std::vector<double>& direction, double& worst) {
  constexpr double kShortest = 1.0 / 64;
  // A residual that grows more, and is not small, is of a step into nowhere. It must be let grow
  // from round-off: for Bryson and Denham's problem, where mu was lowered after the equations had
  // been solved, no step was good enough otherwise.
  constexpr double kWorse = 10;
  constexpr double kSmall = 1e-2;
  const LimitedPath start = limited_;
  const bool walled = in_one_chart(problem_.dynamics, start.path);
  const double primal = longest(start.sigma, sigma_step_);
  const double dual = longest(start.nu, nu_step_);
  for (double share = 1; share >= kShortest; share *= 0.5) {
    equations_.move(start.path, direction, share * primal, limited_.path);
    for (std::size_t i = 0; i < size(); ++i) {
      limited_.sigma[i] = start.sigma[i] + share * primal * sigma_step_[i];
      limited_.nu[i] = start.nu[i] + share * dual * nu_step_[i];
    }
    if (walled && !in_one_chart(problem_.dynamics, limited_.path)) continue;
    set_walls();
    const double after = evaluate(false);
    if (after <= std::max(kWorse * worst, kSmall)) {
      worst = after;
      return true;
    }
  }
  limited_ = start;
  set_walls();
  return false;
}

// The multipliers' own block, which vanishes for velocity constraints, is shifted a little: the
// matrix is quasi-definite then, and its inertia is that of the second derivatives where the
// constraints leave the nodes free.
bool Method::has_right_inertia() {
  constexpr double kShift = 1e-8;
  const int size = equations_.size();
  const int band = 2 * n_ + PathLagrangian::multipliers(problem_.dynamics) - 1;
  BandedLdlt symmetric(size, band);
  double largest = 0;
  int multipliers = 0;
  for (int row = 0; row < size; ++row) {
    for (int column = row; column < std::min(size, row + band + 1); ++column) {
      symmetric(row, column) = matrix_(row, column);
      if (equations_.is_multiplier(row)) {
        largest = std::max(largest, std::abs(matrix_(row, column)));
      }
    }
  }
  for (int row = 0; row < size; ++row) {
    if (!equations_.is_multiplier(row)) continue;
    ++multipliers;
    symmetric(row, row) -= kShift * largest;
  }
  return symmetric.factor() == multipliers;
}

// Sets the matrix with the walls. Where it is not that of a minimum multiples of the kinetic energy
// are added, as in descent.h: Newton's method alone goes to and fro between nodes at which a wall
// pins the path.
void Method::assemble() {
  constexpr double kFirst = 1e-2;
  constexpr double kLast = 1e3;
  constexpr double kFactor = 10;
  evaluate(true);
  add_walls();
  if (!problem_.dynamics.has_transcription()) return;
  double added = 0;
  for (double next = kFirst; next <= kLast && !has_right_inertia(); next *= kFactor) {
    equations_.add_metric(limited_.path, next - added, matrix_);
    added = next;
  }
}

InteriorPoint Method::run() {
  constexpr double kMet = 10;  // times mu: then mu is lowered
  constexpr double kFactor = 0.2;
  constexpr double kPower = 1.5;
  InteriorPoint result;
  start();
  double worst = evaluate(false);
  while (result.iterations < options_.max_iterations) {
    result.residual = std::max(worst, complementarity());
    result.mu = mu_;
    if (!std::isfinite(result.residual)) break;
    if (mu_ <= options_.last_mu && worst <= options_.tolerance &&
        complementarity() <= options_.last_mu) {
      result.converged = true;
      evaluate(true);
      add_walls();
      result.minimum = has_right_inertia();
      break;
    }
    if (result.residual <= kMet * mu_ && mu_ > options_.last_mu) {
      mu_ = std::max(options_.last_mu, std::min(kFactor * mu_, std::pow(mu_, kPower)));
      continue;
    }
    ++result.iterations;
    assemble();
    if (!matrix_.factor()) break;
    std::vector<double> direction = residual_;
    matrix_.substitute(direction);
    eliminate(direction);
    if (!advance(direction, worst)) break;
  }
  fill_momenta(problem_.dynamics, h_, limited_.path);
  return result;
}

}  // namespace

InteriorPoint interior_point(const BoundaryValueProblem& problem,
                             const Walls& walls,
                             const InteriorPointOptions& options,
                             LimitedPath& limited) {
  return Method(problem, walls, options, limited).run();
}

}  // namespace carnot::internal
