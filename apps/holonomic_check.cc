#include "holonomic_check.h"

#include <fmt/format.h>

#include "numbers.h"

namespace carnot::apps {

void check_holonomic(std::string_view option, std::string_view text, double residual) {
  constexpr double kTolerance = 1e-9;
  if (residual <= kTolerance) return;
  refuse(option,
         text,
         fmt::format("off the holonomic constraints, max |h(q)| = {:.3g}", residual),
         fmt::format("a configuration with max |h(q)| <= {:g}", kTolerance));
}

}  // namespace carnot::apps
