#include "carnot/numerics/gradient.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "testing/random_points.h"

namespace carnot::gradient_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kTolerance = 64 * kEps;  // some ten operations on numbers below 10

// f = x^2 y + sin(y z) / 2 + exp(x z), over any scalar.
struct Example {
  template <class T>
  T operator()(const Vector<T, 3>& q) const {
    using std::exp, std::sin;
    return q[0] * q[0] * q[1] + constant<T>(0.5) * sin(q[1] * q[2]) + exp(q[0] * q[2]);
  }
  static Vector<double, 3> gradient(const Vector<double, 3>& q) {
    const double c = 0.5 * std::cos(q[1] * q[2]);
    const double e = std::exp(q[0] * q[2]);
    return {2 * q[0] * q[1] + q[2] * e, q[0] * q[0] + q[2] * c, q[1] * c + q[0] * e};
  }
  static Matrix<double, 3, 3> hessian(const Vector<double, 3>& q) {
    const double s = 0.5 * std::sin(q[1] * q[2]);
    const double c = 0.5 * std::cos(q[1] * q[2]);
    const double e = std::exp(q[0] * q[2]);
    Matrix<double, 3, 3> h;
    // clang-format off
    h << 2 * q[1] + q[2] * q[2] * e, 2 * q[0],             e * (1 + q[0] * q[2]),
         2 * q[0],                   -q[2] * q[2] * s,     c - q[1] * q[2] * s,
         e * (1 + q[0] * q[2]),      c - q[1] * q[2] * s,  -q[1] * q[1] * s + q[0] * q[0] * e;
    // clang-format on
    return h;
  }
};

TEST(GradientTest, AgreesWithTheDerivativeByHand) {
  test::Generator generator(1);
  for (int sample = 0; sample < 100; ++sample) {
    const Vector<double, 3> q = test::random_vector<3>(generator);
    EXPECT_LE((gradient(Example{}, q) - Example::gradient(q)).cwiseAbs().maxCoeff(), kTolerance);
  }
}

TEST(GradientTest, AtZero) {
  EXPECT_EQ(gradient(Example{}, Vector<double, 3>(0, 0, 0)), (Vector<double, 3>(0, 0, 0)));
}

TEST(GradientTest, LongDouble) {
  const Vector<long double, 3> q(0.3L, -0.7L, 0.2L);
  const long double by_x = 2 * q[0] * q[1] + q[2] * std::exp(q[0] * q[2]);
  const long double error = gradient(Example{}, q)[0] - by_x;
  EXPECT_LE(std::abs(error), 64 * std::numeric_limits<long double>::epsilon());
}

// The gradient of a gradient: nested Jets give the Hessian, symmetric.
TEST(GradientTest, NestsToTheHessian) {
  using J = Jet<double, 3>;
  test::Generator generator(2);
  for (int sample = 0; sample < 100; ++sample) {
    const Vector<double, 3> q = test::random_vector<3>(generator);
    const Vector<J, 3> rows = gradient(Example{}, seeded(q));
    const Matrix<double, 3, 3> exact = Example::hessian(q);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(rows[i].a, Example::gradient(q)[i], kTolerance);
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(rows[i].v[j], exact(i, j), kTolerance);
    }
  }
}

TEST(GradientTest, SeedsAreTheUnitVectors) {
  const auto x = seeded(Vector<double, 2>(3, 4));
  EXPECT_EQ(x[0].a, 3);
  EXPECT_EQ(x[1].a, 4);
  EXPECT_EQ(x[0].v, (Vector<double, 2>(1, 0)));
  EXPECT_EQ(x[1].v, (Vector<double, 2>(0, 1)));
}

TEST(GradientTest, UnseededIsConstant) {
  using J = Jet<double, 2>;
  const auto x = unseeded<J>(Vector<double, 3>(3, 4, 5));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(x[i].a, 3 + i);
    EXPECT_TRUE(x[i].v.isZero(0));
  }
}

TEST(ScalarTest, ConstantsHaveNoDerivativeAtAnyDepth) {
  using J = Jet<Jet<double, 2>, 3>;
  const J half = constant<J>(0.5);
  EXPECT_EQ(value_of(half), 0.5);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(half.v[i].a, 0);
    EXPECT_TRUE(half.v[i].v.isZero(0));
  }
  static_assert(std::is_same_v<Real<J>, double>);
  static_assert(std::is_same_v<Real<Jet<long double, 2>>, long double>);
  EXPECT_EQ(epsilon<J>(), kEps);
}

}  // namespace
}  // namespace carnot::gradient_test
