// Newton's method for H_y = 0: systems with solutions in closed form, with two branches, with none.
#include "carnot/system/stationary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "testing/random_points.h"

namespace carnot::stationary_test {
namespace {

constexpr double kEps = epsilon<double>();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class T>
using One = Vector<T, 1>;

template <class T>
One<T> one(const T& x) {
  return One<T>(x);
}

// H = p.y - |y|^2 (1 + q1^2)/2 - (y1^4 + y2^4)/4: p = (1 + q1^2) y + y^3, one solution.
struct Cubic {
  static constexpr int kDof = 2;
  static constexpr int kAlgebraic = 2;

  template <class T>
  [[nodiscard]] static T mass(const Vector<T, 2>& q) {
    return constant<T>(1) + q[0] * q[0];
  }
  template <class T>
  [[nodiscard]] T hamiltonian(const T& /*t*/,
                              const Vector<T, 2>& q,
                              const Vector<T, 2>& p,
                              const Vector<T, 2>& y) const {
    T h = dot(p, y) - constant<T>(0.5) * mass(q) * dot(y, y);
    for (int i = 0; i < 2; ++i) h -= constant<T>(0.25) * y[i] * y[i] * y[i] * y[i];
    return h;
  }
};

// H = p cos y + q sin y: y = atan2(q, p), where H is a maximum, and the opposite point, a minimum.
// q' = cos y and p' = -sin y. At q = p = 0 every y is a solution.
struct Circle {
  static constexpr int kDof = 1;
  static constexpr int kAlgebraic = 1;

  template <class T>
  [[nodiscard]] T hamiltonian(const T& t, const One<T>& q, const One<T>& p, const One<T>& y) const {
    using std::cos, std::sin;
    return p[0] * cos(y[0]) + q[0] * sin(y[0]) + t * constant<T>(0);
  }
};

struct CircleFromTheLeft : Circle {
  template <class T>
  [[nodiscard]] One<T> cold_start(const T& /*t*/, const One<T>& /*q*/, const One<T>& /*p*/) const {
    return one(T(3));
  }
};

// H = p y - f(y) with f' as a member.
template <class F>
struct Scalar {
  static constexpr int kDof = 1;
  static constexpr int kAlgebraic = 1;

  template <class T>
  [[nodiscard]] T hamiltonian(const T& /*t*/,
                              const One<T>& /*q*/,
                              const One<T>& p,
                              const One<T>& y) const {
    return p[0] * y[0] - F::f(y[0]);
  }
};
struct Exponential {  // y = log p
  template <class T>
  static T f(const T& y) {
    using std::exp;
    return exp(y);
  }
};
struct Fold {  // y^2 - 2 y + 1 = p: two solutions, one, none
  template <class T>
  static T f(const T& y) {
    return y * y * y / constant<T>(3) - y * y + y;
  }
};
struct Linear {  // H_yy = 0
  template <class T>
  static T f(const T& y) {
    return y;
  }
};

struct NoAlgebraic {
  static constexpr int kDof = 1;
  static constexpr int kAlgebraic = 0;

  template <class T>
  [[nodiscard]] T hamiltonian(const T& t,
                              const One<T>& q,
                              const One<T>& p,
                              const Vector<T, 0>& /*y*/) const {
    return constant<T>(0.5) * p[0] * p[0] + t * q[0] * q[0] * q[0];
  }
};

// Solves from y; y is the solution on exit.
template <class System>
RateStatus solve(const System& system, double q, double p, double& y) {
  One<double> x(y);
  Rate<double, 1> rate;
  const RateStatus status = stationary_rate(system, 0.0, one(q), one(p), x, rate);
  y = x[0];
  return status;
}

// ----- convergence

template <class T>
void expect_round_off() {
  // Newton's last step leaves the rounding of H_y, about an eps per term of it.
  const T tolerance = T(8) * epsilon<T>();
  test::Generator generator(1);
  for (const double scale : {1e-6, 1.0, 1e3}) {
    for (int sample = 0; sample < 20; ++sample) {
      const Vector<T, 2> q = test::random_vector<2>(generator).cast<T>();
      const Vector<T, 2> y = test::random_vector<2>(generator, scale).cast<T>();
      const Vector<T, 2> p = Cubic::mass(q) * y + y.cwiseProduct(y).cwiseProduct(y);
      Vector<T, 2> found = Vector<T, 2>::Constant(T(0));
      Rate<T, 2> rate;
      ASSERT_EQ(stationary_rate(Cubic{}, T(0), q, p, found, rate), RateStatus::kOk);
      EXPECT_LE((found - y).norm(), tolerance * y.norm());
      EXPECT_EQ(rate.q_dot, found);
      EXPECT_NEAR(static_cast<double>((rate.p_dot[0] - q[0] * y.squaredNorm()) / y.squaredNorm()),
                  0,
                  static_cast<double>(T(4) * tolerance));
      // Warm, from the solution of a neighbour.
      Vector<T, 2> warm = T(1.1) * y;
      ASSERT_EQ(stationary_rate(Cubic{}, T(0), q, p, warm, rate), RateStatus::kOk);
      EXPECT_LE((warm - y).norm(), tolerance * y.norm());
    }
  }
}

TEST(StationaryTest, ConvergesToRoundOff) { expect_round_off<double>(); }
TEST(StationaryTest, ConvergesToRoundOffInLongDouble) { expect_round_off<long double>(); }

TEST(StationaryTest, NoAlgebraicVariables) {
  using J = Jet<double, 2>;
  Vector<double, 0> y;
  Rate<double, 1> rate;
  ASSERT_EQ(stationary_rate(NoAlgebraic{}, 2.0, one(3.0), one(5.0), y, rate), RateStatus::kOk);
  EXPECT_EQ(rate.q_dot[0], 5);
  EXPECT_EQ(rate.p_dot[0], -54);
  Vector<J, 0> yj;
  Rate<J, 1> rj;
  ASSERT_EQ(stationary_rate(NoAlgebraic{}, J(2.0), one(J(3.0, 0)), one(J(5.0, 1)), yj, rj),
            RateStatus::kOk);
  EXPECT_EQ(rj.q_dot[0].v, Eigen::Vector2d(0, 1));
  EXPECT_EQ(rj.p_dot[0].v, Eigen::Vector2d(-36, 0));
  const Regularity regularity = stationary_regularity(NoAlgebraic{}, 2.0, one(3.0), one(5.0), y);
  EXPECT_EQ(regularity.determinant, 1);
  EXPECT_EQ(regularity.condition, 1);
}

// ----- branches

// Each branch is followed once around, from the solution of the step before, in steps of any size
// that leaves no doubt which branch is meant.
TEST(StationaryTest, StaysOnItsBranch) {
  for (const double start : {0.0, std::numbers::pi}) {
    for (const int steps : {5, 7, 100}) {
      double y = start == 0 ? 1e-3 : start;
      for (int i = 1; i <= steps; ++i) {
        const double angle = 2 * std::numbers::pi * i / steps;
        ASSERT_EQ(solve(Circle{}, std::sin(angle), std::cos(angle), y), RateStatus::kOk);
        EXPECT_NEAR(y, start + angle, 16 * kEps);  // of angles up to 3 pi
      }
    }
  }
}

// A quarter of a turn, almost: the first Newton step is a thousand turns long.
TEST(StationaryTest, ALongStepIsNotTaken) {
  for (const double angle : {1.0, 1.5, 1.57, -1.57}) {
    for (const double turns : {0.0, 2 * std::numbers::pi}) {
      double y = turns + 1e-6;
      ASSERT_EQ(solve(Circle{}, std::sin(angle), std::cos(angle), y), RateStatus::kOk);
      EXPECT_NEAR(y, turns + angle, 16 * kEps);
    }
  }
}

TEST(StationaryTest, TheSystemMayKnowAGoodStart) {
  double y = 0;
  ASSERT_EQ(solve(CircleFromTheLeft{}, 0.1, 1, y), RateStatus::kOk);
  EXPECT_NEAR(y, std::numbers::pi + std::atan2(0.1, 1), 4 * kEps);
  y = 0.1;  // a warm start comes first
  ASSERT_EQ(solve(CircleFromTheLeft{}, 0.1, 1, y), RateStatus::kOk);
  EXPECT_NEAR(y, std::atan2(0.1, 1), 4 * kEps);
}

TEST(StationaryTest, EachSideOfAFoldKeepsItsSolution) {
  for (const double p : {4.0, 1e-2, 1e-6}) {
    for (const double side : {-1.0, 1.0}) {
      double y = 1 + side * 1.5 * std::sqrt(p);
      ASSERT_EQ(solve(Scalar<Fold>{}, 0, p, y), RateStatus::kOk);
      EXPECT_NEAR(y, 1 + side * std::sqrt(p), 8 * kEps / std::sqrt(p));  // condition of the root
    }
  }
}

// ----- failures: a reason, and y as it was

TEST(StationaryTest, NoSolution) {
  double y = 0;
  EXPECT_EQ(solve(Scalar<Exponential>{}, 0, 2, y), RateStatus::kOk);
  EXPECT_NEAR(y, std::log(2), 4 * kEps);
  for (const double start : {0.0, 2.0, -30.0}) {
    y = start;
    EXPECT_EQ(solve(Scalar<Exponential>{}, 0, -1, y), RateStatus::kNoSolution);
    EXPECT_EQ(y, start);
    EXPECT_EQ(solve(Scalar<Fold>{}, 0, -1, y), RateStatus::kNoSolution);
    EXPECT_EQ(y, start);
  }
}

TEST(StationaryTest, NotOfIndexOne) {
  for (const double start : {0.0, 0.5}) {
    double y = start;
    EXPECT_EQ(solve(Circle{}, 0, 0, y), RateStatus::kNotIndexOne);
    EXPECT_EQ(solve(Scalar<Linear>{}, 0, 2, y), RateStatus::kNotIndexOne);
    EXPECT_EQ(solve(Scalar<Fold>{}, 0, 0, y), RateStatus::kNotIndexOne);  // a double root
    EXPECT_EQ(y, start);
  }
}

TEST(StationaryTest, NotFinite) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    for (const double start : {0.0, 0.5}) {
      double y = start;
      EXPECT_EQ(solve(Circle{}, bad, 1, y), RateStatus::kNotFinite);
      EXPECT_EQ(solve(Circle{}, 1, bad, y), RateStatus::kNotFinite);
      EXPECT_EQ(y, start);
    }
    double y = bad;
    EXPECT_EQ(solve(Circle{}, 1, 1, y), RateStatus::kNotFinite);
  }
}

TEST(StationaryTest, RegularityOfTheHessian) {
  // H_yy = -(p cos y + q sin y).
  const auto at = [](double q, double p, double y) {
    return stationary_regularity(Circle{}, 0.0, one(q), one(p), one(y));
  };
  EXPECT_NEAR(at(3, 4, std::atan2(3, 4)).determinant, -5, 8 * kEps);
  EXPECT_NEAR(at(3, 4, std::atan2(3, 4)).condition, 1, 4 * kEps);
  EXPECT_EQ(at(0, 0, 1).determinant, 0);
  EXPECT_EQ(at(0, 0, 1).condition, std::numeric_limits<double>::infinity());
  // H_yy = -diag(1 + 3 y^2).
  const Vector<double, 2> zero(0, 0);
  const auto cubic = stationary_regularity(Cubic{}, 0.0, zero, zero, Vector<double, 2>(0, 2));
  EXPECT_NEAR(cubic.determinant, 13, 32 * kEps);
  EXPECT_NEAR(cubic.condition, 13, 32 * kEps);
}

// ----- derivatives

// q' = p/r, p' = -q/r with r = |(q, p)| on the branch of the maximum, and its derivatives up to
// second order.
TEST(StationaryTest, NestedJetsAgreeWithTheClosedForm) {
  using J = Jet<double, 2>;
  using JJ = Jet<J, 2>;
  const Vector<double, 2> z(0.6, -1.1);  // (q, p)
  const Vector<JJ, 2> zj = seeded(seeded(z));
  One<JJ> y(JJ(J(-2.0)));
  Rate<JJ, 1> rate;
  const JJ t = constant<JJ>(0);
  ASSERT_EQ(stationary_rate(Circle{}, t, one(zj[0]), one(zj[1]), y, rate), RateStatus::kOk);
  const JJ r = sqrt(zj[0] * zj[0] + zj[1] * zj[1]);
  const double sign = -1 * std::cos(y[0].a.a) > 0 ? 1 : -1;  // which of the two it found
  const JJ expected[2] = {zj[1] / r, -zj[0] / r};
  const JJ found[2] = {rate.q_dot[0], rate.p_dot[0]};
  constexpr double kTolerance = 16 * kEps;  // a few operations each, second derivatives below 2
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(found[k].a.a, sign * expected[k].a.a, kTolerance);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(found[k].a.v[i], sign * expected[k].a.v[i], kTolerance);
      EXPECT_NEAR(found[k].v[i].a, sign * expected[k].v[i].a, kTolerance);
      for (int j = 0; j < 2; ++j) {
        EXPECT_NEAR(found[k].v[i].v[j], sign * expected[k].v[i].v[j], kTolerance);
      }
    }
  }
}

TEST(StationaryTest, JetsAgreeWithDifferences) {
  using J = Jet<double, 4>;
  constexpr double kStep = 1e-4;
  constexpr double kTolerance = 1e-7;  // kStep^2 times third derivatives, up to 10 here
  test::Generator generator(2);
  for (int sample = 0; sample < 10; ++sample) {
    const Vector<double, 4> z = test::random_vector<4>(generator, 2);
    const auto rate_at = [&](const Vector<double, 4>& x) {
      Vector<double, 2> y(0, 0);
      Rate<double, 2> rate;
      EXPECT_EQ(stationary_rate(Cubic{},
                                0.0,
                                Vector<double, 2>(x.head<2>()),
                                Vector<double, 2>(x.tail<2>()),
                                y,
                                rate),
                RateStatus::kOk);
      Vector<double, 4> z_dot;
      z_dot << rate.q_dot, rate.p_dot;
      return z_dot;
    };
    const Vector<J, 4> zj = seeded(z);
    Vector<J, 2> y(J(0.0), J(0.0));
    Rate<J, 2> rate;
    ASSERT_EQ(stationary_rate(
                  Cubic{}, J(0.0), Vector<J, 2>(zj.head<2>()), Vector<J, 2>(zj.tail<2>()), y, rate),
              RateStatus::kOk);
    const Vector<double, 4> value = rate_at(z);
    for (int i = 0; i < 4; ++i) {
      const Vector<double, 4> by_differences = (rate_at(z + kStep * Vector<double, 4>::Unit(i)) -
                                                rate_at(z - kStep * Vector<double, 4>::Unit(i))) /
                                               (2 * kStep);
      for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(rate.q_dot[k].a, value[k]);
        EXPECT_NEAR(rate.q_dot[k].v[i], by_differences[k], kTolerance);
        EXPECT_NEAR(rate.p_dot[k].v[i], by_differences[2 + k], kTolerance);
      }
    }
  }
}

}  // namespace
}  // namespace carnot::stationary_test
