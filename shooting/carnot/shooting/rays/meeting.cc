#include "carnot/shooting/rays/meeting.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/illinois.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/units.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The rival may be one of a family, which leave the end where it is: singular values below this,
// relative, are those of the family. It is larger than kRankRoundOff, since near a solution they
// vanish only as the square of what is missing.
constexpr double kFamily = 1e-9;

constexpr double kConverged = 1e-11;  // relative; Newton's method goes on as long as it gains

// What the last equation asks for: by how much the rival is longer or, with a direction, how far
// its momentum is from that of the ray along it.
struct Demand {
  double value = 0;
  VectorXd direction{};
};

// The equations at a rival, linearised in the units of a short extremal.
class MeetingEquations {
 public:
  // False where a flow fails.
  bool evaluate(const Ray& ray, const Rival& rival, const Demand& demand, long steps) {
    const Dynamics& dynamics = ray.dynamics();
    const int n = dynamics.dof;
    const Ray other(dynamics, ray.from(), rival.p);
    const auto end = other.end(rival.t, steps);
    std::vector<double> own = ray.at(rival.t, steps);
    if (!end || own.empty() || !(rival.t > 0)) return false;
    for (std::size_t j = 0; j < rival.signs.size(); ++j) {
      own[j] *= rival.signs[j];
      own[n + j] *= rival.signs[j];
    }
    const BoundaryValueProblem problem(dynamics, ray.from(), ray.from(), rival.t);
    units_.emplace(problem, rival.p);
    const Motion first = motion_at(dynamics, other.start().data());
    const double speed = std::sqrt(2 * first.hamiltonian);
    VectorXd gap(n);
    double extent = 0;
    for (int j = 0; j < n; ++j) {
      gap[j] = end->z[j] - own[j] - rival.offset[j];
      extent = std::max(extent, std::abs(end->z[j]));
    }
    const VectorXd drift =
        motion_at(dynamics, end->z.data()).velocity - motion_at(dynamics, own.data()).velocity;
    jacobian_.resize(n + 1, n + 1);
    residual_.resize(n + 1);
    jacobian_.topLeftCorner(n, n) = units_->tangent(end->tangent).topRows(n);
    jacobian_.topRightCorner(n, 1) = units_->displacement(drift);
    const MatrixXd per_unit = units_->momenta(MatrixXd::Identity(n, n));
    residual_.head(n) = units_->displacement(gap);
    if (demand.direction.size() == 0) {
      jacobian_.bottomLeftCorner(1, n) = rival.t / speed * (first.velocity.transpose() * per_unit);
      jacobian_(n, n) = speed - 1;
      residual_[n] = rival.t * (speed - 1) - demand.value;
    } else {
      jacobian_.bottomLeftCorner(1, n) = demand.direction.transpose() * per_unit;
      jacobian_(n, n) = 0;
      residual_[n] = -demand.value;
      for (int j = 0; j < n; ++j) {
        residual_[n] += demand.direction[j] * (rival.p[j] - ray.p()[j]);
      }
    }
    const double size = units_->scaled() ? 1 : std::max(extent, rival.t);
    error_ =
        std::max(residual_.head(n).cwiseAbs().maxCoeff() / size, std::abs(residual_[n]) / rival.t);
    return std::isfinite(error_);
  }
  [[nodiscard]] double error() const { return error_; }

  // Newton's step: p1 and t.
  void step(Rival& rival) const { take_away(residual_, rival); }

  // What takes the equations back to zero when the ray's own end moves by `own`.
  void carry(const VectorXd& own, Rival& rival) const {
    VectorXd change = VectorXd::Zero(residual_.size());
    change.head(own.size()) = -units_->displacement(own);
    take_away(change, rival);
  }

 private:
  void take_away(const VectorXd& residual, Rival& rival) const {
    const auto n = residual.size() - 1;
    const VectorXd step = least_squares(jacobian_, residual, kFamily);
    const VectorXd dp = units_->momenta(step.head(n));
    for (Eigen::Index j = 0; j < n; ++j) rival.p[j] -= dp[j];
    rival.t -= step[n];
  }

  std::optional<Units> units_;
  MatrixXd jacobian_;
  VectorXd residual_;
  double error_ = std::numeric_limits<double>::infinity();
};

// Newton's method. The rival is moved only where it converges.
bool solve(const Ray& ray, const Demand& demand, long steps, Rival& rival) {
  constexpr int kMaxIterations = 9;
  constexpr double kSlower = 0.7;  // an error that falls by less is not falling
  MeetingEquations equations;
  Rival trial = rival;
  Rival best = rival;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxIterations; ++i) {
    if (!equations.evaluate(ray, trial, demand, steps)) break;
    const double error = equations.error();
    // The first step may go up: far along a curve it is the second one that converges.
    if (i > 1 && !(error < kSlower * least)) break;
    if (error < least) best = trial;
    least = std::min(least, error);
    equations.step(trial);
  }
  if (!(least <= kConverged)) return false;
  rival = best;
  return true;
}

double norm(const std::vector<double>& p) {
  double sum = 0;
  for (const double x : p) sum += x * x;
  return std::sqrt(sum);
}

// Whether one step of the continuation stayed near.
bool near(const Rival& a, const Rival& b) {
  constexpr double kFar = 0.5;
  std::vector<double> change = a.p;
  for (std::size_t j = 0; j < change.size(); ++j) change[j] -= b.p[j];
  return norm(change) <= kFar * std::max(norm(a.p), norm(b.p)) && std::abs(a.t - b.t) <= kFar * a.t;
}

}  // namespace

double excess_of(const Ray& ray, const Rival& rival) {
  return speed_of(ray.dynamics(), ray.from(), rival.p) - 1;
}

bool same_path(const Ray& ray, const Rival& rival, long steps) {
  constexpr double kSame = 1e-6;
  // Times without a symmetry: a path and its mirror image may cross half-way.
  constexpr double kTimes[] = {0.13, 0.43, 0.81};
  const int n = ray.dynamics().dof;
  const Ray other(ray.dynamics(), ray.from(), rival.p);
  double extent = 0;
  double apart = 0;
  for (const double part : kTimes) {
    const std::vector<double> a = ray.at(part * rival.t, steps);
    const std::vector<double> b = other.at(part * rival.t, steps);
    if (a.empty() || b.empty()) return false;
    for (int j = 0; j < n; ++j) {
      extent = std::max(extent, std::abs(a[j] - ray.from()[j]));
      apart = std::max(apart, std::abs(a[j] - b[j]));
    }
  }
  return apart <= kSame * extent;
}

bool polish_meeting(const Ray& ray, long steps, Rival& rival) {
  return solve(ray, {}, steps, rival);
}

std::optional<Rival> carried(const Ray& ray,
                             const Rival& rival,
                             const std::vector<double>& to,
                             long steps) {
  MeetingEquations equations;
  const auto own = ray.end(rival.t, steps);
  if (!own || !equations.evaluate(ray, rival, {}, steps)) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(to.size());
  VectorXd change(n);
  for (Eigen::Index j = 0; j < n; ++j) change[j] = to[j] - ray.p()[j];
  VectorXd moved = own->tangent.topRows(n) * change;
  for (Eigen::Index j = 0; j < std::ssize(rival.signs); ++j) moved[j] *= rival.signs[j];
  Rival next = rival;
  equations.carry(moved, next);
  return next;
}

namespace {

// The branch that leaves the ray at a conjugate time, point after point. Where a second family of
// neighbours is nearly conjugate, too, the branch bends towards that: so it is followed along
// itself, in the direction of its last two points.
class Branch {
 public:
  Branch(const Ray& ray, VectorXd direction, double conjugate_time)
      : ray_(&ray),
        direction_(std::move(direction)),
        rival_{ray.p(), std::vector<double>(ray.p().size(), 0.0), conjugate_time} {}

  // To the point that is further by `length` along the direction, which is then that of this step.
  // False, and nothing moves, where there is none nearby.
  bool advance(double length, long steps) {
    constexpr double kStraight = 0.9;  // the least cosine between two steps
    Rival next = rival_;
    if (!solve_at(length, steps, next)) return false;
    VectorXd step = momentum_of(next) - momentum_of(rival_);
    const double moved = step.norm();
    step /= moved;
    if (!(step.dot(direction_) > kStraight)) return false;
    direction_ = step;
    later_ = (next.t - rival_.t) / moved;
    length_ += moved;
    rival_ = next;
    return true;
  }
  // A point between this one and that which is further by `length`.
  [[nodiscard]] std::optional<Rival> at(double length, long steps) const {
    Rival point = rival_;
    if (!solve_at(length, steps, point)) return std::nullopt;
    return point;
  }
  [[nodiscard]] const Rival& rival() const { return rival_; }
  [[nodiscard]] double excess() const { return excess_of(*ray_, rival_); }
  [[nodiscard]] double length() const { return length_; }

 private:
  [[nodiscard]] static VectorXd momentum_of(const Rival& rival) {
    return Eigen::Map<const VectorXd>(rival.p.data(), static_cast<Eigen::Index>(rival.p.size()));
  }
  [[nodiscard]] bool solve_at(double length, long steps, Rival& point) const {
    const double here = direction_.dot(momentum_of(point) - momentum_of({ray_->p(), {}}));
    for (Eigen::Index j = 0; j < direction_.size(); ++j) point.p[j] += length * direction_[j];
    point.t += length * later_;
    return solve(*ray_, {here + length, direction_}, steps, point);
  }

  const Ray* ray_;
  VectorXd direction_;
  Rival rival_;
  double later_ = 0;   // dt by dp along the direction
  double length_ = 0;  // from the ray
};

// Between a point of the branch and the next one, which is further by `length`, the excess changes
// its sign: goes to where it is zero. The equations of a meeting would be badly conditioned there.
std::optional<Rival> find_zero(
    const Ray& ray, const Branch& branch, double length, double excess, long steps) {
  constexpr double kEnough = 1e-13;  // of what was passed
  std::optional<Rival> found;
  const auto excess_at = [&](double part) {
    found = branch.at(part * length, steps);
    return found ? std::optional(excess_of(ray, *found)) : std::nullopt;
  };
  illinois(0, branch.excess(), 1, excess, kEnough, excess_at);
  return found;
}

// On one side.
std::optional<Meeting> meet_neighbour(
    const Ray& ray, const VectorXd& direction, double conjugate_time, double expected, long steps) {
  constexpr double kBefore = 0.6;     // of what is expected
  constexpr double kFirst = 1e-3;     // of |p|: what is nearer is conjugate to 1e-6 of the time
  constexpr double kShortest = 1e-4;  // of |p|: steps are halved until then
  constexpr double kGrowth = 1.4;
  constexpr double kFarthest = 1;
  const double size = norm(ray.p());
  Branch branch(ray, direction, conjugate_time);
  double length = kFirst * size;
  while (branch.length() < kFarthest * size && length > kShortest * size) {
    Branch next = branch;
    if (!next.advance(length, steps)) {
      length *= 0.5;
      continue;
    }
    if (branch.length() > 0 && next.excess() * branch.excess() < 0) {
      auto zero = find_zero(ray, branch, length, next.excess(), steps);
      if (!zero) return std::nullopt;
      return Meeting{std::move(*zero), 0};
    }
    length *= kGrowth;
    if (branch.length() == 0) length = std::max(length, kBefore * expected - next.length());
    branch = next;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Meeting> meet_neighbours(const Ray& ray, double conjugate_time, double expected) {
  constexpr double kSameTime = 1e-10;
  constexpr double kEarliest = 0.9;  // of the conjugate time
  // What neighbours share magnifies the errors of the flow.
  const long steps = 2 * ray.enough_steps(conjugate_time);
  const auto end = ray.end(conjugate_time, steps);
  if (!end) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(ray.p().size());
  const VectorXd still = right_singular(end->tangent.topRows(n)).vectors.col(n - 1);
  std::optional<Meeting> first;
  double latest = (1 - kSameTime) * conjugate_time;
  for (const double side : {1.0, -1.0}) {
    const VectorXd direction = side * still;
    auto meeting = meet_neighbour(ray, direction, conjugate_time, expected, steps);
    if (!meeting && expected > 0)
      meeting = meet_neighbour(ray, direction, conjugate_time, 0, steps);
    if (!meeting || meeting->rival.t < kEarliest * conjugate_time) continue;
    if (!(meeting->rival.t < latest)) continue;
    latest = meeting->rival.t;
    first = std::move(meeting);
  }
  return first;
}

std::optional<Meeting> meet(const Ray& ray, Rival rival, long steps) {
  constexpr int kMaxSteps = 60;
  constexpr double kLeastPart = 1e-3;  // of what is left, in one step of the continuation
  double part = 1;
  bool arrived = false;
  for (int i = 0; i < kMaxSteps && !arrived && part > kLeastPart; ++i) {
    const double excess = rival.t * excess_of(ray, rival);
    Rival next = rival;
    if (solve(ray, {(1 - part) * excess}, steps, next) && near(rival, next)) {
      arrived = part == 1;
      rival = next;
      part = std::min(1.0, 2 * part);
    } else {
      part *= 0.5;
    }
  }
  if (!arrived || same_path(ray, rival, steps)) return std::nullopt;
  Meeting meeting{rival, 0};
  if (!polish_meeting(ray, 2 * steps, meeting.rival)) return std::nullopt;
  meeting.error = std::abs(meeting.rival.t - rival.t);
  return meeting;
}

}  // namespace carnot::internal
