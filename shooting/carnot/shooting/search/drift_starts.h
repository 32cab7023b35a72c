// Starts of the search for scenes without a transcription of their own: drift, Lagrangians, and
// whatever else is no least-squares problem.
//
// Two families, because either alone misses the least of some problems:
//
//   scaled drift   With H_d of hamiltonian_terms.h the drift's own motion at d times its speed,
//                  without momentum, is an extremal that ends at phi_d. Where phi_d is near the
//                  target (about once per revolution), d is carried to 1 and the end to the target,
//                  together, by Newton's method on the grid.
//   actuated       A random path: the straight line, or drift from the start blended with drift to
//                  the target, with wiggles. Fictitious controls on all coordinates make any path
//                  admissible (action_descent.h). The method of multipliers takes them back.
//
// The scaled drift degenerates where the start is an equilibrium, and random paths seldom wind the
// right number of times.
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/problem/reach.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/search/relaxed_start.h"

namespace carnot::internal {

class DriftStarts {
 public:
  // Follows the drift once. Keeps a reference to the problem.
  DriftStarts(const BoundaryValueProblem& problem, std::uint64_t seed);

  // Start i of the sequence, a discrete extremal where it is found.
  [[nodiscard]] RelaxedStart start(int i, int intervals, const Stop& stop = {}) const;
  // So many intervals follow the drift: a multiple of 8.
  [[nodiscard]] int intervals() const { return intervals_; }
  // How many starts of the first family there are, the nearest first; they come before all others.
  [[nodiscard]] int scaled() const { return static_cast<int>(scales_.size()); }
  // How many starts of the second family are worth their time: fewer on long grids, where they
  // seldom wind the right number of times.
  [[nodiscard]] int actuated() const;

 private:
  void set_action();
  void scan_scales();
  [[nodiscard]] RelaxedStart scaled_start(double d, int intervals, const Stop& stop) const;
  [[nodiscard]] RelaxedStart actuated_start(int i, int intervals, const Stop& stop) const;
  [[nodiscard]] Path random_path(int i, int intervals, double& relaxation) const;

  const BoundaryValueProblem& problem_;
  std::uint64_t seed_;
  Reach reach_;
  int intervals_ = 0;
  double action_ = 0;           // of the straight line, by fictitious controls alone
  std::vector<double> scales_;  // d with phi_d near the target
};

}  // namespace carnot::internal
