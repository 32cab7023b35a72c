#include "carnot/shooting/problem/dilation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/problem/scales.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The admissible directions as smooth vector fields, and their brackets.
class Fields {
 public:
  Fields(const Dynamics& dynamics, const std::vector<double>& q, double step)
      : dynamics_(dynamics), metric_(metric_at(q)), step_(step) {}

  [[nodiscard]] const MatrixXd& metric() const { return metric_; }
  [[nodiscard]] double length(const VectorXd& v) const { return std::sqrt(v.dot(metric_ * v)); }

  // A field is the velocity of the momentum e_i, or the bracket of such a velocity with a field.
  int add_velocity(int i) {
    fields_.push_back({i, kNone});
    return static_cast<int>(fields_.size()) - 1;
  }
  int add_bracket(int velocity, int field) {
    fields_.push_back({velocity, field});
    return static_cast<int>(fields_.size()) - 1;
  }
  [[nodiscard]] VectorXd value(int field, const VectorXd& q) const {
    const auto& [first, second] = fields_[field];
    if (second != kNone) return derivative(second, first, q) - derivative(first, second, q);
    const VectorXd p = VectorXd::Unit(q.size(), first);
    VectorXd velocity(q.size());
    std::vector<double> lambda(dynamics_.multipliers);
    dynamics_.evaluate(0, span_of(q), span_of(p), span_of(velocity), lambda);
    return velocity;
  }

 private:
  static constexpr int kNone = -1;
  struct Field {
    int first;
    int second;
  };

  // M + G'G. The metric M itself may be singular on what the constraints forbid. The result is NaN
  // where they cannot be evaluated.
  [[nodiscard]] MatrixXd metric_at(const std::vector<double>& q) const {
    const int n = dynamics_.dof;
    const int rows = n + dynamics_.transcribed + 1;
    const std::vector<double> rest(n, 0.0);
    std::vector<double> values(rows);
    RowMajor derivative(rows, 2 * n);
    if (!dynamics_.midpoint(q, rest, values, span_of(derivative))) {
      derivative.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    const MatrixXd terms = derivative.topRightCorner(rows - 1, n);
    return transposed_product(terms, terms);
  }
  // The derivative of a field along another one, by central differences.
  [[nodiscard]] VectorXd derivative(int of, int along, const VectorXd& q) const {
    const VectorXd direction = value(along, q);
    const double size = length(direction);
    if (!(size > 0)) return VectorXd::Zero(q.size());
    const VectorXd aside = step_ / size * direction;
    return size / (2 * step_) * (value(of, q + aside) - value(of, q - aside));
  }

  const Dynamics& dynamics_;
  MatrixXd metric_;
  double step_;
  std::vector<Field> fields_;
};

// A direction that may be new, and the field that it is the value of.
struct Direction {
  int field;
  VectorXd value;
};

std::vector<int> fields_of(const std::vector<Direction>& directions) {
  std::vector<int> fields;
  fields.reserve(directions.size());
  for (const Direction& direction : directions) fields.push_back(direction.field);
  return fields;
}

// A basis adapted to the flag, orthonormal in the metric, as far as it is known.
struct Flag {
  MatrixXd basis;
  std::vector<int> weights;

  [[nodiscard]] bool complete() const { return basis.cols() == basis.rows(); }

  // Adds those of `directions` that are new, largest first, and returns their fields.
  std::vector<int> extend(const Fields& fields, std::vector<Direction>& directions, int weight) {
    constexpr double kIndependent = 1e-3;  // part of a direction that is new, in units of S^-w
    std::vector<int> chosen;
    for (;;) {
      int best = -1;
      double largest = kIndependent;
      for (std::size_t i = 0; i < directions.size(); ++i) {
        VectorXd& rest = directions[i].value;
        rest -= basis * (basis.transpose() * (fields.metric() * rest));
        if (!(fields.length(rest) > largest)) continue;
        largest = fields.length(rest);
        best = static_cast<int>(i);
      }
      if (best < 0) return chosen;
      basis.conservativeResize(basis.rows(), basis.cols() + 1);
      basis.rightCols(1) = directions[best].value / largest;
      weights.push_back(weight);
      chosen.push_back(directions[best].field);
    }
  }
};

// The flag at the start, as far as brackets of four fields tell. S is `unit`.
Flag flag_at_start(const BoundaryValueProblem& problem, double unit, Fields& fields) {
  constexpr int kMostBrackets = 4;
  const int n = problem.dynamics.dof;
  const Eigen::Map<const VectorXd> from(problem.from.data(), n);
  std::vector<Direction> directions;
  for (int i = 0; i < n; ++i) {
    const int field = fields.add_velocity(i);
    directions.push_back({field, fields.value(field, from)});
  }
  Flag flag{MatrixXd(n, 0), {}};
  const std::vector<int> frame = flag.extend(fields, directions, 1);
  // The next brackets are those of all fields of this weight, new or not. A field may vanish here,
  // as it does where the frame loses rank, and still have brackets that do not vanish.
  std::vector<int> latest = fields_of(directions);
  double scale = 1;
  for (int weight = 2; weight <= kMostBrackets && !flag.complete(); ++weight) {
    scale *= unit;
    directions.clear();
    for (const int x : frame) {
      for (const int field : latest) {
        if (field == x) continue;
        const int bracket = fields.add_bracket(x, field);
        directions.push_back({bracket, scale * fields.value(bracket, from)});
      }
    }
    flag.extend(fields, directions, weight);
    latest = fields_of(directions);
  }
  return flag;
}

Fields fields_at_start(const BoundaryValueProblem& problem, double unit) {
  constexpr double kStep = 1e-2;  // of differences, in units of S
  return {problem.dynamics, problem.from, kStep * unit};
}

}  // namespace

BracketSpan bracket_span(const BoundaryValueProblem& problem) {
  constexpr double kFullRank = 1e-8;  // the directions are orthonormal in the metric
  const double unit = start_scales(problem).radian;
  Fields fields = fields_at_start(problem, unit);
  const MatrixXd basis = flag_at_start(problem, unit, fields).basis;
  BracketSpan span{problem.dynamics.dof, std::nullopt};
  if (!basis.allFinite() || !fields.metric().allFinite()) return span;
  span.dimension = static_cast<int>(basis.cols());
  if (span.dimension == problem.dynamics.dof - 1) {
    span.annihilator = kernel_line(basis.transpose(), kFullRank);
  }
  return span;
}

std::optional<Dilation> Dilation::at_start(const BoundaryValueProblem& problem) {
  Dilation dilation;
  dilation.from_ = problem.from;
  dilation.unit_ = start_scales(problem).radian;
  Fields fields = fields_at_start(problem, dilation.unit_);
  Flag flag = flag_at_start(problem, dilation.unit_, fields);
  if (!flag.complete() || !flag.basis.allFinite()) return std::nullopt;
  dilation.inverse_ = transposed_product(flag.basis, fields.metric());
  dilation.basis_ = std::move(flag.basis);
  dilation.weights_ = std::move(flag.weights);
  return dilation;
}

VectorXd Dilation::coordinates(const double* q) const {
  VectorXd moved(dof());
  for (int j = 0; j < dof(); ++j) moved[j] = q[j] - from_[j];
  return inverse_ * moved;
}

void Dilation::place(const VectorXd& y, double* q) const {
  const VectorXd moved = basis_ * y;
  for (int j = 0; j < dof(); ++j) q[j] = from_[j] + moved[j];
}

VectorXd Dilation::scaled(VectorXd y, double factor) const {
  for (int j = 0; j < dof(); ++j) y[j] *= std::pow(factor, weights_[j]);
  return y;
}

double Dilation::gauge(const VectorXd& y) const {
  double largest = 0;
  for (int j = 0; j < dof(); ++j) {
    largest = std::max(largest, std::pow(std::abs(y[j]) / unit_, 1.0 / weights_[j]));
  }
  return largest;
}

}  // namespace carnot::internal
