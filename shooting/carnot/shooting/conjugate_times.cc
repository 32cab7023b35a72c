#include "carnot/shooting/conjugate_times.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

namespace carnot {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double kTurn = 2 * std::numbers::pi;

// What W says of a plane.
struct Phases {
  MatrixXcd w;
  double sum = 0;      // of the phases in [0, 2 pi)
  double nearest = 0;  // smallest distance of an eigenvalue from 1
};

Phases phases_of(const MatrixXd& plane) {
  const auto n = plane.cols();
  const std::complex<double> i(0, 1);
  const MatrixXcd x = plane.topRows(n).cast<std::complex<double>>();
  const MatrixXcd p = plane.bottomRows(n).cast<std::complex<double>>();
  Phases phases;
  phases.w = (p + i * x) * (p - i * x).partialPivLu().inverse();
  phases.nearest = 2;
  const Eigen::ComplexEigenSolver<MatrixXcd> solver(phases.w, false);
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::complex<double> value = solver.eigenvalues()[j];
    const double theta = std::arg(value);
    phases.sum += theta < 0 ? theta + kTurn : theta;
    phases.nearest = std::min(phases.nearest, std::abs(value - 1.0));
  }
  return phases;
}

// A phase point and the plane over it, orthonormal columns of (S^-1 X; S'P).
struct Frame {
  double t = 0;
  std::vector<double> z;
  MatrixXd plane;
  double phi = 0;  // continuous argument of det W
  Phases phases;
};

// Coordinates in which the plane before half way along the extremal is far from both axes: with
// X P^-1 = V diag(a) V' there, S = V diag(|a|^(1/2)) V'. Without it all phases of a problem whose
// directions move q by very different amounts would hide near zero.
MatrixXd balance(const MatrixXd& x, const MatrixXd& p) {
  constexpr double kSmallest = 1e-14;  // relative; smaller ones are round-off
  const MatrixXd ratio = x * p.partialPivLu().inverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(0.5 * (ratio + ratio.transpose()));
  Eigen::VectorXd root = solver.eigenvalues().cwiseAbs();
  root = root.cwiseMax(kSmallest * root.maxCoeff()).cwiseSqrt();
  return solver.eigenvectors() * root.asDiagonal() * solver.eigenvectors().transpose();
}

class Planes {
 public:
  Planes(const Segment& segment, const MatrixXd& s)
      : segment_(segment),
        s_(s),
        inverse_(s.inverse()),
        doubt_(kRoundOff * s_.norm() * inverse_.norm()) {}

  // The frame at time t, in as many steps of the method as det W needs to be followed. False when
  // a step fails or W turns too fast.
  [[nodiscard]] bool advance(const Frame& from, double t, Frame& to, int halvings = 10) const {
    if (!step(from, t, to)) return false;
    if (std::abs(to.phi - from.phi) < kLargestTurn) return true;
    Frame middle;
    return halvings > 0 && advance(from, 0.5 * (from.t + t), middle, halvings - 1) &&
           advance(middle, t, to, halvings - 1);
  }

  // N at a frame, as a real number that is near an integer.
  [[nodiscard]] static double count(const Frame& frame) {
    return (frame.phi - frame.phases.sum) / kTurn;
  }
  // A phase so near to zero that round-off may have put it on the wrong side.
  [[nodiscard]] bool ambiguous(const Frame& frame) const { return frame.phases.nearest < doubt_; }

  // The time in (a.t, t] at which the count first exceeds `target`, by bisection.
  [[nodiscard]] double locate(const Frame& a, double t, double target) const {
    double low = a.t;
    double high = t;
    Frame middle;
    constexpr int kBisections = 60;
    for (int i = 0; i < kBisections && high - low > kPrecision * high; ++i) {
      const double centre = 0.5 * (low + high);
      if (!advance(a, centre, middle)) break;
      (count(middle) > target + 0.5 ? high : low) = centre;
    }
    return 0.5 * (low + high);
  }

 private:
  [[nodiscard]] bool step(const Frame& from, double t, Frame& to) const {
    const int n = segment_.dof;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(2 * n, 2 * n);
    to.t = t;
    to.z = from.z;
    const StepPlan plan = StepPlan::equal(from.t, t - from.t, 1);
    if (!segment_.tangent_flow(plan, to.z.data(), m.data()).completed()) return false;
    MatrixXd carried = from.plane;
    carried.topRows(n) = s_ * carried.topRows(n);
    carried.bottomRows(n) = inverse_ * carried.bottomRows(n);
    carried = m * carried;
    carried.topRows(n) = inverse_ * carried.topRows(n);
    carried.bottomRows(n) = s_ * carried.bottomRows(n);
    const Eigen::HouseholderQR<MatrixXd> qr(carried);
    to.plane = qr.householderQ() * MatrixXd::Identity(2 * n, n);
    to.phases = phases_of(to.plane);
    const std::complex<double> turned = (to.phases.w * from.phases.w.adjoint()).determinant();
    to.phi = from.phi + std::arg(turned);
    return true;
  }

  static constexpr double kLargestTurn = 0.8;  // of det W in one step; 2 pi more would go unseen
  static constexpr double kRoundOff = 1e-14;   // of a plane, before S magnifies it
  static constexpr double kPrecision = 1e-13;

  const Segment& segment_;
  MatrixXd s_;
  MatrixXd inverse_;
  double doubt_;
};

// balance() somewhat before T/2, where symmetric extremals have nothing special.
std::optional<MatrixXd> before_half(const BoundaryValueProblem& problem,
                                    const Knots& knots,
                                    long steps) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int n = problem.segment.dof;
  constexpr double kFraction = 0.43;
  MatrixXd product = MatrixXd::Identity(2 * n, 2 * n);
  const int last = knots.segments == 1 ? 1 : std::max(1, 3 * knots.segments / 8);
  for (int i = 0; i < last; ++i) {
    StepPlan plan = knot_plan(problem, knots.segments, i, steps);
    if (knots.segments == 1) {
      plan = StepPlan::equal(0, kFraction * problem.time, std::max(1L, plan.count / 2));
    }
    std::vector<double> z(knots.at(i), knots.at(i) + 2 * n);
    RowMajor m(2 * n, 2 * n);
    if (!problem.segment.tangent_flow(plan, z.data(), m.data()).completed()) return std::nullopt;
    product = m * product;
  }
  const MatrixXd s = balance(product.topRightCorner(n, n), product.bottomRightCorner(n, n));
  if (!s.allFinite()) return std::nullopt;
  return s;
}

// One pass at a given number of steps.
ConjugateTimes follow(const BoundaryValueProblem& problem, const Knots& knots, long steps) {
  const int n = problem.segment.dof;
  Frame frame{0, {knots.at(0), knots.at(0) + 2 * n}, MatrixXd::Zero(2 * n, n), 0, {}};
  frame.plane.bottomRows(n).setIdentity();
  frame.phases = phases_of(frame.plane);
  const std::optional<MatrixXd> s = before_half(problem, knots, steps);
  if (!s) return {};
  const Planes planes(problem.segment, *s);
  Frame clear = frame;  // the last frame whose count is beyond doubt
  ConjugateTimes result;
  int counted = 0;
  const long per_segment = std::max(1L, (steps + knots.segments - 1) / knots.segments);
  for (long i = 1; i <= per_segment * knots.segments; ++i) {
    const double t =
        problem.time * static_cast<double>(i) / static_cast<double>(per_segment * knots.segments);
    Frame next;
    if (!planes.advance(frame, t, next)) return {};
    if (i % per_segment == 0) {
      const double* knot = knots.at(static_cast<int>(i / per_segment));
      next.z.assign(knot, knot + 2 * n);
    }
    frame = next;
    if (planes.ambiguous(frame)) continue;
    const int count = static_cast<int>(std::lround(Planes::count(frame)));
    for (; counted < count; ++counted) {
      result.times.push_back(planes.locate(clear, frame.t, counted));
    }
    if (count < counted) return {};
    clear = frame;
  }
  if (clear.t != frame.t) return {};
  result.known = true;
  return result;
}

}  // namespace

ConjugateTimes conjugate_times(const BoundaryValueProblem& problem,
                               const Knots& knots,
                               long steps) {
  // A phase that makes a whole turn within one step goes unseen: two passes must agree.
  constexpr int kDoublings = 4;
  ConjugateTimes coarse = follow(problem, knots, steps);
  for (int i = 0; i < kDoublings; ++i) {
    steps *= 2;
    ConjugateTimes fine = follow(problem, knots, steps);
    if (coarse.known && fine.known && coarse.times.size() == fine.times.size()) return fine;
    coarse = std::move(fine);
  }
  return {};
}

}  // namespace carnot
