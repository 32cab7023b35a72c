#include "carnot/shooting/boundary_value_problem.h"

#include <cmath>
#include <stdexcept>

namespace carnot {
namespace {

void check_end(const char* name, const std::vector<double>& q, const Segment& segment) {
  if (static_cast<int>(q.size()) != segment.dof) {
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(q.size()) +
                                " components, the scene has " + std::to_string(segment.dof));
  }
  for (const double x : q) {
    if (!std::isfinite(x)) {
      throw std::invalid_argument(std::string(name) + " holds " + std::to_string(x) +
                                  ", not a finite number");
    }
  }
  const RateStatus status = end_status(segment, q);
  if (status != RateStatus::kOk) {
    throw std::invalid_argument(std::string(name) + ": " + std::string(describe(status)));
  }
}

}  // namespace

RateStatus end_status(const Segment& segment, const std::vector<double>& q) {
  const std::vector<double> zero(segment.dof, 0.0);
  std::vector<double> q_dot(segment.dof);
  std::vector<double> lambda(segment.multipliers + 1);
  const RateStatus status =
      segment.evaluate(0, q.data(), zero.data(), q_dot.data(), lambda.data()).status;
  // Some systems are of index 1 away from rest only.
  const bool at_rest = status == RateStatus::kNotIndexOne || status == RateStatus::kNoSolution;
  return at_rest ? RateStatus::kOk : status;
}

void BoundaryValueProblem::validate() const {
  check_end("from", from, segment);
  check_end("to", to, segment);
  if (!(time > 0) || !std::isfinite(time)) {
    throw std::invalid_argument("time is " + std::to_string(time) + ", must be > 0");
  }
}

}  // namespace carnot
