// An extremal from a point at unit speed, told by its momentum there.
//
// Where H is quadratic in p, c p at the start runs through the same curve c times as fast. So all
// is done at speed 1, H = 1/2, and time is length.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// H, and the velocity, at a phase point.
struct Motion {
  double hamiltonian = 0;
  Eigen::VectorXd velocity;
};
Motion motion_at(const Dynamics& dynamics, const double* z);

// sqrt(2 H) at the start.
double speed_of(const Dynamics& dynamics,
                const std::vector<double>& from,
                const std::vector<double>& p);

// The same, of what is asked by a user. Throws std::invalid_argument where lengths are wrong,
// numbers are not finite, H is not quadratic in p or depends on time, and where the momentum moves
// nothing.
double validated_speed(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const std::vector<double>& p);

// Where an extremal is at a time, and how that depends on its momentum at the start.
struct RayEnd {
  std::vector<double> z;    // (q, p)
  Eigen::MatrixXd tangent;  // 2n x n, d(q, p)/dp(0)
};

// No ray is followed with more steps than this, and none from its start with fewer than that.
inline constexpr long kMostSteps = 1L << 14;
inline constexpr long kFewestSteps = 8;

// How many steps from z over a time t are to be tried next, where `end` is where so many of them
// lead, and empty where they fail: as many, if these are enough. Half as many have 2^order times
// the error. So they end elsewhere by as many times the round-off, or nearer, if that is what is
// left; if not, the difference tells how many are missing. Cost: a flow of half as many steps.
long wanted_steps(const Dynamics& dynamics,
                  const std::vector<double>& z,
                  double t,
                  long steps,
                  const std::vector<double>& end);

// Where z is led in a time t, in so many steps, `fewest` or more, that what is left is round-off.
struct Followed {
  long steps = 0;
  std::vector<double> z;  // empty where the flow fails
};
// Cost: flows of 3/2 of the steps where `fewest` are enough, and of up to 7/2 of them otherwise.
Followed follow(const Dynamics& dynamics, const std::vector<double>& z, double t, long fewest);

class Ray {
 public:
  // With the momentum p at the start; keeps a reference to the dynamics.
  Ray(const Dynamics& dynamics, std::vector<double> from, std::vector<double> p)
      : dynamics_(&dynamics), from_(std::move(from)), p_(std::move(p)) {}

  [[nodiscard]] const Dynamics& dynamics() const { return *dynamics_; }
  [[nodiscard]] const std::vector<double>& from() const { return from_; }
  [[nodiscard]] const std::vector<double>& p() const { return p_; }
  [[nodiscard]] std::vector<double> start() const;

  // The phase point at time t; empty where the flow fails.
  [[nodiscard]] std::vector<double> at(double t, long steps) const;
  [[nodiscard]] std::optional<RayEnd> end(double t, long steps) const;
  // From the start to t.
  [[nodiscard]] Followed follow(double t, long fewest = kFewestSteps) const;
  [[nodiscard]] long enough_steps(double t) const { return follow(t).steps; }
  // From the start to where the ray is at time t, in that time.
  [[nodiscard]] BoundaryValueProblem problem(double t, long steps) const;

 private:
  const Dynamics* dynamics_;
  std::vector<double> from_;
  std::vector<double> p_;
};

}  // namespace carnot::internal
