#include "carnot/shooting/boundary_value_problem.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace carnot {
namespace {

void check_end(const char* name, const std::vector<double>& q, const Dynamics& dynamics) {
  if (static_cast<int>(q.size()) != dynamics.dof) {
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(q.size()) +
                                " components, the scene has " + std::to_string(dynamics.dof));
  }
  for (const double x : q) {
    if (!std::isfinite(x)) {
      throw std::invalid_argument(std::string(name) + " holds " + std::to_string(x) +
                                  ", not a finite number");
    }
  }
  const RateStatus status = end_status(dynamics, q);
  if (status != RateStatus::kOk) {
    throw std::invalid_argument(std::string(name) + ": " + std::string(describe(status)));
  }
}

bool any(const std::vector<bool>& free) {
  return std::find(free.begin(), free.end(), true) != free.end();
}

void check_free(const char* name, const std::vector<bool>& free, const Dynamics& dynamics) {
  if (free.empty()) return;
  if (static_cast<int>(free.size()) != dynamics.dof) {
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(free.size()) +
                                " components, the scene has " + std::to_string(dynamics.dof));
  }
  if (dynamics.holonomic > 0 && any(free)) {
    throw std::invalid_argument(
        "a free coordinate on a manifold h(q) = 0, which ties it to the others");
  }
}

}  // namespace

RateStatus end_status(const Dynamics& dynamics, const std::vector<double>& q) {
  const std::vector<double> zero(dynamics.dof, 0.0);
  std::vector<double> q_dot(dynamics.dof);
  std::vector<double> lambda(dynamics.multipliers);
  const RateStatus status = dynamics.evaluate(0, q, zero, q_dot, lambda).status;
  // Some systems are of index 1 away from rest only.
  const bool at_rest = status == RateStatus::kNotIndexOne || status == RateStatus::kNoSolution;
  return at_rest ? RateStatus::kOk : status;
}

bool BoundaryValueProblem::has_free_ends() const { return any(free_from) || any(free_to); }
bool BoundaryValueProblem::has_free_target() const { return any(free_to); }

void BoundaryValueProblem::validate() const {
  check_end("from", from, dynamics);
  check_end("to", to, dynamics);
  check_free("free_from", free_from, dynamics);
  check_free("free_to", free_to, dynamics);
  if (!(time > 0) || !std::isfinite(time)) {
    throw std::invalid_argument("time is " + std::to_string(time) + ", must be > 0");
  }
}

}  // namespace carnot
