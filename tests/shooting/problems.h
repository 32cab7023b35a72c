// Boundary-value problems that several tests use. The scenes are those of the program.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::test {

// The vehicle with alpha = beta = length = 1, T = 1.
BoundaryValueProblem vehicle(std::vector<double> from, std::vector<double> to, double time = 1);
BoundaryValueProblem sideways();        // (0, 0, 0, 0) to (0, 1, 0, 0)
BoundaryValueProblem straight_ahead();  // (0, 0, 0, 0) to (1, 0, 0, 0)
// The same scene with other parameters.
BoundaryValueProblem long_vehicle(std::vector<double> from, std::vector<double> to, double length);
// alpha = .1, beta = .02, length = 2.5, from the origin.
BoundaryValueProblem stiff_vehicle(std::vector<double> to);

// alpha = length = 1, from the origin.
BoundaryValueProblem light_steering(std::vector<double> to, double beta);
// A car with a wheelbase of 2.7 whose body and steering are light, from the origin: inertias of
// 0.05 and 0.002.
BoundaryValueProblem light_car(std::vector<double> to);

BoundaryValueProblem vehicle_cosine(std::vector<double> from, std::vector<double> to, double time);
BoundaryValueProblem heisenberg_group(std::vector<double> to, double time = 1);  // from the origin
BoundaryValueProblem martinet(std::vector<double> to);                           // the same
BoundaryValueProblem engel(std::vector<double> to);                              // the same
BoundaryValueProblem falling_cat(std::vector<double> to);                        // the same
BoundaryValueProblem unicycle(std::vector<double> from, std::vector<double> to);
BoundaryValueProblem grushin(std::vector<double> from, std::vector<double> to);
BoundaryValueProblem bicycle(std::vector<double> to);  // from the origin; singular at delta = pi/2
BoundaryValueProblem satellite(std::vector<double> to);  // the same; at theta = pi/2
// By quaternions, from the attitude 1, in (0, 0) for the ball.
BoundaryValueProblem satellite_quaternion(std::vector<double> to);
BoundaryValueProblem plate_ball_quaternion(std::vector<double> to);

// Two equal springs, no constraint: q'' = -q. Every extremal is conjugate, doubly, at t = pi.
BoundaryValueProblem oscillator(std::vector<double> from, std::vector<double> to, double time);

// q'' = -sin q.
BoundaryValueProblem pendulum(double from, double to, double time);

// The vehicle with alpha = beta = length = 1 where a length is told in another unit, so many of
// which are 1.
Dynamics vehicle_in_units(double lengths);
// The vehicle with beta = length = 1.
Dynamics vehicle_with_alpha(double alpha);

// The midpoint rule on the vehicle.
Dynamics vehicle_midpoint();

// RATTLE on two masses that a rod joins.
Dynamics rod_skate_rattle();

}  // namespace carnot::test
