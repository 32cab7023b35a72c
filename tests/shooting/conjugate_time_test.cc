#include "carnot/shooting/rays/conjugate_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "shooting/drift_problems.h"
#include "shooting/problems.h"

namespace carnot::internal::conjugate_time_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 1e-10;  // of the times
constexpr double kPz = 18.4;

// The flat Martinet problem, and the same in coordinates in which the abnormal extremal y = z = 0
// is no straight line: x = u + v^2/5, y = v + 3 w/10 - u^2/10 and z = w - 2 u^2/5.
constexpr const char* kStraight = R"(
coordinates x, y, z
kinetic = (x'^2 + y'^2) / 2
z' = y^2 x' / 2
)";
constexpr const char* kCurved = R"(
coordinates u, v, w
kinetic = ((u' + 0.4 v v')^2 + (v' + 0.3 w' - 0.2 u u')^2) / 2
0 = (v + 0.3 w - 0.1 u^2)^2 (u' + 0.4 v v') / 2 - w' + 0.8 u u'
)";

struct Martinet {
  Dynamics dynamics;
  double slope = 0;  // dy/dw at the origin

  // With p_x < 0, p_y = s and speed 1.
  [[nodiscard]] double conjugate(double s, double pz, double horizon, double p_x = -1) const {
    const std::vector<double> p{std::copysign(std::sqrt(1 - s * s), p_x), s, pz + slope * s};
    return conjugate_time(Ray(dynamics, {0, 0, 0}, p), horizon);
  }
};

Martinet straight() { return {test::from_text(kStraight), 0}; }
Martinet curved() { return {test::from_text(kCurved), 0.3}; }

// The one direction in which an abnormal extremal moves nothing is left out. The others oscillate
// with the frequency sqrt(|p_z|), or do not. A step over a whole turn of theirs goes unseen, and
// the extremal, which is straight, does not tell how far that is.
TEST(ConjugateTime, OfAnAbnormalExtremal) {
  const double expected = kPi / std::sqrt(kPz);
  for (const Martinet& martinet : {straight(), curved()}) {
    for (const double horizon : {1.1, 1.5, 2.2, 10.0, 30.0}) {
      EXPECT_NEAR(martinet.conjugate(0, -kPz, horizon), expected, kTolerance) << horizon;
      EXPECT_NEAR(martinet.conjugate(0, kPz, horizon, 1), expected, kTolerance) << horizon;
    }
    EXPECT_TRUE(std::isinf(martinet.conjugate(0, 0, 3)));
    EXPECT_TRUE(std::isinf(martinet.conjugate(0, kPz, 3)));
  }
}

// Beside it they are others, however near. There one eigenvalue is smaller than the others by the
// square of the distance, and as many digits of its zero are lost.
TEST(ConjugateTime, BesideAnAbnormalExtremal) {
  const double apart = 1e-2;
  const double expected = straight().conjugate(apart, -kPz, 2);
  for (const Martinet& martinet : {straight(), curved()}) {
    for (const double s : {1e-3, 1e-4, 1e-5}) {
      const double round_off = 16 * std::numeric_limits<double>::epsilon() / (s * s);
      for (const double sign : {-1.0, 1.0}) {
        const double t = martinet.conjugate(sign * s, -kPz, 2.2);
        EXPECT_NEAR(t, expected, apart * apart) << s;
        EXPECT_NEAR(martinet.conjugate(sign * s, -kPz, 1.5), t, round_off) << s;
        EXPECT_NEAR(martinet.conjugate(sign * s, -kPz, 1.1), t, round_off) << s;
      }
    }
  }
}

// Dilations of the Engel group change nothing but the scale: x4 is of the third power of the
// length.
TEST(ConjugateTime, DilationsKeepIt) {
  const Dynamics dynamics = test::engel({0, 0, 0, 0}).dynamics;
  const auto time = [&](double d) {
    const std::vector<double> p{std::cos(0.7), std::sin(0.7), 3 / d, 5 / (d * d)};
    return conjugate_time(Ray(dynamics, {0, 0, 0, 0}, p), 9 * d) / d;
  };
  const double whole = time(1);
  ASSERT_TRUE(std::isfinite(whole));
  for (const double d : {1e-2, 1e-3, 1e-4, 1e-5}) EXPECT_NEAR(time(d), whole, kTolerance) << d;
}

}  // namespace
}  // namespace carnot::internal::conjugate_time_test
