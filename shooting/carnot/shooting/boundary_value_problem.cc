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
  const std::vector<double> zero(segment.dof, 0.0);
  std::vector<double> q_dot(segment.dof);
  std::vector<double> lambda(segment.multipliers + 1);
  const PointValues at = segment.evaluate(0, q.data(), zero.data(), q_dot.data(), lambda.data());
  // Some systems are of index 1 away from rest only.
  const bool at_rest =
      at.status == RateStatus::kNotIndexOne || at.status == RateStatus::kNoSolution;
  if (at.status != RateStatus::kOk && !at_rest) {
    throw std::invalid_argument(std::string(name) + ": " + std::string(describe(at.status)));
  }
}

}  // namespace

void BoundaryValueProblem::validate() const {
  check_end("from", from, segment);
  check_end("to", to, segment);
  if (!(time > 0) || !std::isfinite(time)) {
    throw std::invalid_argument("time is " + std::to_string(time) + ", must be > 0");
  }
}

}  // namespace carnot
