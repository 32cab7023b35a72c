#include "carnot/shooting/shoot/multiple_shooting.h"

namespace carnot::internal {

std::vector<std::string> names_of_minimisers() {
  return {"newton",
          "ceres",
          "nlopt",
          "nlopt:slsqp",
          "nlopt:lbfgs",
          "nlopt:mlsl",
          "nlopt:isres",
          "nlopt:crs"};
}

Shooting shoot(const BoundaryValueProblem& problem, const ShootingOptions& options, Knots& knots) {
  if (options.minimiser == "newton") return shoot_with_newton(problem, options, knots);
  if (options.minimiser == "ceres") return shoot_with_ceres(problem, options, knots);
  return shoot_with_nlopt(problem, options, knots);
}

}  // namespace carnot::internal
