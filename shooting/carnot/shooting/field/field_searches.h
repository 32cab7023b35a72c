// What searches without a guess gave to points of a field, in the units of the scene.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "carnot/shooting/field/field_bytes.h"
#include "carnot/shooting/field/field_grid.h"
#include "carnot/shooting/field/field_partners.h"
#include "carnot/shooting/find_geodesics.h"

namespace carnot::internal {

// An extremal that a search found.
struct FieldFind {
  double action = 0;
  Verification verification = Verification::kSingle;
  Label label = Label::kUnknown;
  double error = 0;  // at the end, or of the knots
  std::vector<double> p0;
};

// What a search gave.
struct FieldReport {
  Reason reason = Reason::kNone;  // why nothing was found
  std::optional<FieldFind> found;
  std::vector<int> windings;  // of the axes of the grid
};

class FieldSearches {
 public:
  using Reports = std::map<long, FieldReport>;  // of points

  // Keeps references.
  FieldSearches(const BoundaryValueProblem& problem, const FieldGrid& grid)
      : problem_(problem), grid_(grid) {}

  // Searches these points on so many threads, with the partners. It keeps nothing.
  [[nodiscard]] Reports search(const std::vector<long>& points,
                               const GeodesicOptions& options,
                               int threads,
                               FieldPartners& partners) const;
  // The least of what was found for each point, and why nothing was.
  void keep(const Reports& reports);

  [[nodiscard]] bool tried(long i) const { return found_.contains(i) || failed_.contains(i); }
  // What was found of point i, or nullptr.
  [[nodiscard]] const FieldFind* find(long i) const;
  // Why nothing was found where it was tried.
  [[nodiscard]] Reason failure(long i) const;
  // Whether point i is the start, but for the round-off of equidistant values: the middle one of
  // seven between -1.2 and 1.2 is 2.2e-16.
  [[nodiscard]] bool rests(long i) const;

  void write(ByteWriter& out) const;
  // What these have written of the same grid. Throws DamagedBytes.
  void read(ByteReader& in);

 private:
  [[nodiscard]] FieldReport report_of(const GeodesicReport& report) const;

  const BoundaryValueProblem& problem_;
  const FieldGrid& grid_;
  std::map<long, FieldFind> found_;
  std::map<long, Reason> failed_;
};

}  // namespace carnot::internal
