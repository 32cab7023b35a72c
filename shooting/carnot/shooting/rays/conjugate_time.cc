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

// Of the scaled F: eigenvalues that are nearer to zero count as zero. On an abnormal extremal some
// of them stay there, but for the round-off of the flow, which was up to 1.3e-15 on 22 such
// extremals of seven scenes, up to ten natural lengths long.
constexpr double kRounding = 1e-14;
constexpr int kHalvings = 24;

// A phase point, and a basis of the plane there.
struct Node {
  double t = 0;
  std::vector<double> z;
  SmallMatrix x;
  SmallMatrix p;
};

// D F D with a diagonal D.
struct Form {
  SmallMatrix f;
  int negative = 0;  // so many of its eigenvalues
};

Form form_of(const SmallMatrix& f, const Eigen::VectorXd& scale) {
  Form form;
  form.f = scale.asDiagonal() * (0.5 * (f + f.transpose())) * scale.asDiagonal();
  form.negative = count_below(form.f, -kRounding);
  return form;
}

// How many eigenvalues are not told from zero.
int zeros_of(const Form& form) { return count_below(form.f, kRounding) - form.negative; }

struct Step {
  SmallMatrix before;  // F at its start, P'X,
  SmallMatrix after;   // and at its end
  SmallMatrix lift;    // A^-T P, and the rate of F is lift' H_pp lift
  Eigen::VectorXd scale;
};

// Makes the sizes of the terms of which the diagonal of F is the sum one. Directions that take many
// brackets move by a high power of the length only. With D their part of F is as far from round-off
// as the others, and dilations change nothing. Terms that are this small are round-off themselves.
Eigen::VectorXd scale_of(const SmallMatrix& x, const SmallMatrix& grown, const SmallMatrix& p) {
  constexpr double kLeast = 1e-24;
  const SmallMatrix size = p.cwiseAbs();
  const SmallMatrix terms = x.cwiseAbs() + SmallMatrix(grown.cwiseAbs()).lazyProduct(size);
  const Eigen::VectorXd sums = size.cwiseProduct(terms).colwise().sum();
  return sums.cwiseMax(kLeast * sums.maxCoeff()).cwiseSqrt().cwiseInverse();
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

std::span<double> entries(RowMajor& m) { return {m.data(), static_cast<std::size_t>(m.size())}; }

// One step of the method, and F over it.
Advance advance(const Dynamics& dynamics, const Node& from, double t, Node& to, Step& step) {
  const int n = dynamics.dof;
  RowMajor m(2 * n, 2 * n);
  to.t = t;
  to.z = from.z;
  const StepPlan plan = StepPlan::equal(from.t, t - from.t, 1);
  if (!dynamics.tangent_flow(plan, to.z, entries(m)).completed()) return Advance::kFailed;
  const SmallMatrix a = m.topLeftCorner(n, n);
  to.x = a.lazyProduct(from.x) + m.topRightCorner(n, n).lazyProduct(from.p);
  to.p =
      m.bottomLeftCorner(n, n).lazyProduct(from.x) + m.bottomRightCorner(n, n).lazyProduct(from.p);
  if (!to.x.allFinite() || !to.p.allFinite()) return Advance::kFailed;
  if (!stayed_regular(a)) return Advance::kTooLong;
  const SmallMatrix inverse = small_lu_inverse(a);
  const SmallMatrix grown = inverse.lazyProduct(m.topRightCorner(n, n));
  const SmallMatrix back = inverse.lazyProduct(to.x);
  const SmallMatrix transposed = from.p.transpose();
  step.before = transposed.lazyProduct(from.x);
  step.after = transposed.lazyProduct(back);
  step.lift = inverse.transpose().lazyProduct(from.p);
  step.scale = scale_of(from.x, grown, from.p);
  return Advance::kDone;
}

// The momenta that move something, orthonormal: all but those along Dh of holonomic constraints.
// For these F stays at zero.
SmallMatrix moving_momenta(const Dynamics& dynamics, const std::vector<double>& z) {
  const int n = dynamics.dof;
  if (dynamics.forced == 0) return SmallMatrix::Identity(n, n);
  RowMajor projector(2 * n, 2 * n);
  if (!dynamics.tangent_projector(0, z, entries(projector))) return SmallMatrix::Identity(n, n);
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
  Count(const Ray& ray, int order) : dynamics_(&ray.dynamics()), left_(order) {
    node_.z = ray.start();
    node_.p = moving_momenta(*dynamics_, node_.z);
    node_.x = SmallMatrix::Zero(dynamics_->dof, node_.p.cols());
    size_ = size_of(node_);
    end_ = {0, node_.z};
  }

  // Goes on to t, or to the time that is looked for: then that is `found`. False where it fails.
  bool go_to(double t, int halvings = kHalvings) {
    Node next;
    Step step;
    const Advance result = advance(*dynamics_, node_, t, next, step);
    if (result == Advance::kFailed) return false;
    if (result == Advance::kTooLong) {
      if (halvings == 0) return false;
      if (!go_to(0.5 * (node_.t + t), halvings - 1)) return false;
      return found || go_to(t, halvings - 1);
    }
    end_ = {t, next.z};
    const Form before = form_of(step.before, step.scale);
    const Form after = form_of(step.after, step.scale);
    const int passed = std::max(0, before.negative - after.negative);
    if (passed >= left_) {
      locate(step, before, after, std::move(next));
      return true;
    }
    left_ -= passed;
    node_ = std::move(next);
    renew_basis();
    return true;
  }

  [[nodiscard]] const Dynamics& dynamics() const { return *dynamics_; }
  // Where the last step ended, also if the time was found within it.
  struct End {
    double t = 0;
    std::vector<double> z;
  };
  [[nodiscard]] const End& end() const { return end_; }

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
  // The zero of the eigenvalue that has `left_` - 1 negative ones above it, in a step to the node
  // `end`, with D of the whole step. What stays at zero is below it as soon as it is positive.
  void locate(const Step& whole, const Form& before, const Form& after, Node end) {
    // Relative. What is left then is a step of Newton's method, and its square is round-off.
    constexpr double kNear = 1e-8;
    const int negative = before.negative - left_;  // those below it
    const int zero = std::min(zeros_of(before), zeros_of(after));
    const auto value_of = [&](const Form& form, const SmallMatrix& lift, const Node& at) {
      const SymmetricEigen eigen = symmetric_eigen(form.f);
      const int which = form.negative > negative ? negative : negative + zero;
      const Eigen::VectorXd w = lift * eigen.vectors.col(which).cwiseProduct(whole.scale);
      return ValueAndSlope{eigen.values[which], rate_along(w, at.z)};
    };
    const ValueAndSlope at_start = value_of(before, node_.p, node_);
    const ValueAndSlope at_end = value_of(after, whole.lift, end);
    const double t = end.t;
    ValueAndSlope at_last = at_end;
    Node last = std::move(end);
    Node middle;
    Step step;
    const auto value_at = [&](double at) -> std::optional<ValueAndSlope> {
      if (advance(*dynamics_, node_, at, middle, step) != Advance::kDone) return std::nullopt;
      std::swap(middle, last);
      at_last = value_of(form_of(step.after, whole.scale), step.lift, last);
      return at_last;
    };
    (void)bracketed_newton(node_.t, at_start, t, at_end, kNear * t, value_at);
    const double rest = -at_last.value / at_last.slope;
    const int n = dynamics_->dof;
    found = ConjugatePoint{last.t, {last.z.begin(), last.z.begin() + n}};
    if (!(std::abs(rest) <= kNear * t)) return;
    const Eigen::VectorXd velocity = motion_at(*dynamics_, last.z.data()).velocity;
    found->t += rest;
    for (int j = 0; j < n; ++j) found->q[j] += rest * velocity[j];
  }

  // Of an eigenvalue, at the phase point z: w' H_pp w, where w is its vector, lifted. H_pp w is the
  // velocity at (q, w), since H is quadratic in p.
  [[nodiscard]] double rate_along(const Eigen::VectorXd& w, const std::vector<double>& z) const {
    std::vector<double> at = z;
    std::copy(w.begin(), w.end(), at.begin() + dynamics_->dof);
    return w.dot(motion_at(*dynamics_, at.data()).velocity);
  }

  const Dynamics* dynamics_;
  int left_;
  Node node_;
  double size_ = 0;  // when its basis was made
  End end_;
};

// How many steps over `length` tangents need not to turn by more than some two radians in one.
// A straight extremal does not tell that: one step of a fraction of this length does. NaN where
// that fails.
double steps_of_tangents(const Dynamics& dynamics, std::vector<double> z, double length) {
  constexpr double kFraction = 1.0 / 512;
  // The radius is one by mean powers, which is less than the largest one. On rays of five scenes so
  // many steps are 0.83 to 1.03 of what two radians by sums of powers asked for.
  constexpr double kTurn = 1.6;
  const int n = dynamics.dof;
  RowMajor m(2 * n, 2 * n);
  const StepPlan plan = StepPlan::equal(0, kFraction * length, 1);
  if (!dynamics.tangent_flow(plan, z, entries(m)).completed()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  m.diagonal().array() -= 1;
  return spectral_radius(m) / (kFraction * kTurn);
}

// Goes on from `begin` for a length, or to the time that is looked for, in `steps` steps or in
// more, as many as are enough; whether they are may be known. False where it fails.
bool go_along(double begin, double length, bool enough, long& steps, Count& count) {
  for (;; steps = std::min(steps, kMostSteps)) {
    Count next = count;
    const StepPlan plan = StepPlan::equal(begin, length, steps);
    long done = 0;
    while (done < steps && !next.found && next.go_to(plan.time(done + 1))) ++done;
    const bool followed = next.found || done == steps;
    if (!followed && steps == kMostSteps) return false;
    if (!followed) {
      steps *= 2;
      continue;
    }
    const double t = next.end().t - begin;
    const long wanted =
        enough ? done : wanted_steps(count.dynamics(), count.end().z, t, done, next.end().z);
    if (wanted == done || steps == kMostSteps) {
      count = std::move(next);
      return true;
    }
    steps = std::max(steps + 1, steps * wanted / done);
  }
}

ConjugatePoint unknown() { return {std::numeric_limits<double>::quiet_NaN(), {}}; }

}  // namespace

ConjugatePoint conjugate_point(const Ray& ray, double horizon, int order) {
  // How many steps are enough is found for stretches that double: most rays are conjugate early.
  constexpr double kFirst = 0.125;
  const Dynamics& dynamics = ray.dynamics();
  Count count(ray, order);
  const double first = kFirst * horizon;
  const double least = kFirst * steps_of_tangents(dynamics, count.end().z, horizon);
  if (!(least < kMostSteps)) return unknown();
  const long fewest = std::max(1L, static_cast<long>(std::ceil(least)));
  // A flow alone tells how many are enough at first. Later on that is known but for surprises.
  long steps = follow(dynamics, count.end().z, first, fewest).steps;
  double begin = 0;
  double h = first / static_cast<double>(steps);
  for (double end = first; end <= horizon; end *= 2) {
    steps = std::clamp(std::lround((end - begin) / h), 1L, kMostSteps);
    if (!go_along(begin, end - begin, end == first, steps, count)) return unknown();
    if (count.found) return *count.found;
    h = (end - begin) / static_cast<double>(steps);
    begin = end;
  }
  return {std::numeric_limits<double>::infinity(), {}};
}

double conjugate_time(const Ray& ray, double horizon, int order) {
  return conjugate_point(ray, horizon, order).t;
}

}  // namespace carnot::internal
