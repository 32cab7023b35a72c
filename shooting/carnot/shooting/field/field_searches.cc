#include "carnot/shooting/field/field_searches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/shooting/field/cold_searches.h"

namespace carnot::internal {
namespace {

void write_find(const FieldFind& find, ByteWriter& out) {
  out.add(find.action);
  out.add(find.verification);
  out.add(find.label);
  out.add(find.error);
  out.add(find.p0);
}

FieldFind read_find(std::size_t n, ByteReader& in) {
  FieldFind find;
  find.action = in.take<double>();
  find.verification = in.take<Verification>();
  find.label = in.take<Label>();
  find.error = in.take<double>();
  find.p0 = in.take_all<double>(n);
  return find;
}

}  // namespace

FieldReport FieldSearches::report_of(const GeodesicReport& report) const {
  FieldReport one;
  if (report.geodesics.empty()) {
    one.reason = report.reason;
    return one;
  }
  const Geodesic& geodesic = report.geodesics[0];
  one.found.emplace();
  FieldFind& find = *one.found;
  find.action = geodesic.action;
  find.verification = geodesic.verification;
  find.label = geodesic.label;
  find.error =
      find.verification == Verification::kKnots ? geodesic.knot_defect : geodesic.endpoint_error;
  find.p0 = geodesic.p0;
  for (const FieldGrid::Axis& axis : grid_.axes) {
    one.windings.push_back(geodesic.windings.empty() ? 0 : geodesic.windings[axis.coordinate]);
  }
  return one;
}

FieldSearches::Reports FieldSearches::search(const std::vector<long>& points,
                                             const GeodesicOptions& options,
                                             int threads,
                                             FieldPartners& partners) const {
  std::vector<long> own;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (partners.has(static_cast<long>(k))) own.push_back(points[k]);
  }
  const auto list = cold_searches(
      own.size(),
      [&](std::size_t k) {
        BoundaryValueProblem problem = problem_;
        problem.to = grid_.target(own[k]);
        return problem;
      },
      options,
      threads);
  Reports reports;
  for (std::size_t k = 0; k < own.size(); ++k) reports[own[k]] = report_of(list[k]);
  partners.share(
      [&reports](ByteWriter& out) {
        out.add(static_cast<long>(reports.size()));
        for (const auto& [i, report] : reports) {
          out.add(i);
          out.add(report.reason);
          out.add(report.windings);
          out.add(report.found.has_value());
          if (report.found) write_find(*report.found, out);
        }
      },
      [this, &reports](ByteReader& in) {
        for (auto left = in.take<long>(); left > 0; --left) {
          FieldReport& report = reports[in.take<long>()];
          report.reason = in.take<Reason>();
          report.windings = in.take_all<int>(grid_.axes.size());
          if (in.take<bool>()) report.found = read_find(problem_.from.size(), in);
        }
      });
  return reports;
}

void FieldSearches::keep(const Reports& reports) {
  for (const auto& [i, report] : reports) {
    if (!report.found) {
      failed_.emplace(i, report.reason);
      continue;
    }
    const FieldFind& find = *report.found;
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
  std::vector<double> largest(near.size(), 0.0);
  for (const FieldGrid::Axis& axis : grid_.axes) {
    largest[axis.coordinate] =
        std::max(std::abs(axis.values.front()), std::abs(axis.values.back()));
  }
  for (const auto& [coordinate, leader, ratio] : grid_.followers) {
    largest[coordinate] += std::abs(ratio) * largest[leader];
  }
  for (std::size_t j = 0; j < near.size(); ++j) {
    const double start = problem_.from[j];
    if (std::abs(near[j] - start) <= kRounded * largest[j]) near[j] = start;
  }
  return near == problem_.from;
}

void FieldSearches::write(ByteWriter& out) const {
  out.add(static_cast<long>(found_.size()));
  for (const auto& [i, find] : found_) {
    out.add(i);
    write_find(find, out);
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
    const auto i = in.take<long>();
    found_[i] = read_find(n, in);
  }
  for (auto left = in.take<long>(); left > 0; --left) {
    const auto i = in.take<long>();
    failed_[i] = in.take<Reason>();
  }
}

}  // namespace carnot::internal
