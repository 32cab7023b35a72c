#include "carnot/shooting/field/cold_searches.h"

#include <stdexcept>

#include "carnot/numerics/parallel.h"

namespace carnot::internal {

std::vector<GeodesicReport> cold_searches(
    std::size_t count,
    const std::function<BoundaryValueProblem(std::size_t)>& problem,
    GeodesicOptions search,
    int threads) {
  search.count = 1;
  search.all = false;
  search.samples = 0;
  search.abnormal = false;  // momenta are what a field is made of
  search.threads = 1;
  std::vector<GeodesicReport> reports(count);
  parallel_for(static_cast<int>(count), thread_count(threads), [&](int k) {
    try {
      reports[k] = find_geodesics(problem(static_cast<std::size_t>(k)), search);
    } catch (const std::invalid_argument&) {
      reports[k].reason = Reason::kIrregularEnd;
    }
  });
  return reports;
}

}  // namespace carnot::internal
