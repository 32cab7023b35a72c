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
  // Where tangents grow there are hundreds of segments. Dense equations cost the third power of
  // their number, and the sparse ones of Ceres are templates of Eigen, whose symbols a program
  // with other flags may replace.
  constexpr int kFewSegments = 16;
  if (options.minimiser == "ceres") {
    return knots.segments <= kFewSegments ? shoot_with_ceres(problem, options, knots)
                                          : shoot_with_newton(problem, options, knots);
  }
  return shoot_with_nlopt(problem, options, knots);
}

}  // namespace carnot::internal
