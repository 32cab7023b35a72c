// From discrete extremals to verified ones.
#include "carnot/shooting/search/polish.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "carnot/shooting/search/relaxed_start.h"
#include "shooting/problems.h"

namespace carnot::internal::polish_test {
namespace {

// Flows along a car whose body and steering are light magnify. Newton's method joins them where
// they are short, but takes more iterations than where the grid resolves the path.
TEST(Polish, JoinsShorterFlowsWhereTheyMagnify) {
  const BoundaryValueProblem problem = test::light_car({2.8512, 3.92792, 0.51382, -0.3369});
  const MassLadder ladder(problem);
  const std::vector<StartDraw> first{{0, 16}};
  const RelaxedStart start = relaxed_starts(ladder, std::nullopt, {}, first)[0];
  ASSERT_TRUE(start.found);
  const Outcome outcome = polish(ladder, {}, start.path);
  ASSERT_TRUE(outcome.extremal.has_value());
  const Geodesic& geodesic = outcome.extremal->geodesic;
  EXPECT_EQ(geodesic.verification, Verification::kKnots);
  EXPECT_LE(geodesic.knot_defect, 1e-10);
  EXPECT_LE(geodesic.constraint_error, 1e-12);
  EXPECT_LE(std::abs(geodesic.energy_drift), 1e-10);
}

}  // namespace
}  // namespace carnot::internal::polish_test
