#include "carnot/shooting/rays/first_conjugate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/illinois.h"

namespace carnot::internal {
namespace {

using RowMajor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMostSmall, kMostSmall>;

// A phase point and the 2n x n tangent there.
struct Node {
  double t = 0;
  std::vector<double> z;
  Eigen::MatrixXd columns;
  double value = 0;  // det X, which is smooth,
  double size = 0;   // and the product of the lengths of its rows, of which it is a part
};

double determinant(const Eigen::MatrixXd& x) {
  if (x.rows() == 3) {
    return x(0, 0) * (x(1, 1) * x(2, 2) - x(1, 2) * x(2, 1)) -
           x(0, 1) * (x(1, 0) * x(2, 2) - x(1, 2) * x(2, 0)) +
           x(0, 2) * (x(1, 0) * x(2, 1) - x(1, 1) * x(2, 0));
  }
  const Determinant det = determinant_of(x);
  return det.sign * std::exp(det.log_size);
}

// One step of the method. False when it fails.
bool advance(const Dynamics& dynamics, const Node& from, double t, Node& to) {
  const int n = dynamics.dof;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(2 * n, 2 * n);
  to.t = t;
  to.z = from.z;
  const std::span<double> rows(m.data(), static_cast<std::size_t>(m.size()));
  const StepPlan plan = StepPlan::equal(from.t, t - from.t, 1);
  if (!dynamics.tangent_flow(plan, to.z, rows).completed()) return false;
  to.columns.noalias() = m.lazyProduct(from.columns);
  to.value = determinant(to.columns.topRows(n));
  to.size = 1;
  for (int j = 0; j < n; ++j) to.size *= to.columns.row(j).norm();
  return std::isfinite(to.value);
}

// Where the sign changes between two nodes.
double locate(const Dynamics& dynamics, const Node& low, const Node& high) {
  constexpr double kEnough = 1e-14;  // relative
  Node middle;
  const auto value_at = [&](double t) {
    return advance(dynamics, low, t, middle) ? std::optional(middle.value) : std::nullopt;
  };
  return illinois(low.t, low.value, high.t, high.value, kEnough * high.t, value_at);
}

}  // namespace

double first_conjugate_time(const Ray& ray, double horizon) {
  constexpr double kRounding = 1e-13;  // of a determinant that vanishes along an abnormal extremal
  const Dynamics& dynamics = ray.dynamics();
  const int n = dynamics.dof;
  // How many steps are enough is found for stretches that double: most rays are conjugate early.
  constexpr double kFirst = 0.125;
  Node node{0, ray.start(), Eigen::MatrixXd::Zero(2 * n, n)};
  node.columns.bottomRows(n).setIdentity();
  double t = 0;
  for (double part = kFirst; part <= 1; part *= 2) {
    const double end = part * horizon;
    const double h = end / static_cast<double>(ray.enough_steps(end));
    const long count = std::max(1L, std::lround((end - t) / h));
    const double begin = t;
    for (long i = 1; i <= count; ++i) {
      Node next;
      t = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count);
      if (!advance(dynamics, node, t, next)) return std::numeric_limits<double>::quiet_NaN();
      if (std::abs(next.value) <= kRounding * next.size) continue;
      if (node.value * next.value < 0) return locate(dynamics, node, next);
      node = std::move(next);
    }
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace carnot::internal
