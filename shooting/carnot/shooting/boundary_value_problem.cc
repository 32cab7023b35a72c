#include "carnot/shooting/boundary_value_problem.h"

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

void BoundaryValueProblem::validate() const {
  check_end("from", from, dynamics);
  check_end("to", to, dynamics);
  if (!(time > 0) || !std::isfinite(time)) {
    throw std::invalid_argument("time is " + std::to_string(time) + ", must be > 0");
  }
}

}  // namespace carnot
