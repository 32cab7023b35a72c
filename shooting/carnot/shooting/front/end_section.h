// The momenta whose extremals end where a coordinate has a given value, or that of another one.
//
// Of momenta that are a circle times a plane (front/unit_momenta.h), the condition
//
//   h(c, w) = q_j(R) - q_k(R) - b = 0
//
// leaves a surface. Its gradient comes from the tangent flow, dh = (e_j - e_k)' dq(R)/dp(0) dp, and
// a place beside the surface is taken to it by Newton's method along the gradient: steps along the
// axes of the plane count as they are, beside radians on the circle. Angles have to agree up to
// whole turns only.
#pragma once

#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/end_condition.h"
#include "carnot/shooting/front/unit_momenta.h"

namespace carnot::internal {

class EndSection {
 public:
  // At the time t. Keeps references to the first three.
  EndSection(const Dynamics& dynamics,
             const std::vector<double>& from,
             const UnitMomenta& momenta,
             const EndCondition& condition,
             double t,
             bool mod_angles);

  // By how much q(t) misses the condition. Of angles within half a turn, and not continuous there.
  [[nodiscard]] double excess(const double* q) const;
  // The same of an extremal, followed in `steps` or more: in as many as are enough, which they are
  // for the next one nearby. NaN where the flow fails.
  double excess_at(const UnitMomentum& place, long& steps) const;
  // Half a turn, where excess() jumps; infinite where it does not.
  [[nodiscard]] double farthest() const { return 0.5 * period_; }

  // Takes a place to the surface, to round-off of the flow. False where Newton's method does not
  // converge nearby. Cost: three or four tangent flows.
  bool settle(UnitMomentum& place) const;

 private:
  const Dynamics& dynamics_;
  const std::vector<double>& from_;
  const UnitMomenta& momenta_;
  EndCondition condition_;
  double t_;
  double period_;
};

}  // namespace carnot::internal
