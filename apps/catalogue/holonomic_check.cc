#include "catalogue/holonomic_check.h"

#include <fmt/format.h>

#include "carnot/shooting/boundary_value_problem.h"
#include "text/numbers.h"

namespace carnot::apps {

void check_holonomic(std::string_view option, std::string_view text, double residual) {
  constexpr double kTolerance = 1e-9;
  if (residual <= kTolerance) return;
  refuse(option,
         text,
         fmt::format("off the holonomic constraints, max |h(q)| = {:.3g}", residual),
         fmt::format("a configuration with max |h(q)| <= {:g}", kTolerance));
}

void check_end(std::string_view option,
               std::string_view text,
               const Dynamics& dynamics,
               const std::vector<double>& q) {
  if (dynamics.holonomic > 0) {
    std::vector<double> z = q;
    z.resize(2 * q.size(), 0.0);
    check_holonomic(option, text, dynamics.holonomic_residuals(0, z).position);
  }
  const RateStatus status = end_status(dynamics, q);
  if (status != RateStatus::kOk) refuse(option, text, describe(status), "regular configurations");
}

}  // namespace carnot::apps
