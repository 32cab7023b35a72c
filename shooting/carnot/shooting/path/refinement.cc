#include "carnot/shooting/path/refinement.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/homotopy.h"
#include "carnot/shooting/path/relaxation.h"

namespace carnot::internal {
namespace {

// Largest change of the momenta at common nodes, relative to the largest momentum.
double change_of(const Path& coarse, const Path& fine) {
  double change = 0;
  double largest = 0;
  for (int i = 0; i <= coarse.intervals; ++i) {
    for (int j = 0; j < coarse.dof; ++j) {
      const double p = fine.momentum(2 * i)[j];
      change = std::max(change, std::abs(p - coarse.momentum(i)[j]));
      largest = std::max(largest, std::abs(p));
    }
  }
  return largest > 0 ? change / largest : 0;
}

Path extrapolated(const Path& coarse, const Path& fine) {
  Path path = coarse;
  for (int i = 0; i <= coarse.intervals; ++i) {
    for (int j = 0; j < coarse.dof; ++j) {
      path.configuration(i)[j] +=
          4.0 / 3 * (fine.configuration(2 * i)[j] - coarse.configuration(i)[j]);
      path.p[i * coarse.dof + j] += 4.0 / 3 * (fine.momentum(2 * i)[j] - coarse.momentum(i)[j]);
    }
  }
  return path;
}

// Newton's method with what its equations leave at the start taken back step by step. It reaches
// further: a long way, on which the coarse grid is late by a part of a revolution.
bool carried(const BoundaryValueProblem& problem, const Stop& stop, Path& path) {
  constexpr double kOnTheWay = 1e-5;  // tolerance of the solutions on the way
  const std::vector<double> residual = residual_of(problem, path);
  HomotopyOptions homotopy;
  homotopy.stop = stop;
  const auto correct = [&](double s, Path& trial) {
    DiscreteNewtonOptions newton;
    newton.max_iterations = 8;
    newton.stop = stop;
    newton.most_damped = 2;
    newton.residual = &residual;
    newton.residual_share = 1 - s;
    if (s < 1) newton.tolerance = kOnTheWay;
    return tighten(problem, newton, trial).converged;
  };
  return follow(homotopy, correct, path);
}

// Takes the path of a coarser grid down from a rung: first there, on its own grid, then while the
// masses fall. Of 40 random targets of a vehicle with light steering (beta from 1e-4 to 0.1) to
// which all starts began at the top of the ladder, eight were not solved without this, and one with
// it.
bool lightened(const MassLadder& ladder, int rung, const Stop& stop, Path& path) {
  DiscreteNewtonOptions newton;
  newton.max_iterations = 40;
  newton.stop = stop;
  if (!tighten(ladder.on(rung), newton, path).converged) return false;
  newton.max_iterations = 10;
  newton.most_damped = 2;
  HomotopyOptions homotopy;
  homotopy.first_step = 0.25;
  homotopy.most_steps = 40;
  homotopy.stop = stop;
  const auto correct = [&](double s, Path& trial) {
    return tighten(ladder.below(rung, s), newton, trial).converged;
  };
  return follow(homotopy, correct, path);
}

// The discrete extremal near `coarse` with twice as many intervals, one rung down: by Newton's
// method or, where the coarse one is too far away for it, step by step or by relaxing once more.
std::optional<Path> finer(const MassLadder& ladder, const Stop& stop, const Path& coarse) {
  constexpr int kMostRelaxed = 128;
  constexpr int kMostCarried = 256;
  const BoundaryValueProblem& problem = ladder.on(std::max(0, coarse.rung - 1));
  DiscreteNewtonOptions newton;
  newton.max_iterations = 40;
  newton.stop = stop;
  const bool walled = in_one_chart(problem.dynamics, coarse);
  Path path = halved(coarse);
  if (walled && !in_one_chart(problem.dynamics, path)) return std::nullopt;
  if (tighten(problem, newton, path).converged) return path;
  if (coarse.rung > 0) {
    path = halved(coarse);
    if (lightened(ladder, coarse.rung, stop, path)) return path;
  }
  // Of a car with a light body and light steering (a wheelbase of 2.7, inertias of 0.05 and 0.002)
  // 4 of 25 random targets are not solved, and 9 without this; the searches take a tenth more time.
  // It carries 6 of 10 paths on to 256 intervals, and 1 of 20 beyond, where it takes twice the
  // time.
  const bool carries = path.intervals > kMostRelaxed && path.intervals <= kMostCarried;
  if (carries || !problem.dynamics.has_transcription()) {
    path = halved(coarse);
    return carried(problem, stop, path) ? std::optional(path) : std::nullopt;
  }
  if (path.intervals > kMostRelaxed || stop.reached()) return std::nullopt;
  RelaxationOptions relaxation;
  relaxation.penalty = 100;  // keeps the path near the constraints that it nearly satisfies
  path = halved(coarse);
  relax(problem, relaxation, path);
  if (tighten(problem, newton, path).converged) return path;
  return std::nullopt;
}

}  // namespace

Path halved(const Path& path) {
  const int n = path.dof;
  const int last = path.intervals;
  const int k = last > 0 ? static_cast<int>(path.lambda.size()) / last : 0;
  Path fine;
  fine.intervals = 2 * last;
  fine.dof = n;
  fine.rung = std::max(0, path.rung - 1);
  fine.q.resize(static_cast<std::size_t>(fine.intervals + 1) * n);
  fine.lambda.resize(static_cast<std::size_t>(fine.intervals) * k);
  for (int i = 0; i <= last; ++i) {
    std::copy(path.configuration(i), path.configuration(i) + n, fine.configuration(2 * i));
  }
  for (int i = 0; i < last; ++i) {
    const int first = std::clamp(i - 1, 0, last - 3);  // of four nodes that interpolate
    for (int j = 0; j < n; ++j) {
      const auto q = [&](int node) { return path.configuration(first + node)[j]; };
      double middle = (-q(0) + 9 * q(1) + 9 * q(2) - q(3)) / 16;
      if (i == first) middle = (5 * q(0) + 15 * q(1) - 5 * q(2) + q(3)) / 16;
      if (i == first + 2) middle = (q(0) - 5 * q(1) + 15 * q(2) + 5 * q(3)) / 16;
      fine.configuration(2 * i + 1)[j] = middle;
    }
  }
  for (int i = 0; i < fine.intervals; ++i) {
    const int at = i / 2;
    const int other = i % 2 == 0 ? at - 1 : at + 1;
    const bool inside = other >= 0 && other < last;
    for (int j = 0; j < k; ++j) {
      const auto lambda = [&](int interval) { return path.lambda[interval * k + j]; };
      const double slope =
          inside ? lambda(other) - lambda(at) : lambda(at) - lambda(2 * at - other);
      fine.lambda[i * k + j] = lambda(at) + 0.25 * slope;
    }
  }
  return fine;
}

Refinement refine(const MassLadder& ladder, const RefinementOptions& options, const Path& path) {
  Refinement result;
  // Each doubling changes the momenta by a quarter of the last change where the grid resolves the
  // path. Where the changes hardly fall, finer grids follow a path that is not there.
  constexpr double kSlowest = 0.8;
  std::optional<double> last_change;
  for (;;) {
    const Path& coarse = result.finer.empty() ? path : result.finer.back();
    if (2 * coarse.intervals > options.max_intervals || options.stop.reached()) break;
    std::optional<Path> fine = finer(ladder, options.stop, coarse);
    if (!fine) break;
    if (coarse.rung > 0) {
      result.finer.push_back(std::move(*fine));
      continue;
    }
    result.found = true;
    result.change = change_of(coarse, *fine);
    result.intervals = fine->intervals;
    result.path = extrapolated(coarse, *fine);
    result.finer.push_back(std::move(*fine));
    result.settled = result.change <= options.enough;
    if (result.settled) break;
    if (last_change && result.change > kSlowest * *last_change) break;
    last_change = result.change;
  }
  return result;
}

}  // namespace carnot::internal
