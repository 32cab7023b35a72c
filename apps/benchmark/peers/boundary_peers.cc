#include "benchmark/peers/boundary_peers.h"

#include "benchmark/benchmark_clock.h"
#include "benchmark/peers/ipopt_run.h"
#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/search/momentum_starts.h"
#include "carnot/shooting/search/starts.h"

namespace carnot::apps {
namespace {

BoundaryTrial try_ipopt(const BoundaryValueProblem& problem, std::uint64_t seed, int i) {
  constexpr int kIntervals = 50;
  const double began = thread_seconds();
  internal::Start start = internal::make_start(problem, seed, i + 1, kIntervals);
  BoundaryTrial trial;
  const std::optional<double> action = solve_with_ipopt(problem, start.path.q);
  trial.solved = action.has_value();
  if (action) trial.action = *action;
  trial.seconds = thread_seconds() - began;
  return trial;
}

BoundaryTrial run_gsl(const BoundaryValueProblem& problem, std::uint64_t seed, int i) {
  constexpr long kSteps = 32;
  const double began = thread_seconds();
  std::vector<double> p0 = internal::momentum_start(problem, seed, i + 1);
  BoundaryTrial trial;
  if (solve_with_gsl(problem, p0)) {
    const auto extremal = internal::verify(problem,
                                           internal::knots_of(problem, p0, 1, kSteps),
                                           kSteps,
                                           GeodesicOptions{}.tolerance)
                              .extremal;
    trial.solved = extremal.has_value();
    if (extremal) trial.action = extremal->geodesic.action;
  }
  trial.seconds = thread_seconds() - began;
  return trial;
}

}  // namespace

std::vector<BoundarySolver> boundary_peers() {
  // The linear solver that Debian's Ipopt uses, MUMPS, is not made for threads.
  return {{"ipopt", BoundaryStart::kPath, true, false, false, try_ipopt},
          {"gsl-hybridsj", BoundaryStart::kMomentum, true, true, true, run_gsl}};
}

DirectSolver direct_peer() {
  return {"ipopt", [](const BoundaryValueProblem& problem, GridPath& path) {
            return path.u.empty() ? solve_with_ipopt(problem, path.q)
                                  : control_with_ipopt(problem, path);
          }};
}

}  // namespace carnot::apps
