#include "atlas/field_crew.h"

#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "run/delivery.h"

namespace carnot::apps {

Field solve_together(Ranks& ranks,
                     FieldState& state,
                     const BoundaryValueProblem& problem,
                     const std::vector<FieldAxis>& axes,
                     FieldOptions options) {
  if (options.threads == 0) options.threads = ranks.threads();
  options.team = {
      ranks.rank(), ranks.size(), [&](const std::string& own) { return ranks.exchange(own); }};
  try {
    return state.solve(problem, axes, std::move(options));
  } catch (const std::invalid_argument&) {
    throw;
  } catch (const std::exception& error) {
    if (ranks.size() > 1) complain(error.what());
    ranks.abandon();
    throw;
  }
}

}  // namespace carnot::apps
