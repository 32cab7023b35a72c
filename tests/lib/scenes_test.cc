// What the headers of the scenes say of them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "carnot/flow/flow.h"
#include "carnot/step/gauss.h"
#include "testing/reference.h"
#include "testing/runs.h"

namespace carnot::scenes_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kRoundOff = 256 * kEps;  // H at points up to 2: products up to 100
constexpr int kSamples = 50;

template <class Scene>
class ScenesTest : public ::testing::Test {
 protected:
  static constexpr int kDof = Scene::kDof;
  using Q = Vector<double, kDof>;

  const Scene scene_ = test::uneven<Scene>();
  const VelocityConstraints<Scene> system_{scene_};
  const SceneInfo info_ = scene_.info();
  test::Generator generator_{1};

  // H(q, p), y eliminated.
  [[nodiscard]] double hamiltonian(const Q& q, const Q& p) const {
    Vector<double, VelocityConstraints<Scene>::kAlgebraic> y;
    Rate<double, kDof> rate;
    EXPECT_EQ(system_.rate(0.0, q, p, y, rate), RateStatus::kOk);
    return system_.hamiltonian(0.0, q, p, y);
  }

  // H(map(q, p)) = H(q, p) at random points.
  template <class Map>
  void expect_invariant(const Map& map, const std::string& what) {
    for (int i = 0; i < kSamples; ++i) {
      const Q q = test::random_vector<kDof>(generator_, 2);
      const Q p = test::random_vector<kDof>(generator_, 2);
      Q mapped_q = q;
      Q mapped_p = p;
      map(mapped_q, mapped_p);
      EXPECT_NEAR(hamiltonian(mapped_q, mapped_p), hamiltonian(q, p), kRoundOff) << what;
    }
  }
};
TYPED_TEST_SUITE(ScenesTest, test::Scenes, test::SceneNames);

TYPED_TEST(ScenesTest, DescribeThemselves) {
  constexpr auto n = static_cast<std::size_t>(TypeParam::kDof);
  const SceneInfo& info = this->info_;
  EXPECT_FALSE(info.name.empty());
  EXPECT_FALSE(info.summary.empty());
  EXPECT_FALSE(info.reference.empty());
  ASSERT_EQ(info.configuration.size(), n);
  std::set<std::string> names;
  for (const Coordinate& c : info.configuration) {
    names.insert(c.name);
    EXPECT_FALSE(c.unit.empty());
  }
  EXPECT_EQ(names.size(), n);
  for (const auto& mirror : info.symmetries.mirrors) EXPECT_EQ(mirror.size(), n);
}

TYPED_TEST(ScenesTest, MirrorsLeaveTheHamiltonianInvariant) {
  EXPECT_FALSE(this->info_.symmetries.mirrors.empty());
  for (const auto& mirror : this->info_.symmetries.mirrors) {
    const Vector<double, TypeParam::kDof> d = vector_at<TypeParam::kDof>(mirror.data());
    this->expect_invariant(
        [&](auto& q, auto& p) {
          q = q.cwiseProduct(d).eval();
          p = p.cwiseProduct(d).eval();
        },
        "mirror");
    EXPECT_EQ(d.cwiseProduct(d), d.Ones()) << "a mirror is its own inverse";
  }
}

TYPED_TEST(ScenesTest, TimeReversal) {
  this->expect_invariant([](auto&, auto& p) { p = -p; }, "reversal");
}

TYPED_TEST(ScenesTest, AnglesHaveTheirPeriod) {
  for (int i = 0; i < TypeParam::kDof; ++i) {
    const double period = this->info_.configuration[static_cast<std::size_t>(i)].period;
    if (period == 0) continue;
    this->expect_invariant([&](auto& q, auto&) { q[i] += period; }, "period");
  }
}

template <class Q>
void rotate(Q& v, int x, int y, double psi) {
  const double vx = v[x];
  v[x] = std::cos(psi) * vx - std::sin(psi) * v[y];
  v[y] = std::sin(psi) * vx + std::cos(psi) * v[y];
}

template <class Scene>
class PlanarScenesTest : public ScenesTest<Scene> {};
TYPED_TEST_SUITE(PlanarScenesTest, test::PlanarScenes, test::SceneNames);

// Shifts and turns of the plane, where the scene claims them.
TYPED_TEST(PlanarScenesTest, RigidMotionsLeaveTheHamiltonianInvariant) {
  const Symmetries& s = this->info_.symmetries;
  ASSERT_GE(s.x, 0) << "claims no rigid motions of the plane";
  const double psi = 0.7;
  this->expect_invariant(
      [&](auto& q, auto& p) {
        rotate(q, s.x, s.y, psi);
        rotate(p, s.x, s.y, psi);
        for (const int angle : s.angles) q[angle] += psi;
        q[s.x] += 3;
        q[s.y] -= 2;
      },
      "rigid motion");
}

// Turns about the origin: x p_y - y p_x + (momenta of the angles) is an invariant of every scene.
TYPED_TEST(ScenesTest, TurnsAboutTheOriginLeaveTheHamiltonianInvariant) {
  this->expect_invariant(
      [&](auto& q, auto& p) {
        constexpr double kPsi = -1.1;
        rotate(q, 0, 1, kPsi);
        rotate(p, 0, 1, kPsi);
        for (int i = 2; i < TypeParam::kDof; ++i) {
          if (this->info_.configuration[static_cast<std::size_t>(i)].period > 0) q[i] += kPsi;
        }
      },
      "turn");
}

// dp/dt = 0 for coordinates that H does not read: p_x, p_y without a potential, p_z of Heisenberg.
TYPED_TEST(ScenesTest, ShiftsOfCyclicCoordinates) {
  const std::string name = this->info_.name;
  const bool plane = name == "vehicle" || name == "unicycle";
  const bool heisenberg = name == "heisenberg" || name == "heisenberg-group";
  this->expect_invariant(
      [&](auto& q, auto&) {
        if (plane) q[0] += 5;
        if (plane) q[1] -= 7;
        if (heisenberg) q[2] += 3;
      },
      "shift");
}

// The rear wheel of the vehicle, at (x - l cos theta, y - l sin theta), moves along the body.
TEST(VehicleTest, NeitherWheelSlips) {
  const auto vehicle = test::uneven<scenes::Vehicle>();
  test::Generator generator(2);
  for (int i = 0; i < kSamples; ++i) {
    const auto q = test::random_vector<4>(generator, 3);
    const Vector<double, 4> v = vehicle.frame(q) * test::random_vector<2>(generator);
    const double rear_x = v[0] + vehicle.length * std::sin(q[2]) * v[2];
    const double rear_y = v[1] - vehicle.length * std::cos(q[2]) * v[2];
    EXPECT_NEAR(rear_x * std::sin(q[2]) - rear_y * std::cos(q[2]), 0, 8 * kEps);
    EXPECT_NEAR(v[0] * std::sin(q[3]) - v[1] * std::cos(q[3]), 0, 8 * kEps);
  }
}

TEST(VehicleTest, IsDrawnWithItsLength) {
  const auto vehicle = test::uneven<scenes::Vehicle>();
  const std::array<double, 4> q{1, 2, 0.3, 0.8};
  const auto lines = vehicle.info().drawing.body(q.data());
  ASSERT_EQ(lines.size(), 3U);
  const auto& body = lines[0].points;
  EXPECT_EQ(body.front(), body.back());  // an outline
  const auto middle = [&](std::size_t wheel, std::size_t i) {
    return (lines[wheel].points[0][i] + lines[wheel].points[1][i]) / 2;
  };
  EXPECT_NEAR(middle(2, 0), q[0], 4 * kEps);
  EXPECT_NEAR(middle(2, 1), q[1], 4 * kEps);
  const double length = std::hypot(middle(2, 0) - middle(1, 0), middle(2, 1) - middle(1, 1));
  EXPECT_NEAR(length, vehicle.length, 4 * kEps);
}

TEST(VehicleCosineTest, PotentialIsMinusCosineOfTheDistance) {
  const auto scene = test::uneven<scenes::VehicleCosine>();
  test::Generator generator(3);
  for (int i = 0; i < kSamples; ++i) {
    const auto q = test::random_vector<4>(generator, 5);
    const double half = 0.5 * scene.length;
    const double r = std::hypot(q[0] - half * std::cos(q[2]), q[1] - half * std::sin(q[2]));
    EXPECT_NEAR(scene.potential(q), -std::cos(r), 16 * kEps);
  }
}

// gauss16 from the origin.
Vector<double, 3> heisenberg_group_end(const Vector<double, 3>& p, double t) {
  using System = VelocityConstraints<scenes::HeisenbergGroup>;
  const System system{{}};
  Gauss<System, 8> step(system);
  auto z = make_state<double, 3>(Vector<double, 3>(0, 0, 0), p);
  EXPECT_TRUE(flow(step, StepPlan::equal(0, t, 64), z).completed());
  return z.value.head<3>();
}

TEST(HeisenbergGroupTest, FlowFollowsTheClosedForm) {
  using scenes::HeisenbergGroup;
  constexpr double kTurn = 2 * std::numbers::pi;
  for (const double w : {0.0, 1e-8, 1e-3, 1.0, -2.0, kTurn, 10.0}) {
    const Vector<double, 3> p(0.6, -0.8, w);
    const Vector<double, 3> exact = HeisenbergGroup::closed_form(p, 1);
    EXPECT_LE((heisenberg_group_end(p, 1) - exact).cwiseAbs().maxCoeff(), 64 * kEps) << w;
  }
  // After a full turn the plane curve is closed and z is the area of the disc, 1 / (4 pi).
  const Vector<double, 3> closed = HeisenbergGroup::closed_form({1, 0, kTurn}, 1);
  EXPECT_NEAR(closed[0], 0, 4 * kEps);
  EXPECT_NEAR(closed[1], 0, 4 * kEps);
  EXPECT_NEAR(closed[2], 1 / (2 * kTurn), 4 * kEps);
}

// The distances and momenta that may stand beside the checkout.
TEST(HeisenbergGroupTest, SharedReference) {
  const test::Json data = test::shared_reference("heisenberg_group.json");
  if (data.is_null()) GTEST_SKIP() << "heisenberg_group.json does not stand beside the checkout";
  int compared = 0;
  for (const auto& point : data.at("points")) {
    if (!point.contains("p0_T1_zeta_coords")) continue;
    const auto p = test::numbers<3>(point.at("p0_T1_zeta_coords"));
    const Vector<double, 3> end(
        test::number(point.at("x")), test::number(point.at("y")), test::number(point.at("zeta")));
    // Rounding p moves the end by |dq/dp| eps, up to |p| eps.
    const double tolerance = 64 * kEps * std::max(1.0, p.norm());
    const Vector<double, 3> closed = scenes::HeisenbergGroup::closed_form(p, 1);
    EXPECT_LE((closed - end).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((heisenberg_group_end(p, 1) - end).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_NEAR(std::hypot(p[0], p[1]), test::number(point.at("distance")), tolerance);
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

}  // namespace
}  // namespace carnot::scenes_test
