// The sizes of a problem in its own terms, so that it can be put without units.
//
// Coordinates q = u q~, time t = tau t~, action S = a S~. With these momenta are in units of a/u
// and H in units of a/tau, and the problem says the same in whatever units its author writes.
//
//   tau   T.
//   u     1 for an angle, and for all coordinates where holonomic constraints tie them together.
//         Let s be what one radian is worth: s^2 is the mean of M_jj over the angles that have
//         mass. Where none has, it is that of 1 / (d2H/dp_j^2), the least within u of the ends.
//         Then u = s / sqrt(M_jj) for other coordinates that have mass, such as the length of a
//         wheelbase; u = s max sqrt(d2H/dp_j^2) near the ends for those that have none, which is
//         how far they go on an extremal of length s. The latter holds for all coordinates where a
//         control tells velocities. Without any angle s is such that the ends are 2 u apart: so a
//         short problem of a nilpotent structure is its dilation (dilation.h).
//   a     s^2 / tau.
//
// Scenes without a transcription have no metric. There u is how far apart the ends are or, where it
// is more, what the drift and the controls do with as much effort as the problem asks for
// (reach.h), and a is that effort.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

struct NaturalScales {
  std::vector<double> q;            // u of each coordinate
  std::vector<double> rows;         // of each row of the transcription's constraints, times 1/u
  std::vector<double> multipliers;  // of lambda
  double time = 1;
  double action = 1;

  // Of what is made of these.
  [[nodiscard]] double momentum(int j) const { return action / q[j]; }
  [[nodiscard]] double energy() const { return action / time; }
  // Of the integral of sqrt(v'M v), since v'M v is an energy.
  [[nodiscard]] double length() const;
  // Those that lead back.
  [[nodiscard]] NaturalScales inverse() const;
  // Whether all are one.
  [[nodiscard]] bool trivial() const;
};

// Cost: some hundred evaluations of the scene.
NaturalScales natural_scales(const BoundaryValueProblem& problem);

}  // namespace carnot::internal
