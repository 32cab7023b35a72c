// The free vehicle on its circle as `carnot paper` runs it: midpoint rule, unit parameters, a = 1.
#pragma once

#include <vector>

#include "paper/paper_parts.h"
#include "paper/paper_separatrix.h"

namespace carnot::apps {

inline constexpr double kCircleStep = 0.02;

// (q, p) of theta = t, phi = t + pi/2 + perturbation, (x, y) = (cos t, sin t) at t = 0.
std::vector<double> circle_start(double perturbation = 0);

// delta - pi/2 with delta = phi - theta, at a row of a trajectory.
double circle_excess(const Trajectory& trajectory, std::size_t row);

// Of the motion from that on a circle, whichever: |(cos(delta), p_phi/(beta a) - 1)|.
double circle_distance(const Trajectory& trajectory, std::size_t row);

// Every node of the midpoint rule up to `time`.
Trajectory circle_run(PaperWork& work, double perturbation, double time);

}  // namespace carnot::apps
