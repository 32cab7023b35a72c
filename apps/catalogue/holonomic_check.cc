#include "catalogue/holonomic_check.h"

#include <fmt/format.h>

#include "carnot/shooting/boundary_value_problem.h"
#include "text/numbers.h"

namespace carnot::apps {

void check_holonomic(std::string_view option,
                     std::string_view text,
                     const HolonomicResiduals& residuals) {
  constexpr double kTolerance = 1e-9;
  if (residuals.relative_position <= kTolerance) return;
  refuse(option,
         text,
         fmt::format("off the holonomic constraints, max |h(q)| = {:.3g}, relative residual {:.3g}",
                     residuals.position,
                     residuals.relative_position),
         fmt::format("a relative residual <= {:g}", kTolerance));
}

void check_end(std::string_view option,
               std::string_view text,
               const Dynamics& dynamics,
               const std::vector<double>& q) {
  if (dynamics.holonomic > 0) {
    std::vector<double> z = q;
    z.resize(2 * q.size(), 0.0);
    check_holonomic(option, text, dynamics.holonomic_residuals(0, z));
  }
  const RateStatus status = end_status(dynamics, q);
  if (status != RateStatus::kOk) refuse(option, text, describe(status), "regular configurations");
}

}  // namespace carnot::apps
