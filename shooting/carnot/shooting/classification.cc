#include "carnot/shooting/classification.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/conjugate_times.h"
#include "carnot/shooting/end_point.h"
#include "carnot/shooting/survey.h"

namespace carnot {
namespace {

// The largest |value(q)| along the path: of samples, and of the parabola through the best three.
void add_extremes(const BoundaryValueProblem& problem,
                  const Knots& knots,
                  long steps,
                  Geodesic& geodesic) {
  if (problem.segment.info.extremes.empty()) return;
  const Trajectory fine = survey(problem, knots, steps, 2 * steps + 1).trajectory;
  for (const Extreme& extreme : problem.segment.info.extremes) {
    std::vector<double> size;
    for (const auto& q : fine.q) size.push_back(std::abs(extreme.value(q.data())));
    const auto top = std::max_element(size.begin(), size.end());
    double largest = *top;
    if (top != size.begin() && top + 1 != size.end()) {
      const double bend = top[-1] - 2 * top[0] + top[1];
      const double slope = 0.5 * (top[1] - top[-1]);
      if (bend < 0) largest -= 0.5 * slope * slope / bend;
    }
    geodesic.extremes.emplace_back(extreme.name, largest);
  }
}

// Abnormal: dq(t)/dp0 is singular already on the way. A family: it is singular at T only.
void classify_singular(const BoundaryValueProblem& problem, Geodesic& geodesic) {
  constexpr double kOnTheWay = 0.43;  // a time without symmetry
  std::vector<double> z;
  const long steps = geodesic.plan.count / 2;
  const auto way = end_point_jacobian(problem, geodesic.p0, kOnTheWay * problem.time, steps, z);
  const auto end = end_point_jacobian(problem, geodesic.p0, problem.time, steps, z);
  if (!way || !end) return;
  const int always = nullity(*way) - problem.segment.holonomic;
  geodesic.abnormal = always > 0;
  geodesic.family_dimension = std::max(0, nullity(*end) - nullity(*way));
  if (*geodesic.family_dimension > 0) geodesic.label = Label::kSingular;
}

}  // namespace

void complete(const BoundaryValueProblem& problem, long samples, Extremal& extremal) {
  Geodesic& geodesic = extremal.geodesic;
  const long steps = geodesic.plan.count;
  add_extremes(problem, extremal.knots, steps, geodesic);
  if (samples > 0) geodesic.trajectory = survey(problem, extremal.knots, steps, samples).trajectory;
  if (geodesic.verification == Verification::kSingle) classify_singular(problem, geodesic);
  // dq/dp0 is singular at all times.
  if (geodesic.abnormal.value_or(false) || problem.segment.holonomic > 0) return;
  const ConjugateTimes conjugate = conjugate_times(problem, extremal.knots, steps / 2);
  if (!conjugate.known) return;
  geodesic.conjugate_times = conjugate.times;
  const auto inner = std::count_if(
      conjugate.times.begin(), conjugate.times.end(), [&](double t) { return t < problem.time; });
  geodesic.morse_index = static_cast<int>(inner);
  if (geodesic.label == Label::kSingular) return;
  if (inner > 0) geodesic.label = Label::kConjugatePassed;
  if (conjugate.times.empty()) geodesic.label = Label::kLocallyMinimal;
}

}  // namespace carnot
