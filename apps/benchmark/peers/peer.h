// Other people's integrators on a benchmark trajectory, one function for each library.
//
// All are given the same right-hand side, benchmark_rates.h, and a tolerance, taken as absolute and
// relative. What a library allocates is made once and kept: a run only starts it afresh.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmark/benchmark_contest.h"

namespace carnot::apps {

struct PeerEnd {
  bool completed = false;
  long evaluations = 0;  // of the right-hand side, or of the residual
};

// Told (q, p) after each step; empty: nobody watches.
using PeerObserver = std::function<void(const double* z)>;

struct Peer {
  std::string method;
  // Advances z = (q, p) in place over the duration of the trajectory.
  std::function<PeerEnd(double* z, const PeerObserver& observe)> solve;
};

// As libraries have no common limit: a run that takes more has failed.
inline constexpr long kMostPeerSteps = 1000000;

std::vector<Peer> gsl_peers(const BenchmarkTrajectory& trajectory, double tolerance);
std::vector<Peer> odeint_peers(const BenchmarkTrajectory& trajectory, double tolerance);
std::vector<Peer> cvode_peers(const BenchmarkTrajectory& trajectory, double tolerance);
std::vector<Peer> ida_peers(const BenchmarkTrajectory& trajectory, double tolerance);

}  // namespace carnot::apps
