#include "carnot/scene/chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/numerics/gradient.h"
#include "carnot/scenes/satellite.h"
#include "carnot/scenes/vehicle.h"

namespace carnot::chart_test {
namespace {

static_assert(HasChart<scenes::Satellite> && !HasChart<scenes::Vehicle>);

struct OneAngle {
  static constexpr int kDof = 1;
  template <class T>
  [[nodiscard]] T chart(const Vector<T, 1>& q) const {
    using std::cos;
    return cos(q[0]);
  }
};

TEST(ChartTest, SingularWithinTheMargin) {
  constexpr double kSingular = std::numbers::pi / 2;
  for (const double side : {-1.0, 1.0}) {
    for (const double off : {0.0, 0.5 * kNearSingularChart}) {
      const Vector<double, 1> q(side * (kSingular - off));
      EXPECT_FALSE(regular_chart(OneAngle{}, q)) << off;
      EXPECT_FALSE(regular_chart(OneAngle{}, seeded(q))) << off;
    }
    const Vector<double, 1> q(side * (kSingular - 2 * kNearSingularChart));
    EXPECT_TRUE(regular_chart(OneAngle{}, q));
    EXPECT_TRUE(regular_chart(OneAngle{}, seeded(q)));
  }
  const Vector<double, 1> nan(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(regular_chart(OneAngle{}, nan));
}

TEST(ChartTest, RegularWithoutAChart) {
  EXPECT_TRUE(regular_chart(scenes::Vehicle{}, Vector<double, 4>(1e300, 0, 0, 0)));
}

}  // namespace
}  // namespace carnot::chart_test
