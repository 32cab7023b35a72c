// Places at a given distance, on an edge, a face or in a tetrahedron of configurations.
//
// On the simplex x + D s, with the columns of D from one corner to the others, m extremals from one
// point meet at the time R at unit speed where
//
//   q(R; p_i) = x + D s,     H(p_i) = 1/2,     i = 1 .. m,
//
// n m + m equations for the p_i and the m numbers s: a simplex of as many dimensions as there are
// extremals. On an edge that is a place of the sphere, on a face one of its seam, where two
// extremals are as short, and inside a tetrahedron one where three are. With J_i = dq(R)/dp_i and
// the velocity v_i at the start a step of Newton's method is
//
//   dp_i = J_i^-1 (D ds - r_i),     v_i J_i^-1 D ds = v_i J_i^-1 r_i - (H_i - 1/2),
//
// where r_i = q(R; p_i) - x - D s: m equations for ds.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

inline Eigen::VectorXd vector_of(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}
inline std::vector<double> numbers_of(const Eigen::VectorXd& x) {
  return {x.data(), x.data() + x.size()};
}

struct Simplex {
  std::vector<double> corner;  // x
  Eigen::MatrixXd sides;       // D, n x m
};

// What distances are measured by: the extremals' start, their time, and a size of each coordinate.
struct LevelProblem {
  const Dynamics& dynamics;
  const std::vector<double>& from;
  double length;           // R
  Eigen::VectorXd widths;  // of what is of the size 1
};

struct LevelPoint {
  std::vector<Eigen::VectorXd> p;  // of each extremal at the start
  Eigen::VectorXd s;
};

// Takes a guess to a solution, to round-off of the flows. False where Newton's method does not
// converge within a few sides of the simplex. Cost: m tangent flows a step, of three or four.
bool settle(const LevelProblem& problem, const Simplex& simplex, LevelPoint& point);

// Takes the momentum of an extremal that ends near `target` to the one that ends there.
bool settle_end(const LevelProblem& problem, const std::vector<double>& target, Eigen::VectorXd& p);

// An extremal, its end, and dp(0)/dq there.
struct NearExtremal {
  Eigen::VectorXd p;
  Eigen::MatrixXd inverse;  // empty where it is not known
  Eigen::VectorXd q;
};

// From an extremal to one of the same sheet to `to`, in steps that are as short as it takes.
// Nothing where a 32nd of the way is too long.
std::optional<Eigen::VectorXd> bring(const LevelProblem& problem,
                                     NearExtremal extremal,
                                     const Eigen::VectorXd& to);

// From extremals nearby, as many as the simplex has dimensions, to where they meet at the time R,
// by way of the place s if Newton's method does not get there at once.
std::optional<LevelPoint> lead(const LevelProblem& problem,
                               const Simplex& simplex,
                               const Eigen::VectorXd& s,
                               const std::vector<NearExtremal>& extremals);

// dp(0)/dq(R); empty where the flow fails.
Eigen::MatrixXd momentum_by_end(const LevelProblem& problem, const Eigen::VectorXd& p);

// H(p) - 1/2 at the start.
double excess_energy(const LevelProblem& problem, const Eigen::VectorXd& p);

}  // namespace carnot::internal
