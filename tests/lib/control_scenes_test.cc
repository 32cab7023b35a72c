// What the headers of the optimal-control scenes say of them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "carnot/scene/describe_scene.h"
#include "carnot/system/optimal_control.h"
#include "testing/control_scene_list.h"
#include "testing/random_points.h"

namespace carnot::control_scenes_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kRoundOff = 256 * kEps;  // H at points up to 1, momenta up to 2
constexpr int kSamples = 50;

template <class Scene>
class ControlScenesTest : public ::testing::Test {
 protected:
  static constexpr int kDof = Scene::kDof;
  using Q = Vector<double, kDof>;

  const Scene scene_ = test::uneven<Scene>();
  const OptimalControl<Scene> system_{scene_};
  const SceneInfo info_ = describe_scene(scene_);
  test::Generator generator_{1};

  // H(q, p), u eliminated.
  [[nodiscard]] double hamiltonian(const Q& q, const Q& p) const {
    Vector<double, Scene::kControls> u = Vector<double, Scene::kControls>::Zero();
    Rate<double, kDof> rate;
    EXPECT_EQ(system_.rate(0.0, q, p, u, rate), RateStatus::kOk);
    return system_.hamiltonian(0.0, q, p, u);
  }

  // H(map(q, p)) = H(q, p) at random points.
  template <class Map>
  void expect_invariant(const Map& map, const std::string& what) {
    for (int i = 0; i < kSamples; ++i) {
      const Q q = test::random_vector<kDof>(generator_);
      const Q p = test::random_vector<kDof>(generator_, 2);
      Q mapped_q = q;
      Q mapped_p = p;
      map(mapped_q, mapped_p);
      EXPECT_NEAR(hamiltonian(mapped_q, mapped_p), hamiltonian(q, p), kRoundOff) << what;
    }
  }
};
TYPED_TEST_SUITE(ControlScenesTest, test::ControlScenes, test::SceneNames);

TYPED_TEST(ControlScenesTest, DescribeThemselves) {
  constexpr auto kSize = static_cast<std::size_t>(TypeParam::kDof);
  const SceneInfo& info = this->info_;
  EXPECT_FALSE(info.name.empty());
  EXPECT_FALSE(info.summary.empty());
  EXPECT_FALSE(info.reference.empty());
  EXPECT_EQ(info.kind, "optimal control");
  ASSERT_EQ(info.configuration.size(), kSize);
  std::set<std::string> names;
  for (const Coordinate& c : info.configuration) {
    names.insert(c.name);
    EXPECT_FALSE(c.unit.empty());
  }
  EXPECT_EQ(names.size(), kSize);
  for (const auto& mirror : info.symmetries.mirrors) EXPECT_EQ(mirror.size(), kSize);
}

TYPED_TEST(ControlScenesTest, MirrorsLeaveTheHamiltonianInvariant) {
  EXPECT_FALSE(this->info_.symmetries.mirrors.empty());
  for (const auto& mirror : this->info_.symmetries.mirrors) {
    const typename TestFixture::Q d = vector_at<TypeParam::kDof>(mirror.data());
    this->expect_invariant(
        [&](auto& q, auto& p) {
          q = q.cwiseProduct(d).eval();
          p = p.cwiseProduct(d).eval();
        },
        "mirror");
    EXPECT_EQ(d.cwiseProduct(d), d.Ones()) << "a mirror is its own inverse";
  }
}

TYPED_TEST(ControlScenesTest, AnglesHaveTheirPeriod) {
  for (int i = 0; i < TypeParam::kDof; ++i) {
    const double period = this->info_.configuration[static_cast<std::size_t>(i)].period;
    if (period == 0) continue;
    this->expect_invariant([&](auto& q, auto&) { q[i] += period; }, "period");
  }
}

template <class Scene>
class DriftlessScenesTest : public ControlScenesTest<Scene> {};
TYPED_TEST_SUITE(DriftlessScenesTest, test::DriftlessScenes, test::SceneNames);

TYPED_TEST(DriftlessScenesTest, TimeReversal) {
  this->expect_invariant([](auto&, auto& p) { p = -p; }, "reversal");
}

template <class Q>
void rotate(Q& v, double psi) {
  const double x = v[0];
  v[0] = std::cos(psi) * x - std::sin(psi) * v[1];
  v[1] = std::sin(psi) * x + std::cos(psi) * v[1];
}

// Invariants by Noether: the maps of a phase point that leave H invariant.
class GrushinTest : public ControlScenesTest<scenes::Grushin> {};
TEST_F(GrushinTest, ShiftsAlongTheSingularLine) {
  expect_invariant([](auto& q, auto&) { q[1] += 5; }, "p_y");
}

class BrockettTest : public ControlScenesTest<scenes::Brockett> {};
TEST_F(BrockettTest, ShiftsAndTurns) {
  expect_invariant([](auto& q, auto&) { q[2] += 5; }, "p_z");
  expect_invariant(
      [](auto& q, auto& p) {
        rotate(q, 0.7);
        rotate(p, 0.7);
      },
      "x p_y - y p_x");
}

class BicycleTest : public ControlScenesTest<scenes::Bicycle> {};
TEST_F(BicycleTest, RigidMotions) {
  const Symmetries& s = info_.symmetries;
  EXPECT_EQ(s.x, 0);
  EXPECT_EQ(s.y, 1);
  ASSERT_EQ(s.angles, std::vector<int>{2});
  expect_invariant(
      [](auto& q, auto& p) {
        rotate(q, -1.1);
        rotate(p, -1.1);
        q += Vector<double, 4>(3, -2, -1.1, 0);
      },
      "rigid motion");
}

// Rear wheel at (x, y) along theta, front wheel at (x + l cos, y + l sin) along theta + delta.
TEST_F(BicycleTest, NeitherWheelSlips) {
  for (int i = 0; i < kSamples; ++i) {
    const Q q = test::random_vector<4>(generator_);
    const Q v = scene_.frame(q) * test::random_vector<2>(generator_);
    const double front_x = v[0] - scene_.length * std::sin(q[2]) * v[2];
    const double front_y = v[1] + scene_.length * std::cos(q[2]) * v[2];
    const double heading = q[2] + q[3];
    EXPECT_NEAR(front_x * std::sin(heading) - front_y * std::cos(heading), 0, 8 * kEps);
    EXPECT_NEAR(v[0] * std::sin(q[2]) - v[1] * std::cos(q[2]), 0, 8 * kEps);
  }
}

TEST_F(BicycleTest, IsDrawnWithItsLength) {
  const std::array<double, 4> q{1, 2, 0.3, 0.8};
  const auto lines = info_.drawing.body(q.data());
  ASSERT_EQ(lines.size(), 3U);
  const auto& frame = lines[0].points;
  EXPECT_EQ(frame[0][0], q[0]);
  EXPECT_EQ(frame[0][1], q[1]);
  const double length = std::hypot(frame[1][0] - frame[0][0], frame[1][1] - frame[0][1]);
  EXPECT_NEAR(length, scene_.length, 4 * kEps);
  const auto& wheel = lines[2].points;  // the front one
  const double heading = std::atan2(wheel[1][1] - wheel[0][1], wheel[1][0] - wheel[0][0]);
  EXPECT_NEAR(heading, q[2] + q[3], 8 * kEps);
  EXPECT_EQ(info_.extremes.at(0).value(q.data()), q[3]);
}

// The reversal of the header, where p -> -p is none.
class PendulumTest : public ControlScenesTest<scenes::Pendulum> {};
TEST_F(PendulumTest, Reversal) {
  expect_invariant(
      [](auto& q, auto& p) {
        q[1] = -q[1];
        p[0] = -p[0];
      },
      "reversal");
  EXPECT_GT(std::abs(hamiltonian({1, 1}, {1, 1}) - hamiltonian({1, 1}, {-1, -1})), 0.1);
}

class BoatTest : public ControlScenesTest<scenes::Boat> {};
TEST_F(BoatTest, ShiftsAlongTheCurrent) {
  expect_invariant([](auto& q, auto&) { q[0] += 5; }, "p_x");
}

// Both branches of the header: thrust along p, or against it backwards.
TEST_F(BoatTest, BranchesAreThoseOfTheHeader) {
  for (int i = 0; i < kSamples; ++i) {
    const Q q = test::random_vector<2>(generator_);
    const Q p = test::random_vector<2>(generator_, 2);
    Vector<double, 2> u(0, 0);
    Rate<double, 2> rate;
    ASSERT_EQ(system_.rate(0.0, q, p, u, rate), RateStatus::kOk);
    EXPECT_GT(u[0], 0) << "the cold start goes ahead";
    EXPECT_NEAR(u[0] + std::pow(u[0], 3), p.norm(), kRoundOff);
    EXPECT_NEAR(std::remainder(u[1] - std::atan2(p[1], p[0]), 2 * std::numbers::pi), 0, kRoundOff);
    const double square = u[0] * u[0];
    EXPECT_NEAR(system_.hamiltonian(0.0, q, p, u),
                scene_.shear * q[1] * p[0] + 0.5 * square + 0.75 * square * square,
                kRoundOff);
    Vector<double, 2> back(-u[0], u[1] + std::numbers::pi);
    const Vector<double, 2> expected = back;
    Rate<double, 2> back_rate;
    ASSERT_EQ(system_.rate(0.0, q, p, back, back_rate), RateStatus::kOk);
    EXPECT_LE((back - expected).norm(), kRoundOff);
    EXPECT_LE((back_rate.q_dot - rate.q_dot).norm(), kRoundOff);
    EXPECT_LE((back_rate.p_dot - rate.p_dot).norm(), kRoundOff);
  }
}

}  // namespace
}  // namespace carnot::control_scenes_test
