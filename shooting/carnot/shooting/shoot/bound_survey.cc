#include "carnot/shooting/shoot/bound_survey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "carnot/numerics/scalar.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/shoot/on_wall.h"

namespace carnot::internal {
namespace {

// eta on an arc: what makes the velocity without the bound keep to it.
double eta_at(const Walls& walls, HamiltonianTerms& terms, int wall, const double* z, int n) {
  const WallAt at = wall_at(walls, n, wall, z);
  const Approach to = approach(terms, at, z);
  return to.rate / to.by_p.dot(at.gradient);
}

// nu = eta' along a segment on a wall, by differences of eta.
struct MultiplierRange {
  double least = std::numeric_limits<double>::infinity();
  double largest = 0;
};

MultiplierRange multipliers(const Walls& walls,
                            HamiltonianTerms& terms,
                            const Dynamics& dynamics,
                            const Piece& piece,
                            const StepPlan& plan,
                            std::vector<double> z) {
  constexpr long kSamples = 33;
  MonitorOptions options;
  options.samples = kSamples;
  const Trajectory path = dynamics.monitored_flow(plan, z, options).trajectory;
  MultiplierRange range;
  double before = 0;
  for (std::size_t i = 0; i < path.t.size(); ++i) {
    std::vector<double> at = path.q[i];
    at.insert(at.end(), path.p[i].begin(), path.p[i].end());
    const double eta = eta_at(walls, terms, piece.wall, at.data(), dynamics.dof);
    if (i > 0) {
      const double nu = (eta - before) / (path.t[i] - path.t[i - 1]);
      range.least = minimum(range.least, nu);
      range.largest = maximum(range.largest, nu);
    }
    before = eta;
  }
  return range;
}

double energy_at(const Dynamics& dynamics, const std::vector<double>& z) {
  std::vector<double> velocity(dynamics.dof);
  std::vector<double> lambda(dynamics.multipliers);
  const std::span<const double> at(z);
  return dynamics.evaluate(0, at.first(dynamics.dof), at.subspan(dynamics.dof), velocity, lambda)
      .hamiltonian;
}

// Appends samples of a segment, with the momenta of the problem without bounds.
void record(const BoundaryValueProblem& problem,
            const Walls& walls,
            HamiltonianTerms& terms,
            int wall,
            const Trajectory& samples,
            Trajectory& to) {
  const int n = problem.dynamics.dof;
  std::vector<double> lambda(problem.dynamics.multipliers);
  std::vector<double> velocity(n);
  for (std::size_t i = 0; i < samples.t.size(); ++i) {
    std::vector<double> z = samples.q[i];
    z.insert(z.end(), samples.p[i].begin(), samples.p[i].end());
    if (wall >= 0) {
      const double eta = eta_at(walls, terms, wall, z.data(), n);
      const WallAt at = wall_at(walls, n, wall, z.data());
      for (int j = 0; j < n; ++j) z[n + j] -= eta * at.gradient[j];
    }
    const std::span<const double> at(z);
    const auto values =
        problem.dynamics.evaluate(samples.t[i], at.first(n), at.subspan(n), velocity, lambda);
    to.t.push_back(samples.t[i]);
    to.q.emplace_back(z.begin(), z.begin() + n);
    to.p.emplace_back(z.begin() + n, z.end());
    to.lambda.push_back(lambda);
    to.hamiltonian.push_back(values.hamiltonian);
  }
}

}  // namespace

BoundSurvey survey_pieces(const BoundaryValueProblem& problem,
                          const Walls& walls,
                          const BoundExtremal& extremal,
                          long steps,
                          const std::vector<double>& times) {
  const int n = problem.dynamics.dof;
  const double slack = kTimeRoundOff * problem.time;
  const Held held(problem, walls, extremal);
  HamiltonianTerms terms(problem.dynamics);
  BoundSurvey result;
  FlowSummary& total = result.summary;
  double initial = std::numeric_limits<double>::quiet_NaN();
  double start = 0;
  for (std::size_t k = 0; k < extremal.pieces.size(); ++k) {
    const Piece& piece = extremal.pieces[k];
    const Dynamics& dynamics = held.of(piece);
    const double duration = (piece.end - start) / piece.segments;
    const long count = steps_of(problem, piece, start, steps);
    double largest = 0;
    double least = 0;
    for (int i = 0; i < piece.segments; ++i) {
      const bool ends = i + 1 == piece.segments;
      const bool last = ends && k + 1 == extremal.pieces.size();
      const double from = start + i * duration;
      const double to = ends ? piece.end : from + duration;
      std::vector<double> z(piece.z.begin() + i * 2 * n, piece.z.begin() + (i + 1) * 2 * n);
      if (piece.wall >= 0) {
        const MultiplierRange range =
            multipliers(walls, terms, dynamics, piece, StepPlan::equal(from, to - from, count), z);
        largest = maximum(largest, range.largest);
        least = minimum(least, range.least);
      }
      MonitorOptions options;
      for (const double t : times) {
        if (t >= from - slack && (last || t < to - slack)) {
          options.times.push_back(std::clamp(t, from, to));
        }
      }
      const double energy = energy_at(dynamics, z);
      if (std::isnan(initial)) initial = energy;
      const FlowSummary part =
          dynamics.monitored_flow(StepPlan::equal(from, to - from, count), z, options);
      if (!part.completed()) return result;
      total.action += part.action;
      total.length += part.length;
      total.energy_drift =
          std::max(total.energy_drift, part.energy_drift + std::abs(energy - initial));
      total.constraint_error = std::max(total.constraint_error, part.constraint_error);
      record(problem, walls, terms, piece.wall, part.trajectory, total.trajectory);
      if (last) {
        if (piece.leaves() >= 0) {
          result.stop = piece.release - eta_at(walls, terms, piece.wall, z.data(), n);
          const WallAt wall = wall_at(walls, n, piece.wall, z.data());
          for (int j = 0; j < n; ++j) z[n + j] -= piece.release * wall.gradient[j];
        }
        result.end = z;
        const double unit = length_per_momentum(problem, &extremal.pieces[0].z[n]);
        result.defect = maximum(result.defect, miss(problem, z.data(), unit));
        continue;
      }
      const double* next = ends ? extremal.pieces[k + 1].z.data() : &piece.z[(i + 1) * 2 * n];
      if (piece.leaves() >= 0 && ends) {
        const WallAt wall = wall_at(walls, n, piece.leaves(), next);
        for (int j = 0; j < n; ++j) z[n + j] -= piece.release * wall.gradient[j];
      }
      for (int j = 0; j < 2 * n; ++j) {
        result.defect = maximum(result.defect, std::abs(z[j] - next[j]));
      }
    }
    result.largest_multiplier.push_back(largest);
    result.least_multiplier.push_back(least);
    start = piece.end;
  }
  result.completed = true;
  return result;
}

}  // namespace carnot::internal
