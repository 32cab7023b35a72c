// Flows of the scenes with charts and many symmetries: invariants, symplecticity, reversibility.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "testing/attitude.h"
#include "testing/charted_scenes.h"
#include "testing/program_scenes.h"

namespace carnot::velocity_scenes_flow_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// What the header of each scene says is kept, besides H.
std::vector<double> invariants(const scenes::Martinet&, const Vector<double, 6>& z) {
  return {z[3], z[5]};
}
std::vector<double> invariants(const scenes::Engel&, const Vector<double, 8>& z) {
  const Vector<double, 4> p = z.tail<4>();
  const double h2 = p[1] + z[0] * p[2] / 2 + (z[0] * z[0] + z[1] * z[1]) * p[3] / 2;
  const double h3 = p[2] + z[0] * p[3];
  return {p[2],
          p[3],
          p[0] + z[1] * p[2] / 2 + (z[2] + z[0] * z[1] / 2) * p[3],
          p[1] - z[0] * p[2] / 2 + z[1] * z[1] * p[3] / 2,
          h3 * h3 / 2 - h2 * p[3]};
}
std::vector<double> invariants(const scenes::Trailers<3>&, const Vector<double, 12>& z) {
  return {z[6], z[7], z[0] * z[7] - z[1] * z[6] + z.tail<4>().sum()};
}
std::vector<double> invariants(const scenes::Satellite&, const Vector<double, 6>& z) {
  const Vector<double, 3> m = test::body_momenta(z.head<3>(), z.tail<3>());
  const Vector<double, 3> in_space = test::attitude(z[0], z[1], z[2]) * m;
  EXPECT_NEAR(in_space[2], z[3], 16 * kEps) << "the turn about the vertical is that of psi";
  return {z[3], in_space[0], in_space[1], m.norm()};
}
std::vector<double> invariants(const scenes::PlateBall&, const Vector<double, 10>& z) {
  const Vector<double, 3> m = test::body_momenta(z.segment<3>(2), z.tail<3>());
  EXPECT_NEAR(m[0], z[9], 16 * kEps) << "the turn about the body's x axis is that of phi";
  return {z[5], z[6], z[9], z[0] * z[6] - z[1] * z[5] + z[7], m[1], m[2]};
}
std::vector<double> invariants(const scenes::FallingCat&, const Vector<double, 6>& z) {
  return {z[3]};
}

// Coordinates that H does not read.
std::vector<int> cyclic(const scenes::Martinet&) { return {0, 2}; }
std::vector<int> cyclic(const scenes::Engel&) { return {2, 3}; }
std::vector<int> cyclic(const scenes::Trailers<3>&) { return {0, 1}; }
std::vector<int> cyclic(const scenes::Satellite&) { return {0}; }
std::vector<int> cyclic(const scenes::PlateBall&) { return {0, 1, 4}; }
std::vector<int> cyclic(const scenes::FallingCat&) { return {0}; }

template <class Scene>
class VelocityScenesFlowTest : public ::testing::Test {
 protected:
  static constexpr int kDof = Scene::kDof;
  using System = VelocityConstraints<Scene>;

  void run(double duration, long steps, State<double, kDof>& z, test::TangentState<kDof>& m) const {
    const FlowReport report = run_(duration, steps, z, m);
    ASSERT_TRUE(report.completed()) << report.reason();
  }

  [[nodiscard]] double hamiltonian(const Vector<double, 2 * kDof>& z) const {
    const Vector<double, kDof> q = z.template head<kDof>();
    const Vector<double, kDof> p = z.template tail<kDof>();
    Vector<double, System::kAlgebraic> y;
    Rate<double, kDof> rate;
    EXPECT_EQ(system_.rate(0.0, q, p, y, rate), RateStatus::kOk);
    return system_.hamiltonian(0.0, q, p, y);
  }

  const Scene scene_ = test::uneven_scene<Scene>();
  const System system_{scene_};
  const test::Run<kDof> run_ = test::run_of<kDof>(test::program_dynamics(scene_, "gauss8"));
  test::Generator generator_{1};
};
TYPED_TEST_SUITE(VelocityScenesFlowTest, test::ChartedScenes, test::SceneNames);

// With steps so small that the method is exact to round-off, all are kept, whatever their form.
TYPED_TEST(VelocityScenesFlowTest, KeepsItsInvariants) {
  constexpr double kTolerance = 500 * kEps;  // 64 steps, numbers up to 10
  for (int sample = 0; sample < 5; ++sample) {
    const auto start = test::regular_state(this->scene_, this->generator_);
    auto z = start;
    auto m = test::identity_tangent<TypeParam::kDof>();
    this->run(1, 64, z, m);
    EXPECT_GT((z.value - start.value).cwiseAbs().maxCoeff(), 0.01) << "nothing moves";
    EXPECT_NEAR(this->hamiltonian(z.value), this->hamiltonian(start.value), kTolerance);
    const std::vector<double> before = invariants(this->scene_, start.value);
    const std::vector<double> after = invariants(this->scene_, z.value);
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_NEAR(after[i], before[i], kTolerance) << "invariant " << i;
    }
  }
}

// p' = 0 exactly, whatever the step.
TYPED_TEST(VelocityScenesFlowTest, KeepsTheMomentaOfCyclicCoordinatesBitForBit) {
  const auto start = test::regular_state(this->scene_, this->generator_);
  auto z = start;
  auto m = test::identity_tangent<TypeParam::kDof>();
  this->run(1, 4, z, m);
  for (int i = 0; i < TypeParam::kDof; ++i) {
    const std::vector<int> kept = cyclic(this->scene_);
    const int j = TypeParam::kDof + i;
    if (std::find(kept.begin(), kept.end(), i) != kept.end()) {
      EXPECT_EQ(z.value[j], start.value[j]) << i;
    } else {
      EXPECT_NE(z.value[j], start.value[j]) << i << " is cyclic too";
    }
  }
}

TYPED_TEST(VelocityScenesFlowTest, IsSymplectic) {
  constexpr double kDefect = 1e-14;  // about 50 eps: round-off of the products, per |M|^2
  for (const long steps : {4L, 20L}) {
    auto z = test::regular_state(this->scene_, this->generator_);
    auto m = test::identity_tangent<TypeParam::kDof>();
    this->run(1, steps, z, m);
    EXPECT_LE(test::relative_symplecticity_defect(m.value), kDefect);
  }
}

TYPED_TEST(VelocityScenesFlowTest, IsReversible) {
  constexpr double kTolerance = 1e3 * 20 * kEps;  // 20 steps, amplified by |M|, below 1e3 here
  const auto start = test::regular_state(this->scene_, this->generator_);
  auto z = start;
  auto m = test::identity_tangent<TypeParam::kDof>();
  this->run(1, 20, z, m);
  auto back = z;
  this->run(-1, 20, back, m);
  EXPECT_LE(test::relative_distance(back.value, start.value), kTolerance);
  auto mirrored = test::flipped<double, TypeParam::kDof>(z);
  this->run(1, 20, mirrored, m);
  mirrored = test::flipped<double, TypeParam::kDof>(mirrored);
  EXPECT_LE(test::relative_distance(mirrored.value, start.value), kTolerance);
}

}  // namespace
}  // namespace carnot::velocity_scenes_flow_test
