// The vehicle on V = -cos r as `carnot paper` runs it.
//
// The paper does not print its initial values. Most trajectories are trapped by V with lambda
// growing without bound; this is one on which lambda stays bounded: the vehicle drives in loops
// about the origin.
#pragma once

#include <array>
#include <vector>

#include "paper/paper_parts.h"

namespace carnot::apps {

inline constexpr const char* kCosineScene = "vehicle-cosine";
inline constexpr double kCosineStep = 0.05;
inline constexpr const char* kCosineStart = "q = (0.75, 0, 0.5, 2), u = (1.25, -1), lambda = 0";

// (q, p) of the vehicle of length 1, the front wheel driving and steering so fast, lambda = 0.
std::vector<double> vehicle_start(const Dynamics& dynamics,
                                  const std::array<double, 4>& q,
                                  double driving,
                                  double steering);
// That of kCosineStart, u = (driving, steering).
std::vector<double> cosine_start(const Dynamics& dynamics);

// The long run: lambda, constraints, energy; its figure.
void add_cosine_energy(PaperWork& work, PaperPart& part);

}  // namespace carnot::apps
