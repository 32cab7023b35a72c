#include "carnot/shooting/rays/conjugate_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "carnot/shooting/linear/bracketed_newton.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Of |P| |X|: eigenvalues that are nearer to zero are not negative. On an abnormal extremal some of
// them stay at zero, but for the round-off of the flow.
constexpr double kRounding = 1e-11;
constexpr int kHalvings = 24;

// A phase point, and a basis of the plane there.
struct Node {
  double t = 0;
  std::vector<double> z;
  SmallMatrix x;
  SmallMatrix p;
};

// F at the end of a step, and how many of its eigenvalues count as negative.
struct Form {
  SmallMatrix f;
  int negative = 0;
  SmallMatrix lift;  // A^-T P, and dF/dt = lift' H_pp lift
};

Form form_of(const SmallMatrix& f, double size) {
  Form form;
  form.f = 0.5 * (f + f.transpose());
  form.negative = count_below(form.f, -kRounding * size);
  return form;
}

double determinant(const SmallMatrix& a) {
  if (a.rows() == 3) {  // the most frequent case, without a decomposition
    return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) -
           a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
           a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
  }
  const Determinant det = determinant_of(a);
  return det.sign * std::exp(det.log_size);
}

// Whether A has been regular throughout a step, with A = I at first. Where two eigenvalues have
// become negative at once det A is positive again, but det (I + A) / 2 is less than 1/4.
bool stayed_regular(const SmallMatrix& a) {
  constexpr double kRegular = 0.1;
  const SmallMatrix half = 0.5 * (a + SmallMatrix::Identity(a.rows(), a.cols()));
  return determinant(a) > kRegular && determinant(half) > 0.25;
}

enum class Advance { kDone, kTooLong, kFailed };

// One step of the method, and F over it.
Advance advance(const Dynamics& dynamics, const Node& from, double t, Node& to, Form& form) {
  const int n = dynamics.dof;
  RowMajor m(2 * n, 2 * n);
  to.t = t;
  to.z = from.z;
  const std::span<double> rows(m.data(), static_cast<std::size_t>(m.size()));
  const StepPlan plan = StepPlan::equal(from.t, t - from.t, 1);
  if (!dynamics.tangent_flow(plan, to.z, rows).completed()) return Advance::kFailed;
  const SmallMatrix a = m.topLeftCorner(n, n);
  to.x = a.lazyProduct(from.x) + m.topRightCorner(n, n).lazyProduct(from.p);
  to.p =
      m.bottomLeftCorner(n, n).lazyProduct(from.x) + m.bottomRightCorner(n, n).lazyProduct(from.p);
  if (!to.x.allFinite() || !to.p.allFinite()) return Advance::kFailed;
  if (!stayed_regular(a)) return Advance::kTooLong;
  const SmallMatrix inverse = small_lu_inverse(a);
  const SmallMatrix back = inverse.lazyProduct(to.x);
  form = form_of(from.p.transpose().lazyProduct(back), from.p.norm() * back.norm());
  form.lift = inverse.transpose().lazyProduct(from.p);
  return Advance::kDone;
}

// The momenta that move something, orthonormal: all but those along Dh of holonomic constraints.
// For these F stays at zero.
SmallMatrix moving_momenta(const Dynamics& dynamics, const std::vector<double>& z) {
  const int n = dynamics.dof;
  if (dynamics.forced == 0) return SmallMatrix::Identity(n, n);
  RowMajor projector(2 * n, 2 * n);
  const std::span<double> rows(projector.data(), static_cast<std::size_t>(projector.size()));
  if (!dynamics.tangent_projector(0, z, rows)) return SmallMatrix::Identity(n, n);
  return right_singular(projector.leftCols(n)).vectors.leftCols(n - dynamics.forced);
}

// |X|^2 + |P|^2
double size_of(const Node& node) { return node.x.squaredNorm() + node.p.squaredNorm(); }

// Makes the basis orthonormal, by Gram's and Schmidt's method, twice for round-off.
void orthonormalize(Node& node) {
  for (Eigen::Index k = 0; k < node.x.cols(); ++k) {
    for (int twice = 0; twice < 2; ++twice) {
      for (Eigen::Index j = 0; j < k; ++j) {
        const double inner = node.x.col(j).dot(node.x.col(k)) + node.p.col(j).dot(node.p.col(k));
        node.x.col(k) -= inner * node.x.col(j);
        node.p.col(k) -= inner * node.p.col(j);
      }
      const double norm = std::sqrt(node.x.col(k).squaredNorm() + node.p.col(k).squaredNorm());
      node.x.col(k) /= norm;
      node.p.col(k) /= norm;
    }
  }
}

class Count {
 public:
  Count(const Ray& ray, int order) : dynamics_(ray.dynamics()), left_(order) {
    node_.z = ray.start();
    node_.p = moving_momenta(dynamics_, node_.z);
    node_.x = SmallMatrix::Zero(dynamics_.dof, node_.p.cols());
    size_ = size_of(node_);
  }

  // Goes on to t, or to the time that is looked for: then that is `found`. False where it fails.
  bool go_to(double t, int halvings = kHalvings) {
    Node next;
    Form form;
    const Advance result = advance(dynamics_, node_, t, next, form);
    if (result == Advance::kFailed) return false;
    if (result == Advance::kTooLong) {
      if (halvings == 0) return false;
      if (!go_to(0.5 * (node_.t + t), halvings - 1)) return false;
      return found || go_to(t, halvings - 1);
    }
    const Form before =
        form_of(node_.p.transpose().lazyProduct(node_.x), node_.p.norm() * node_.x.norm());
    const int passed = std::max(0, before.negative - form.negative);
    if (passed >= left_) {
      locate(before, form, std::move(next));
      return true;
    }
    left_ -= passed;
    node_ = std::move(next);
    renew_basis();
    return true;
  }

  // The phase point that has been reached.
  [[nodiscard]] const std::vector<double>& z() const { return node_.z; }

  std::optional<ConjugatePoint> found;

 private:
  // Beside an unstable extremal, such as an abnormal one, all vectors of the basis turn to where
  // the flow grows, until round-off hides the others. Signs of F do not depend on the basis.
  void renew_basis() {
    constexpr double kGrown = 1e4;  // of the sum of squares
    if (size_of(node_) < kGrown * size_) return;
    orthonormalize(node_);
    size_ = size_of(node_);
  }
  // The zero of the eigenvalue that has `left_` - 1 negative ones above it, before the node `end`.
  void locate(const Form& before, const Form& after, Node end) {
    constexpr double kNear = 1e-8;  // relative
    const int which = before.negative - left_;
    const double t = end.t;
    Node last = std::move(end);
    Node middle;
    Form form;
    const auto value_at = [&](double at) -> std::optional<ValueAndSlope> {
      if (advance(dynamics_, node_, at, middle, form) != Advance::kDone) return std::nullopt;
      std::swap(middle, last);
      const SymmetricEigen eigen = symmetric_eigen(form.f);
      const Eigen::VectorXd w = form.lift * eigen.vectors.col(which);
      return ValueAndSlope{eigen.values[which], rate_along(w, last.z)};
    };
    (void)bracketed_newton(
        node_.t, value_of(before, which), t, value_of(after, which), kNear * t, value_at);
    found = ConjugatePoint{last.t, std::move(last.z)};
  }

  // Of the eigenvalues, ascending.
  [[nodiscard]] static double value_of(const Form& form, int which) {
    return symmetric_eigen(form.f).values[which];
  }

  // Of an eigenvalue, at the phase point z: w' H_pp w, where w is its vector, lifted. H_pp w is the
  // velocity at (q, w), since H is quadratic in p.
  [[nodiscard]] double rate_along(const Eigen::VectorXd& w, const std::vector<double>& z) const {
    std::vector<double> at = z;
    std::copy(w.begin(), w.end(), at.begin() + dynamics_.dof);
    return w.dot(motion_at(dynamics_, at.data()).velocity);
  }

  const Dynamics& dynamics_;
  int left_;
  Node node_;
  double size_ = 0;  // when its basis was made
};

}  // namespace

ConjugatePoint conjugate_point(const Ray& ray, double horizon, int order) {
  // How many steps are enough is found for stretches that double: most rays are conjugate early.
  constexpr double kFirst = 0.125;
  Count count(ray, order);
  double begin = 0;
  double h = horizon;  // was enough before
  for (double part = kFirst; part <= 1; part *= 2) {
    const double length = part * horizon - begin;
    const long fewest = std::max(1L, std::lround(length / h));
    const long steps = enough_steps(ray.dynamics(), count.z(), length, fewest);
    h = length / static_cast<double>(steps);
    for (long i = 1; i <= steps; ++i) {
      const double t = begin + length * static_cast<double>(i) / static_cast<double>(steps);
      if (!count.go_to(t)) return {std::numeric_limits<double>::quiet_NaN(), {}};
      if (count.found) return *count.found;
    }
    begin = part * horizon;
  }
  return {std::numeric_limits<double>::infinity(), {}};
}

double conjugate_time(const Ray& ray, double horizon, int order) {
  return conjugate_point(ray, horizon, order).t;
}

}  // namespace carnot::internal
