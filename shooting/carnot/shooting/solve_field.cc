#include "carnot/shooting/solve_field.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_solver.h"

namespace carnot {

using namespace internal;

namespace {

bool has_potential(const BoundaryValueProblem& problem) {
  const int n = problem.dynamics.dof;
  const std::vector<double> rest(n, 0.0);
  std::vector<double> velocity(n), lambda(problem.dynamics.multipliers);
  for (const std::vector<double>& q : {problem.from, problem.to}) {
    if (problem.dynamics.evaluate(0, q, rest, velocity, lambda).hamiltonian != 0) return true;
  }
  return false;
}

void require(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument(what);
}

void validate(const BoundaryValueProblem& problem) {
  problem.validate();
  require(problem.dynamics.has_transcription() && !has_potential(problem),
          "a field is of a scene with velocity constraints or driftless controls, and without a "
          "potential");
  require(!problem.has_free_ends(), "the ends of a field are not free");
  require(problem.limits.empty(), "a field keeps to no limits");
}

void validate(const BoundaryValueProblem& problem, const std::vector<FieldAxis>& axes) {
  constexpr double kEven = 1e-9;
  require(!axes.empty(), "a field has at least one axis");
  for (const FieldAxis& axis : axes) {
    require(axis.coordinate >= 0 && axis.coordinate < problem.dynamics.dof && !axis.values.empty(),
            "an axis of a field has a coordinate and values");
    const std::vector<double>& x = axis.values;
    const double step = x.size() > 1 ? x[1] - x[0] : 1;
    bool even = step != 0;
    for (std::size_t i = 1; i < x.size(); ++i) {
      even = even && std::abs(x[i] - x[i - 1] - step) <= kEven * std::abs(step);
    }
    require(even, "the values of an axis are not equidistant");
  }
}

FieldGrid grid_of(const BoundaryValueProblem& problem,
                  const std::vector<FieldAxis>& axes,
                  bool mod_angles) {
  constexpr double kRounded = 1e-9;
  FieldGrid grid;
  grid.to = problem.to;
  for (const FieldAxis& axis : axes) {
    FieldGrid::Axis one{axis.coordinate, axis.values, false, 0};
    if (mod_angles) one.period = problem.dynamics.info.configuration[axis.coordinate].period;
    if (one.period > 0 && axis.values.size() > 2) {
      const double step = std::abs(axis.values[1] - axis.values[0]);
      const double covered = step * static_cast<double>(axis.values.size());
      one.around = std::abs(covered - one.period) <= kRounded * one.period;
    }
    grid.axes.push_back(std::move(one));
  }
  return grid;
}

// The same problem to the first point of the grid at which the scene is regular; without any, to
// the first one.
BoundaryValueProblem to_a_regular_point(BoundaryValueProblem problem, const FieldGrid& grid) {
  for (long i = 0; i < grid.size(); ++i) {
    problem.to = grid.target(i);
    if (end_status(problem.dynamics, problem.to) == RateStatus::kOk) return problem;
  }
  problem.to = grid.target(0);
  return problem;
}

}  // namespace

Field solve_field(const BoundaryValueProblem& problem,
                  const std::vector<FieldAxis>& axes,
                  const FieldOptions& options) {
  require(static_cast<int>(problem.to.size()) == problem.dynamics.dof,
          "the target of a field has " + std::to_string(problem.to.size()) +
              " components, the scene has " + std::to_string(problem.dynamics.dof));
  require(options.branches >= 1, "a field keeps at least one extremal for each point");
  const FieldTeam& team = options.team;
  require(team.size >= 1 && team.rank >= 0 && team.rank < team.size &&
              (team.size == 1 || team.exchange != nullptr),
          "a team has ranks below its size, and an exchange");
  validate(problem, axes);
  const FieldGrid grid = grid_of(problem, axes, options.search.mod_angles);
  const BoundaryValueProblem regular = to_a_regular_point(problem, grid);
  validate(regular);
  options.search.validate(regular);
  return FieldSolver(regular, grid, options).run();
}

}  // namespace carnot
