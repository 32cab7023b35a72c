// The first mesh of a sphere, and conjugate times beside an abnormal curve, on the flat Martinet
// problem.
#include "carnot/shooting/front/columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "carnot/shooting/rays/conjugate_time.h"
#include "shooting/problems.h"

namespace carnot::internal::columns_test {
namespace {

const std::vector<double> kOrigin{0, 0, 0};

Dynamics martinet() { return test::martinet({0, 0, 0}).dynamics; }

// Dilations take x and y to s x and s y, z to s^3 z and times to s t: so conjugate times times
// sqrt(p_z) depend on the direction only. The nearer that is to the abnormal line y = 0, the more
// unstable extremals are: here they grow by up to exp(28) until they are conjugate.
TEST(Columns, ConjugateTimesScaleBesideAnAbnormalCurve) {
  constexpr double kRelative = 1e-8;  // how exactly these times are located
  const Dynamics dynamics = martinet();
  for (const double angle : {0.1, 0.01, 0.00065}) {
    const auto scaled = [&](double w) {
      const Ray ray(dynamics, kOrigin, {-std::cos(angle), std::sin(angle), w});
      return conjugate_time(ray, 5) * std::sqrt(w);
    };
    const double expected = scaled(40);
    EXPECT_GT(expected, 2 * std::log(8 / angle));  // beyond the cut time 2 K(k)
    for (const double w : {100.0, 188.0, 332.0, 500.0}) {
      EXPECT_NEAR(scaled(w), expected, kRelative * expected) << angle << " " << w;
    }
  }
}

std::vector<Column> columns_of(const Dynamics& dynamics, double edge) {
  const UnitMomenta momenta(dynamics, kOrigin, {});
  return conjugate_columns({dynamics, kOrigin, momenta, 1, edge, 2}, ImageScale({0, 1, 2}));
}

TEST(Columns, EndWhereExtremalsAreConjugate) {
  constexpr double kTold = 0.02;  // how exactly w is
  const Dynamics dynamics = martinet();
  const UnitMomenta momenta(dynamics, kOrigin, {});
  for (const Column& column : columns_of(dynamics, 0.2)) {
    for (const double w : {column.low, column.high}) {
      const auto time = [&](double part) {
        return conjugate_time(Ray(dynamics, kOrigin, momenta.momentum({column.c, {part * w, 0}})),
                              2);
      };
      EXPECT_LE(time(1), 1) << column.c.transpose() << " " << w;
      EXPECT_GT(time(1 - 2 * kTold), 1) << column.c.transpose() << " " << w;
    }
  }
}

// Beside the abnormal line some directions have no bound that is found. Those of half of them are
// known, and grow like the inverse square of the time.
TEST(Columns, HalfOfTheDirectionsHaveABound) {
  constexpr double kTold = 0.04;  // both are known to 2 %
  const Dynamics dynamics = martinet();
  const UnitMomenta momenta(dynamics, kOrigin, {});
  EXPECT_TRUE(std::isinf(conjugate_bound(dynamics, kOrigin, momenta, 0.125, 2)));
  const double whole = median_conjugate_bound(dynamics, kOrigin, momenta, 1, 2);
  ASSERT_TRUE(std::isfinite(whole));
  for (const double d : {0.1, 1e-3}) {
    const double small = median_conjugate_bound(dynamics, kOrigin, momenta, d, 2);
    EXPECT_NEAR(d * d * small, whole, kTold * whole) << d;
  }
}

TEST(Columns, AreAddedBesideAnAbnormalCurveOnly) {
  const std::vector<Column> columns = columns_of(martinet(), 0.2);
  const auto is_added = [](const Column& column) { return column.added; };
  EXPECT_GE(std::count_if(columns.begin(), columns.end(), is_added), 8);
  for (const Column& column : columns) {
    if (!column.added) continue;
    EXPECT_LT(std::abs(column.c[1]), 0.15) << column.c.transpose();
  }
  const std::vector<Column> even = columns_of(test::unicycle({0, 0, 0}, {0, 0, 0}).dynamics, 0.05);
  EXPECT_EQ(even.size(), 48U);
  EXPECT_EQ(std::count_if(even.begin(), even.end(), is_added), 0);
}

}  // namespace
}  // namespace carnot::internal::columns_test
