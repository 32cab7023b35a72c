#include "carnot/shooting/field/field_searches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/shooting/field/cold_searches.h"

namespace carnot::internal {

FieldSearches::Reports FieldSearches::search(const std::vector<long>& points,
                                             const GeodesicOptions& options,
                                             int threads) const {
  auto list = cold_searches(
      points.size(),
      [&](std::size_t k) {
        BoundaryValueProblem problem = problem_;
        problem.to = grid_.target(points[k]);
        return problem;
      },
      options,
      threads);
  Reports reports;
  for (std::size_t k = 0; k < points.size(); ++k) reports[points[k]] = std::move(list[k]);
  return reports;
}

void FieldSearches::keep(const Reports& reports) {
  for (const auto& [i, report] : reports) {
    if (report.geodesics.empty()) {
      failed_.emplace(i, report.reason);
      continue;
    }
    const Geodesic& geodesic = report.geodesics[0];
    FieldFind find;
    find.action = geodesic.action;
    find.verification = geodesic.verification;
    find.label = geodesic.label;
    find.error =
        find.verification == Verification::kKnots ? geodesic.knot_defect : geodesic.endpoint_error;
    find.p0 = geodesic.p0;
    const auto [kept, is_new] = found_.try_emplace(i, find);
    if (!is_new && find.action < kept->second.action) kept->second = find;
  }
}

const FieldFind* FieldSearches::find(long i) const {
  const auto found = found_.find(i);
  return found == found_.end() ? nullptr : &found->second;
}

Reason FieldSearches::failure(long i) const {
  const auto failed = failed_.find(i);
  return failed == failed_.end() ? Reason::kNone : failed->second;
}

bool FieldSearches::rests(long i) const {
  constexpr double kRounded = 4 * std::numeric_limits<double>::epsilon();
  std::vector<double> near = grid_.target(i);
  for (const FieldGrid::Axis& axis : grid_.axes) {
    const double largest = std::max(std::abs(axis.values.front()), std::abs(axis.values.back()));
    const double start = problem_.from[axis.coordinate];
    double& there = near[axis.coordinate];
    if (std::abs(there - start) <= kRounded * largest) there = start;
  }
  return near == problem_.from;
}

void FieldSearches::write(ByteWriter& out) const {
  out.add(static_cast<long>(found_.size()));
  for (const auto& [i, find] : found_) {
    out.add(i);
    out.add(find.action);
    out.add(find.verification);
    out.add(find.label);
    out.add(find.error);
    out.add(find.p0);
  }
  out.add(static_cast<long>(failed_.size()));
  for (const auto& [i, reason] : failed_) {
    out.add(i);
    out.add(reason);
  }
}

void FieldSearches::read(ByteReader& in) {
  const std::size_t n = problem_.from.size();
  for (auto left = in.take<long>(); left > 0; --left) {
    FieldFind& find = found_[in.take<long>()];
    find.action = in.take<double>();
    find.verification = in.take<Verification>();
    find.label = in.take<Label>();
    find.error = in.take<double>();
    find.p0 = in.take_all<double>(n);
  }
  for (auto left = in.take<long>(); left > 0; --left) {
    const auto i = in.take<long>();
    failed_[i] = in.take<Reason>();
  }
}

}  // namespace carnot::internal
