#include "benchmark/peers/peers.h"

#include <algorithm>
#include <cmath>

#include "benchmark/peers/peer.h"

namespace carnot::apps {
namespace {

Contestant contestant(const BenchmarkProblem& problem, double tolerance, const Peer& peer) {
  Contestant made;
  made.method = peer.method;
  made.peer = true;
  made.automatic = true;
  made.step_or_tolerance = tolerance;
  made.run = [solve = peer.solve, start = problem.start] {
    BenchmarkEnd end;
    std::copy(start.begin(), start.end(), end.z.begin());
    const PeerEnd run = solve(end.z.data(), {});
    end.completed = run.completed;
    end.evaluations = static_cast<double>(run.evaluations);
    return end;
  };
  made.watch = [solve = peer.solve, problem] {
    BenchmarkWatch watch;
    std::vector<double> z = problem.start;
    const double energy = problem.energy(z.data());
    const PeerEnd run = solve(z.data(), [&](const double* node) {
      watch.energy_drift = std::max(watch.energy_drift, std::abs(problem.energy(node) - energy));
    });
    if (!run.completed) watch.message = "the library gave up at this tolerance";
    return watch;
  };
  return made;
}

}  // namespace

std::vector<Contestant> peer_contestants(const BenchmarkProblem& problem,
                                         const BenchmarkLadder& ladder) {
  constexpr int kPerDecade = 2;
  std::vector<Contestant> all;
  for (const auto& library : {gsl_peers, odeint_peers, cvode_peers, ida_peers}) {
    for (const double tolerance : ladder.local_tolerances(kPerDecade)) {
      for (const Peer& peer : library(problem.trajectory, tolerance)) {
        all.push_back(contestant(problem, tolerance, peer));
      }
    }
  }
  return all;
}

}  // namespace carnot::apps
