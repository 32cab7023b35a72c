// The laws of a scene with velocity constraints, on those with charts and many symmetries.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "testing/charted_scenes.h"
#include "testing/distance.h"
#include "testing/scene_wrappers.h"

namespace carnot::velocity_scenes_test {
namespace {

using test::largest_change;

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Points in [-2, 2]^n where 1 / chart^2 is below 7, momenta up to 2: products up to 1000, and two
// solves.
constexpr double kRoundOff = 4000 * kEps;
constexpr int kSamples = 60;

// What a system says at one phase point. Never inlined, so that it compiles once for all laws.
template <class System>
struct Answer {
  Vector<double, System::kAlgebraic> y = filled<System::kAlgebraic>(0.0);
  Rate<double, System::kDof> rate;
  Vector<double, System::kMultipliers> lambda;
  double hamiltonian;

  [[gnu::noinline]] Answer(const System& system,
                           const Vector<double, System::kDof>& q,
                           const Vector<double, System::kDof>& p) {
    EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    EXPECT_EQ(system.multipliers(0.0, q, p, y, lambda), RateStatus::kOk);
    hamiltonian = system.hamiltonian(0.0, q, p, y);
  }
};

template <class Scene>
class VelocityScenesTest : public ::testing::Test {
 protected:
  static constexpr int kDof = Scene::kDof;
  static constexpr int kFrame = Scene::kDof - Scene::kMultipliers;
  using Q = Vector<double, kDof>;
  using Reduced = Matrix<double, kFrame, kFrame>;
  using System = VelocityConstraints<Scene>;
  using Plain = VelocityConstraints<test::WithoutFrame<Scene>>;
  using ByJets = VelocityConstraints<test::WithoutHandDerivatives<Scene>>;
  struct Point {
    Q q;
    Q p;
  };

  // The hard points by hand, then random ones.
  VelocityScenesTest() {
    points_ = {{filled<kDof>(0.0), filled<kDof>(1.0)},
               {filled<kDof>(0.0), filled<kDof>(0.0)},
               {filled<kDof>(1e-8), filled<kDof>(-1e-8)}};
    test::Generator generator(11);
    for (int i = 0; i < kSamples; ++i) {
      const Q q = test::regular_configuration(scene_, generator, 2);
      points_.push_back({q, test::random_vector<kDof>(generator, 2)});
    }
  }

  // The largest |H(map(q, p)) - H(q, p)|, y eliminated.
  [[nodiscard]] double change_of_hamiltonian(const std::function<void(Q& q, Q& p)>& map) const {
    double largest = 0;
    for (const auto& [q, p] : points_) {
      Point mapped{q, p};
      map(mapped.q, mapped.p);
      const double before = Answer(system_, q, p).hamiltonian;
      const double after = Answer(system_, mapped.q, mapped.p).hamiltonian;
      largest = std::max(largest, std::abs(after - before));
    }
    return largest;
  }

  const Scene scene_ = test::uneven_scene<Scene>();
  const System system_{scene_};
  const Plain plain_{{scene_}};
  const ByJets by_jets_{{scene_}};
  const SceneInfo info_ = scene_.info();
  std::vector<Point> points_;
};
TYPED_TEST_SUITE(VelocityScenesTest, test::ChartedScenes, test::SceneNames);

TYPED_TEST(VelocityScenesTest, WriteFrameAndGradient) {
  static_assert(HasFrame<TypeParam> && HasFrameGradient<TypeParam>);
  static_assert(!HasPotential<TypeParam>);
  static_assert(IndexOneSystem<VelocityConstraints<TypeParam>>);
}

TYPED_TEST(VelocityScenesTest, FrameSpansTheKernel) {
  for (const auto& [q, p] : this->points_) {
    const auto b = this->scene_.frame(q);
    // Entries of G and B up to 6.
    EXPECT_LE(largest_entry(product(this->scene_.constraints(q), b)), 64 * kEps);
    const typename TestFixture::Reduced gram = transposed_times(b, b);
    EXPECT_TRUE((Cholesky<double, TestFixture::kFrame>(gram).positive()));
  }
}

TYPED_TEST(VelocityScenesTest, MassIsSymmetricAndPositiveOnTheKernel) {
  for (const auto& [q, p] : this->points_) {
    const auto mass = this->scene_.mass(q);
    const auto b = this->scene_.frame(q);
    EXPECT_LE(largest_change(mass, test::transposed(mass)), 16 * kEps);
    typename TestFixture::Reduced reduced = transposed_times(b, product(mass, b));
    EXPECT_TRUE((Cholesky<double, TestFixture::kFrame>(reduced).positive()));
    if constexpr (HasFrameMass<TypeParam>) {
      EXPECT_LE(largest_change(reduced, this->scene_.frame_mass(q)), 256 * kEps);
    }
    if constexpr (HasOrthogonalFrame<TypeParam>) {
      const auto masses = this->scene_.frame_masses(q);
      for (int i = 0; i < TestFixture::kFrame; ++i) reduced(i, i) -= masses[i];
      EXPECT_LE(largest_entry(reduced), 256 * kEps);
    }
  }
}

TYPED_TEST(VelocityScenesTest, FrameRouteAgreesWithMultiplierRoute) {
  for (const auto& [q, p] : this->points_) {
    const Answer a(this->system_, q, p);
    const Answer b(this->plain_, q, p);
    EXPECT_LE(largest_change(a.rate.q_dot, b.rate.q_dot), kRoundOff);
    EXPECT_LE(largest_change(a.rate.p_dot, b.rate.p_dot), kRoundOff);
    EXPECT_LE(largest_change(a.lambda, b.lambda), kRoundOff);
    EXPECT_NEAR(a.hamiltonian, b.hamiltonian, kRoundOff);
  }
}

TYPED_TEST(VelocityScenesTest, HandDerivativesAgreeWithJets) {
  for (const auto& [q, p] : this->points_) {
    const Answer a(this->system_, q, p);
    const Answer b(this->by_jets_, q, p);
    EXPECT_LE(largest_change(a.y, b.y), kRoundOff);
    EXPECT_LE(largest_change(a.rate.q_dot, b.rate.q_dot), kRoundOff);
    EXPECT_LE(largest_change(a.rate.p_dot, b.rate.p_dot), kRoundOff);
  }
}

TYPED_TEST(VelocityScenesTest, RunInLongDouble) {
  using Long = Vector<long double, TypeParam::kDof>;
  for (const auto& [q, p] : this->points_) {
    const Answer a(this->system_, q, p);
    Long long_q, long_p;
    std::copy_n(q.data(), TypeParam::kDof, long_q.data());
    std::copy_n(p.data(), TypeParam::kDof, long_p.data());
    Vector<long double, TestFixture::kFrame> u;
    Rate<long double, TypeParam::kDof> b;
    ASSERT_EQ(this->system_.rate(0.0L, long_q, long_p, u, b), RateStatus::kOk);
    for (int i = 0; i < TypeParam::kDof; ++i) {
      EXPECT_NEAR(a.rate.q_dot[i], static_cast<double>(b.q_dot[i]), kRoundOff);
      EXPECT_NEAR(a.rate.p_dot[i], static_cast<double>(b.p_dot[i]), kRoundOff);
    }
  }
}

TYPED_TEST(VelocityScenesTest, DescribeThemselves) {
  const SceneInfo& info = this->info_;
  EXPECT_FALSE(info.name.empty());
  EXPECT_FALSE(info.summary.empty());
  EXPECT_FALSE(info.reference.empty());
  ASSERT_EQ(info.configuration.size(), static_cast<std::size_t>(TypeParam::kDof));
  std::set<std::string> names;
  for (const Coordinate& c : info.configuration) {
    names.insert(c.name);
    EXPECT_FALSE(c.unit.empty());
    EXPECT_EQ(c.unit == "rad", c.period > 0);
  }
  EXPECT_EQ(names.size(), info.configuration.size());
}

TYPED_TEST(VelocityScenesTest, DrawingIsFinite) {
  const Drawing& drawing = this->info_.drawing;
  EXPECT_NE(drawing.view, Drawing::View::kTimeOnly);
  for (const int axis : drawing.axes) EXPECT_LT(axis, TypeParam::kDof);
  for (const auto& [q, p] : this->points_) {
    std::vector<Polyline> lines;
    if (drawing.body) lines = drawing.body(q.data());
    EXPECT_EQ(lines.empty(), !drawing.body);
    for (const Polyline& line : lines) {
      EXPECT_GE(line.points.size(), 2U);
      for (const auto& [x, y] : line.points) EXPECT_TRUE(std::isfinite(x) && std::isfinite(y));
    }
    for (const Extreme& e : this->info_.extremes) EXPECT_TRUE(std::isfinite(e.value(q.data())));
  }
}

// Of all the diagonal maps D the declared ones, and no others, leave H invariant.
TYPED_TEST(VelocityScenesTest, MirrorsAreAllThatThereAre) {
  constexpr unsigned n = TypeParam::kDof;
  std::set<std::vector<double>> declared;
  for (const auto& mirror : this->info_.symmetries.mirrors) declared.insert(mirror);
  EXPECT_EQ(declared.size(), this->info_.symmetries.mirrors.size());
  for (unsigned signs = 1; signs < 1U << n; ++signs) {
    std::vector<double> mirror(n);
    for (unsigned i = 0; i < n; ++i) mirror[i] = (signs >> i & 1U) != 0 ? -1 : 1;
    const double change = this->change_of_hamiltonian([&](auto& q, auto& p) {
      for (unsigned i = 0; i < n; ++i) {
        q[i] *= mirror[i];
        p[i] *= mirror[i];
      }
    });
    if (declared.count(mirror) == 1) {
      EXPECT_LE(change, kRoundOff) << "mirror " << ::testing::PrintToString(mirror);
    } else {
      EXPECT_GT(change, 0.01) << "not declared: " << ::testing::PrintToString(mirror);
    }
  }
}

TYPED_TEST(VelocityScenesTest, TimeReversal) {
  const auto reverse = [](auto&, auto& p) {
    for (int i = 0; i < TypeParam::kDof; ++i) p[i] = -p[i];
  };
  EXPECT_LE(this->change_of_hamiltonian(reverse), kRoundOff);
}

TYPED_TEST(VelocityScenesTest, AnglesHaveTheirPeriod) {
  for (int i = 0; i < TypeParam::kDof; ++i) {
    const double period = this->info_.configuration[static_cast<std::size_t>(i)].period;
    if (period == 0) continue;
    const auto turn = [&](auto& q, auto&) { q[i] += period; };
    EXPECT_LE(this->change_of_hamiltonian(turn), kRoundOff) << i;
  }
}

template <class Scene>
class PlanarMotionsTest : public VelocityScenesTest<Scene> {};
TYPED_TEST_SUITE(PlanarMotionsTest, test::MorePlanarScenes, test::SceneNames);

TYPED_TEST(PlanarMotionsTest, LeaveTheHamiltonianInvariant) {
  const Symmetries& s = this->info_.symmetries;
  ASSERT_EQ(s.x, 0);
  ASSERT_EQ(s.y, 1);
  ASSERT_FALSE(s.angles.empty());
  constexpr double kTurn = 0.7;
  const auto turn = [](auto& x) {
    const double ahead = x[0];
    x[0] = std::cos(kTurn) * ahead - std::sin(kTurn) * x[1];
    x[1] = std::sin(kTurn) * ahead + std::cos(kTurn) * x[1];
  };
  const double change = this->change_of_hamiltonian([&](auto& q, auto& p) {
    turn(q);
    turn(p);
    q[0] += 3;
    q[1] -= 2;
    for (const int angle : s.angles) q[angle] += kTurn;
  });
  EXPECT_LE(change, kRoundOff);
}

template <class Scene>
class SingularChartTest : public VelocityScenesTest<Scene> {};
TYPED_TEST_SUITE(SingularChartTest, test::ChartScenes, test::SceneNames);

TYPED_TEST(SingularChartTest, HasItsReasonCode) {
  const double quarter = std::acos(0.0);
  const std::size_t theta = TypeParam::kDof == 3 ? 1 : 3;
  ASSERT_EQ(this->info_.configuration[theta].name, "theta");
  test::Generator generator(5);
  for (const double singular : {quarter, -quarter, 3 * quarter}) {
    for (const double off : {0.0, 1e-9, 1e-6}) {
      auto q = test::random_vector<TypeParam::kDof>(generator);
      const auto p = test::random_vector<TypeParam::kDof>(generator);
      q[theta] = singular + off;
      EXPECT_NEAR(std::abs(this->scene_.chart(q)), off, 4 * kEps);
      Vector<double, TestFixture::System::kAlgebraic> u;
      Rate<double, TypeParam::kDof> rate;
      const RateStatus status = this->system_.rate(0.0, q, p, u, rate);
      EXPECT_EQ(status, off < 1e-8 ? RateStatus::kChart : RateStatus::kOk) << off;
    }
  }
}

TEST(VelocitySceneParametersTest, AreCheckedAgainstTheirRange) {
  EXPECT_NO_THROW(validate(scenes::Trailers<2>{0}));
  EXPECT_THROW(validate(scenes::Trailers<2>{-0.1}), std::invalid_argument);
  EXPECT_NO_THROW(validate(scenes::Satellite{0.1, 10}));
  EXPECT_THROW(validate(scenes::Satellite{0, 1}), std::invalid_argument);
  EXPECT_THROW(validate(scenes::Satellite{1, -1}), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::velocity_scenes_test
