#include "carnot/shooting/multiple_shooting.h"

namespace carnot {

std::vector<std::string> minimisers() { return {"ceres", "nlopt", "nlopt:slsqp"}; }

Shooting shoot(const BoundaryValueProblem& problem, const ShootingOptions& options, Knots& knots) {
  return options.minimiser == "ceres" ? shoot_with_ceres(problem, options, knots)
                                      : shoot_with_nlopt(problem, options, knots);
}

}  // namespace carnot
