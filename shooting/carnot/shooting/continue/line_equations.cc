#include "carnot/shooting/continue/line_equations.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace carnot::internal {
namespace {

constexpr int kNodes = 5;
constexpr double kSpacing = 1.0 / 2048;  // of the nodes in s: h^4 and eps / h are both about 1e-13

// d/dx at x of the polynomial through the nodes 0, 1, ..., as weights of its values.
std::array<double, kNodes> derivative_weights(double x) {
  std::array<double, kNodes> weights{};
  for (int i = 0; i < kNodes; ++i) {
    for (int k = 0; k < kNodes; ++k) {
      if (k == i) continue;
      double product = 1.0 / (i - k);
      for (int j = 0; j < kNodes; ++j) {
        if (j != i && j != k) product *= (x - j) / (i - j);
      }
      weights[i] += product;
    }
  }
  return weights;
}

}  // namespace

LineEquations::LineEquations(const ProblemLine& line, const Knots& knots, double s, long steps)
    : line_(line),
      reference_(knots),
      steps_(steps),
      size_((2 * knots.segments - 1) * knots.dof),
      weights_(size_),
      rows_(size_) {
  const BoundaryValueProblem problem = line.at(s);
  const ShootingEquations equations(problem, knots, {.steps = steps});
  const double share = std::sqrt(static_cast<double>(knots.segments));
  for (int c = 0; c < 2 * knots.dof; ++c) scale_.push_back(equations.scale(c));
  for (int c = 0; c < size_; ++c) {
    places_.push_back(equations.place(c));
    weights_[c] = share * equations.unit(c);
  }
  for (int i = 0, row = 0; i < knots.segments; row += equations.residuals(i), ++i) {
    for (int r = 0; r < equations.residuals(i); ++r) {
      rows_[row + r] = scale_[equations.component(i, r)];
    }
  }
}

Eigen::VectorXd LineEquations::unknowns(const Knots& knots, double s) const {
  Eigen::VectorXd x(size_ + 1);
  for (int c = 0; c < size_; ++c) x[c] = knots.z[places_[c]] / weights_[c];
  x[size_] = s;
  return x;
}

Knots LineEquations::open_knots(const Eigen::VectorXd& x, const std::vector<double>& from) const {
  Knots knots = reference_;
  std::copy(from.begin(), from.end(), knots.z.begin());
  for (int c = 0; c < size_; ++c) knots.z[places_[c]] = x[c] * weights_[c];
  return knots;
}

Knots LineEquations::knots(const Eigen::VectorXd& x) const {
  const BoundaryValueProblem problem = line_.at(std::clamp(x[size_], 0.0, 1.0));
  Knots knots = open_knots(x, problem.from);
  (void)ShootingEquations(problem, knots, {.steps = steps_}).complete(knots);
  return knots;
}

Eigen::VectorXd LineEquations::head(const Eigen::VectorXd& x) const {
  const int n = reference_.dof;
  Eigen::VectorXd head(n + 1);
  head << x.head(n).cwiseProduct(weights_.head(n)), x[size_];
  return head;
}

Eigen::VectorXd LineEquations::from_head(const Eigen::VectorXd& head) const {
  const int n = reference_.dof;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size_ + 1);
  x.head(n) = head.head(n).cwiseQuotient(weights_.head(n));
  x[size_] = head[n];
  return x;
}

bool LineEquations::in_scale(const Eigen::VectorXd& x) const {
  constexpr double kFactor = 4;
  const int n = reference_.dof;
  double largest = 0;
  for (int c = 0; c < size_; c += 2 * n) {
    largest = std::max(largest, x.segment(c, n).cwiseAbs().maxCoeff());
  }
  largest *= std::sqrt(static_cast<double>(reference_.segments));
  return largest < kFactor && largest > 1 / kFactor;
}

bool LineEquations::values(const Eigen::VectorXd& x, double s, Eigen::VectorXd& f) const {
  const BoundaryValueProblem problem = line_.at(s);
  const Knots knots = open_knots(x, problem.from);
  const ShootingEquations equations(problem, reference_, {.steps = steps_});
  f.resize(size_);
  for (int i = 0; i < knots.segments; ++i) {
    const int row = 2 * knots.dof * i;
    if (!equations.evaluate(i, knots.at(i), knots.at(i + 1), f.data() + row, nullptr)) return false;
    for (int r = 0; r < equations.residuals(i); ++r) {
      f[row + r] *= equations.scale(equations.component(i, r));
    }
  }
  return true;
}

bool LineEquations::add_derivative_in_s(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const {
  const int n = reference_.dof;
  const int last = size_ - n;
  auto column = jacobian.col(size_);
  column.setZero();
  if (line_.only_target) {
    const BoundaryValueProblem start = line_.at(0);
    const BoundaryValueProblem end = line_.at(1);
    for (int j = 0; j < n; ++j) {
      column[last + j] = target_value(start, j) - target_value(end, j);
    }
  } else {
    const double s = std::clamp(x[size_], 0.0, 1.0);
    const double first = std::clamp(s - 2 * kSpacing, 0.0, 1 - (kNodes - 1) * kSpacing);
    const std::array<double, kNodes> weights = derivative_weights((s - first) / kSpacing);
    Eigen::VectorXd f;
    for (int i = 0; i < kNodes; ++i) {
      if (!values(x, first + i * kSpacing, f)) return false;
      column += weights[i] / kSpacing * f;
    }
  }
  for (int r = 0; r < size_; ++r) column[r] /= rows_[r];
  return true;
}

bool LineEquations::evaluate(const Eigen::VectorXd& x,
                             Eigen::VectorXd& residual,
                             Eigen::MatrixXd& jacobian) {
  constexpr double kBeyond = 1e-9;  // the ends, where the corrector ends beside them
  if (!(x[size_] >= -kBeyond && x[size_] <= 1 + kBeyond)) return false;
  const double s = std::clamp(x[size_], 0.0, 1.0);
  const int n = reference_.dof;
  const BoundaryValueProblem problem = line_.at(s);
  const Knots knots = open_knots(x, problem.from);
  const ShootingEquations equations(problem, reference_, {.steps = steps_});
  std::vector<double> block(static_cast<std::size_t>(4) * n * n);
  residual.resize(size_);
  jacobian.setZero(size_, size_ + 1);
  growth_ = 0;
  for (int i = 0; i < knots.segments; ++i) {
    const int row = 2 * n * i;
    double* values = residual.data() + row;
    if (!equations.evaluate(i, knots.at(i), knots.at(i + 1), values, block.data())) return false;
    for (int r = 0; r < equations.residuals(i); ++r) {
      const double unit = equations.scale(equations.component(i, r)) / rows_[row + r];
      values[r] *= unit;
      for (int c = i == 0 ? n : 0; c < 2 * n; ++c) {
        const int unknown = row - n + c;
        const int place = places_[unknown] % (2 * n);
        const double entry = unit * block[r * 2 * n + place];
        growth_ = std::max(growth_, std::abs(entry * scale_[place]));
        jacobian(row + r, unknown) = entry * weights_[unknown];
      }
      const int next = row + n + r;
      if (i + 1 < knots.segments) jacobian(row + r, next) = -weights_[next] / scale_[r];
    }
  }
  return add_derivative_in_s(x, jacobian);
}

}  // namespace carnot::internal
