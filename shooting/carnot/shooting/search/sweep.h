// Near hits: extremals from random momenta that end close to the target.
//
// A relaxation finds minimisers. Extremals past a conjugate point are saddles of the action and
// need another route. So momenta are drawn at random, on energies between given bounds, and their
// flows are run side by side, in packs where the scene has them. Those that end nearest to the
// target become paths: the end is pulled to the target, and the pull is spread evenly over time.
// Newton's method (discrete_newton.h) does the rest.
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"

namespace carnot::internal {

struct SweepOptions {
  std::uint64_t seed = 0;
  int round = 0;       // different draws for different rounds
  int flows = 500;     // trajectories
  int keep = 40;       // near hits
  int intervals = 64;  // of the paths made
  // Kinetic energy, drawn uniformly between the two. Where both are zero, momenta keep the size
  // that they are drawn with.
  double lowest = 0;
  double highest = 0;
  std::vector<double> momentum_scale;  // n standard deviations, up to a common factor
};

// H(p) - H(0) at the start, which is quadratic in p.
double kinetic_energy(const BoundaryValueProblem& problem, const std::vector<double>& p);

// Draw number i: unknowns of the start (ends.h); none where there is no such momentum.
std::vector<double> draw(const BoundaryValueProblem& problem, const SweepOptions& options, int i);

// At most `keep` paths, nearest first; the same whatever the number of threads. Their momenta are
// those of the trajectories.
std::vector<Path> near_hits(const BoundaryValueProblem& problem,
                            const SweepOptions& options,
                            int threads);

}  // namespace carnot::internal
