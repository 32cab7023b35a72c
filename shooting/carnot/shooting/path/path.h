// A discrete path on equidistant times, with what the midpoint transcription knows of it.
#pragma once

#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

// Nodes i = 0..intervals at times i T / intervals; row-major arrays.
struct Path {
  int intervals = 0;
  int dof = 0;
  std::vector<double> q;       // (intervals + 1) x n
  std::vector<double> lambda;  // intervals x k, of the midpoint rule
  std::vector<double> p;       // (intervals + 1) x n, discrete momenta; filled by a relaxation
  int rung = 0;                // of the ladder of masses (mass_ladder.h) that it is a path of

  [[nodiscard]] const double* configuration(int i) const { return q.data() + i * dof; }
  [[nodiscard]] double* configuration(int i) { return q.data() + i * dof; }
  // (q_i, q_{i+1}, lambda_i), the arguments of the discrete Lagrangian of interval i.
  void gather(int i, int multipliers, double* x) const;
  [[nodiscard]] const double* momentum(int i) const { return p.data() + i * dof; }
};

// Sets path.p from path.q and path.lambda: at each node the mean of what the intervals on both
// sides say, D2 F_d and -D1 F_d. They agree on a discrete extremal.
void fill_momenta(const Dynamics& dynamics, double h, Path& path);

// Whether no singularity of the coordinates parts two configurations, or one node of the path from
// the next. A grid steps over a singularity at little cost, and what it finds beyond has seldom to
// do with the scene. So a path that is in one chart is kept there. Geodesics that move one
// coordinate only may pass a singularity. They are found where the straight line between the ends
// passes it, too.
bool same_chart(const Dynamics& dynamics, const double* a, const double* b);
bool in_one_chart(const Dynamics& dynamics, const Path& path);

// Whether a path in one chart comes nearer to the end of that chart than the grid resolves. Then
// the chart function is below its values at both ends of the path, and it changes by a factor
// of 2.5 from one node to the next. (Measured: discrete extremals with a counterpart on finer grids
// stayed below 1.5, and the others were above 3.9.)
bool skims_chart_end(const Dynamics& dynamics, const Path& path);

// The action of the midpoint transcription, sum_i h L.
double discrete_action(const Dynamics& dynamics, double h, const Path& path);

}  // namespace carnot::internal
