// Extremals in closed form: Martinet by elliptic functions, satellite and ball by rotations; and
// the plane curves that are elasticae.
#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>

#include "testing/attitude.h"
#include "testing/charted_scenes.h"
#include "testing/program_scenes.h"
#include "testing/reference.h"

namespace carnot::velocity_scenes_closed_form_test {
namespace {

using test::Json;

constexpr double kEps = std::numeric_limits<double>::epsilon();

// The end of the extremal from (q, p), and dz(t)/dz(0) where asked for.
template <class Scene>
Vector<double, 2 * Scene::kDof> end(const Scene& scene,
                                    const Vector<double, Scene::kDof>& q,
                                    const Vector<double, Scene::kDof>& p,
                                    double time,
                                    test::TangentState<Scene::kDof>* tangent = nullptr) {
  constexpr long kSteps = 256;  // gauss8 is then exact to round-off
  auto z = make_state<double, Scene::kDof>(q, p);
  auto m = test::identity_tangent<Scene::kDof>();
  const auto run = test::run_of<Scene::kDof>(test::program_dynamics(scene, "gauss8"));
  EXPECT_TRUE(run(time, kSteps, z, m).completed());
  if (tangent != nullptr) *tangent = m;
  return z.value;
}

// Values at u of Jacobi's functions of modulus k, and the integral of dn^2 from 0 to u.
struct Elliptic {
  double sn;
  double cn;
  double dn;
  double square;

  Elliptic(double k, double u) {
    const double quarter = boost::math::ellint_1(k);
    const double turns = std::round(u / (2 * quarter));
    sn = boost::math::jacobi_elliptic(k, u - 2 * turns * quarter, &cn, &dn);
    square = boost::math::ellint_2(k, turns * std::numbers::pi + std::atan2(sn, cn));
    if (std::fmod(turns, 2) != 0) {
      sn = -sn;
      cn = -cn;
    }
  }
};

// The extremal from the origin as martinet.h has it, and z by z' = (x'^2 - p_x x')/p_z,
// x' = v (2 dn^2 - 1) at K + w t, with 3 dn^4 = 2 (2 - k^2) dn^2 - (1 - k^2) + k^2 (sn cn dn)'.
Vector<double, 3> martinet_closed_form(const Vector<double, 3>& p, double t) {
  const Vector<double, 3> mirror(-1, 1, -1);
  if (p[2] < 0) return mirror.cwiseProduct(martinet_closed_form(mirror.cwiseProduct(p), t));
  const double v = std::hypot(p[0], p[1]);
  const double w = std::sqrt(p[2] * v);
  const double square = (1 - p[0] / v) / 2;
  const double k = std::sqrt(square);
  const double quarter = boost::math::ellint_1(k);
  const Elliptic from(k, quarter);
  const Elliptic to(k, quarter + w * t);
  const double dn2 = to.square - from.square;
  const double product = to.sn * to.cn * to.dn - from.sn * from.cn * from.dn;
  const double dn4 = (2 * (2 - square) * dn2 - (1 - square) * w * t + square * product) / 3;
  const double x = v * (2 * dn2 / w - t);
  const Elliptic y(k, w * t);
  const double speed_x2 = v * v * (4 * (dn4 - dn2) / w + t);  // int x'^2 dt
  return {x, p[1] / w * y.sn / y.dn, (speed_x2 - p[0] * x) / p[2]};
}

// In units of sqrt(p_z v) t, where the extremal from the origin meets its mirror image.
double martinet_cut(const Vector<double, 3>& p) {
  const double v = std::hypot(p[0], p[1]);
  const double k = std::sqrt((1 - std::copysign(1.0, p[2]) * p[0] / v) / 2);
  return 2 * boost::math::ellint_1(k);
}

struct Source {
  const char* name;
  Json (*read)(const std::string& name);
};

class MartinetTest : public ::testing::TestWithParam<Source> {
 protected:
  void SetUp() override {
    data_ = GetParam().read("martinet.json");
    if (data_.is_null()) GTEST_SKIP() << "martinet.json does not stand beside the checkout";
  }

  static constexpr double kRoundOff = 200 * kEps;  // 256 steps, or some ten terms up to 5
  const scenes::Martinet scene_{};
  const Vector<double, 3> origin_ = Vector<double, 3>::Zero();
  Json data_;
};

INSTANTIATE_TEST_SUITE_P(From,
                         MartinetTest,
                         ::testing::Values(Source{"own", test::own_reference},
                                           Source{"shared", test::shared_reference}),
                         [](const auto& source) { return std::string(source.param.name); });

TEST_P(MartinetTest, EndPoints) {
  for (const Json& point : data_.at("endpoints_T1")) {
    const auto p = test::numbers<3>(point.at("p0"));
    const auto q = test::numbers<3>(point.at("q"));
    // Rounding p moves the end by |dq/dp| eps, up to |p| eps.
    const double tolerance = kRoundOff * std::max(1.0, p.norm());
    const Vector<double, 3> flown = end(scene_, origin_, p, 1).head<3>();
    EXPECT_LE((flown - q).cwiseAbs().maxCoeff(), tolerance) << p.transpose();
    EXPECT_LE((martinet_closed_form(p, 1) - q).cwiseAbs().maxCoeff(), tolerance) << p.transpose();
  }
  EXPECT_GE(data_.at("endpoints_T1").size(), 5U);
}

// At the cut time y = 0 again, and the mirror image with -p_y arrives at the same point.
TEST_P(MartinetTest, MeetsItsMirrorImageAtTheCutTime) {
  for (const Json& point : data_.at("endpoints_T1")) {
    const auto p = test::numbers<3>(point.at("p0"));
    const double time = test::number(point.at("cut_time"));
    const double rate = std::sqrt(std::abs(p[2]) * std::hypot(p[0], p[1]));
    EXPECT_NEAR(martinet_cut(p) / rate, time, kRoundOff);
    const double tolerance = kRoundOff * std::max(1.0, p.norm());
    const Vector<double, 3> one = end(scene_, origin_, p, time).head<3>();
    const Vector<double, 3> other =
        end(scene_, origin_, p.cwiseProduct(Vector<double, 3>(1, -1, 1)), time).head<3>();
    EXPECT_NEAR(one[1], 0, tolerance);
    EXPECT_LE((one - other).cwiseAbs().maxCoeff(), tolerance);
  }
}

TEST_P(MartinetTest, DistancesAreTheLengthsOfExtremals) {
  for (const Json& pair : data_.at("distances")) {
    const auto p = test::numbers<3>(pair.at("p0_T1"));
    const auto target = test::numbers<3>(pair.at("target"));
    const double tolerance = kRoundOff * std::max(1.0, p.norm());
    const Vector<double, 3> flown = end(scene_, origin_, p, 1).head<3>();
    EXPECT_LE((flown - target).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_NEAR(std::hypot(p[0], p[1]), test::number(pair.at("distance")), tolerance);
  }
}

// det dq/dp0 has its first zero at the conjugate time, after the cut.
TEST_P(MartinetTest, ConjugateTimes) {
  constexpr double kNear = 1e-6;  // relative: far above round-off of the determinant
  for (const Json& entry : data_.at("conjugate")) {
    const double k = test::number(entry.at("k"));
    const double conjugate = test::number(entry.at("conj_sqrt_lambda_t"));
    const Vector<double, 3> p(1 - 2 * k * k, 2 * k * std::sqrt(1 - k * k), 1);  // v = p_z = 1
    EXPECT_NEAR(martinet_cut(p), test::number(entry.at("cut_sqrt_lambda_t")), kRoundOff);
    const auto determinant = [&](double t) {
      test::TangentState<3> m;
      end(scene_, origin_, p, t, &m);
      const Matrix<double, 3, 3> by_momentum = m.value.topRightCorner<3, 3>();
      return by_momentum.determinant();
    };
    const double before = determinant(conjugate * (1 - kNear));
    EXPECT_LT(before * determinant(conjugate * (1 + kNear)), 0) << "k = " << k;
    for (const double t : {0.3, 0.5, martinet_cut(p) / conjugate, 0.9}) {
      EXPECT_GT(before * determinant(t * conjugate), 0) << "k = " << k << " at " << t;
    }
  }
}

TEST(MartinetReferenceTest, IsThere) {
  EXPECT_FALSE(test::own_reference("martinet.json").is_null())
      << "CARNOT_SOURCE_DIR must be the root of the project";
}

// R(t) = R(0) exp(t hat(m(0))/j) Rz(-t m_z/j) where j1 = j2 = j.
TEST(SatelliteClosedFormTest, EqualInertias) {
  constexpr double kTolerance = 500 * kEps;  // 256 steps, angles by quotients with cos theta
  test::Generator generator(1);
  for (const double j : {0.8, 1.0, 2.5}) {
    const scenes::Satellite scene{j, j};
    for (int sample = 0; sample < 5; ++sample) {
      const auto z = test::regular_state(scene, generator).value;
      const Vector<double, 3> m = test::body_momenta(z.head<3>(), z.tail<3>());
      const Matrix<double, 3, 3> exact = test::attitude(z[0], z[1], z[2]) * test::rotation(m / j) *
                                         test::rotation({0, 0, -m[2] / j});
      const auto last = end(scene, z.head<3>().eval(), z.tail<3>().eval(), 1);
      const Matrix<double, 3, 3> flown = test::attitude(last[0], last[1], last[2]);
      EXPECT_LE((flown - exact).cwiseAbs().maxCoeff(), kTolerance);
    }
  }
}

// p_x = p_y = 0: a circle, and R(t) = Rz(-t p_psi) exp(t hat(s(0))) R(0).
TEST(PlateBallClosedFormTest, CircularTracks) {
  constexpr double kTolerance = 500 * kEps;
  const scenes::PlateBall scene;
  test::Generator generator(2);
  for (int sample = 0; sample < 10; ++sample) {
    auto z = test::regular_state(scene, generator).value;
    z[5] = z[6] = 0;
    const double turn = z[7];
    const Matrix<double, 3, 3> start = test::attitude(z[2], z[3], z[4]);
    const Vector<double, 3> s = start * test::body_momenta(z.segment<3>(2), z.tail<3>());
    const Matrix<double, 3, 3> exact = test::rotation({0, 0, -turn}) * test::rotation(s) * start;
    const std::complex<double> i(0, 1);
    const std::complex<double> chord =
        std::complex<double>(s[1], -s[0]) * (std::exp(-i * turn) - 1.0) / (-i * turn);
    const auto last = end(scene, z.head<5>().eval(), z.tail<5>().eval(), 1);
    const Matrix<double, 3, 3> flown = test::attitude(last[2], last[3], last[4]);
    EXPECT_LE((flown - exact).cwiseAbs().maxCoeff(), kTolerance);
    EXPECT_NEAR(last[0] - z[0], chord.real(), kTolerance / std::abs(turn));
    EXPECT_NEAR(last[1] - z[1], chord.imag(), kTolerance / std::abs(turn));
  }
}

// The rate at which the velocity u of the plane curve turns, by a Jet along the flow.
template <class Scene>
double turning(const Vector<double, Scene::kDof>& q, const Vector<double, Scene::kDof>& p) {
  constexpr int n = Scene::kDof;
  using Along = Jet<double, 1>;
  const VelocityConstraints<Scene> system{Scene{}};
  Vector<double, 2> u;
  Rate<double, n> rate;
  EXPECT_EQ(system.rate(0.0, q, p, u, rate), RateStatus::kOk);
  Vector<Along, n> moving_q;
  Vector<Along, n> moving_p;
  for (int i = 0; i < n; ++i) {
    moving_q[i] = Along(q[i], Vector<double, 1>(rate.q_dot[i]));
    moving_p[i] = Along(p[i], Vector<double, 1>(rate.p_dot[i]));
  }
  Vector<Along, 2> v;
  Rate<Along, n> unused;
  EXPECT_EQ(system.rate(Along(0), moving_q, moving_p, v, unused), RateStatus::kOk);
  return (u[0] * v[1].v[0] - u[1] * v[0].v[0]) / u.squaredNorm();
}

// An elastica turns at a rate that is linear along its plane.
TEST(ElasticaTest, PlaneCurvesTurnAsTheirHeadersSay) {
  constexpr double kTolerance = 1000 * kEps;  // over |u|^2, which may be small
  test::Generator generator(3);
  for (int sample = 0; sample < 30; ++sample) {
    const auto a = test::regular_state(scenes::Martinet{}, generator).value;
    EXPECT_NEAR(turning<scenes::Martinet>(a.head<3>(), a.tail<3>()), -a[5] * a[1], kTolerance);
    const auto b = test::regular_state(scenes::Engel{}, generator).value;
    EXPECT_NEAR(turning<scenes::Engel>(b.head<4>(), b.tail<4>()), b[6] + b[0] * b[7], kTolerance);
    const auto c = test::regular_state(scenes::PlateBall{}, generator).value;
    EXPECT_NEAR(turning<scenes::PlateBall>(c.head<5>(), c.tail<5>()), -c[7], kTolerance);
  }
}

}  // namespace
}  // namespace carnot::velocity_scenes_closed_form_test
