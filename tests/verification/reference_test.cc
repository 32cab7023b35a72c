// Initial value problems with gauss16 against values of 30 digits found by other methods.
#include "testing/reference.h"

#include <gtest/gtest.h>

#include "carnot/numerics/linear_algebra.h"
#include "testing/program_scenes.h"

namespace carnot::reference_test {
namespace {

using test::Json;

// gauss16 at h = 0.05 is exact to round-off; what is left is the rounding of p0 in double and of
// the steps, amplified by the flow: by up to 100 at T = 10 (see the growth rates in the reference).
constexpr double kStep = 0.05;
constexpr double kTolerance = 1e-12;

// The reference in the coordinates of the scene: x_ours = scale x_reference, p inversely.
template <class Scene>
void check(const Scene& scene,
           const Json& problem,
           double longest,
           const Vector<double, Scene::kDof>& scale,
           double lambda_scale) {
  constexpr int n = Scene::kDof;
  constexpr int k = Scene::kMultipliers;
  const Dynamics dynamics = test::program_dynamics(scene, "gauss16");
  const auto q_of = [&](const Json& v) -> Vector<double, n> {
    return test::numbers<n>(v.at("q")).cwiseProduct(scale);
  };
  const auto p_of = [&](const Json& v) -> Vector<double, n> {
    return test::numbers<n>(v.at("p")).cwiseQuotient(scale);
  };
  const Json& values = problem.at("values");
  int compared = 0;
  for (const Json& value : values) {
    const double time = test::number(value.at("T"));
    if (time > longest) continue;
    Vector<double, 2 * n> z;
    z << q_of(values[0]), p_of(values[0]);
    if (time > 0) {
      ASSERT_TRUE(dynamics.flow(StepPlan::of_length(0, time, kStep), span_of(z)).completed());
    }
    const Vector<double, n> q = z.template head<n>();
    const Vector<double, n> p = z.template tail<n>();
    Vector<double, n> q_dot;
    Vector<double, k> lambda;
    const PointValues point =
        dynamics.evaluate(0, span_of(q), span_of(p), span_of(q_dot), span_of(lambda));
    ASSERT_EQ(point.status, RateStatus::kOk);
    const Vector<double, k> lambda_exact = lambda_scale * test::numbers<k>(value.at("lambda"));
    EXPECT_LE(test::relative_distance(q, q_of(value)), kTolerance) << "T = " << time;
    EXPECT_LE(test::relative_distance(p, p_of(value)), kTolerance) << "T = " << time;
    EXPECT_LE(test::relative_distance(lambda, lambda_exact), 10 * kTolerance) << "T = " << time;
    EXPECT_NEAR(point.hamiltonian, test::number(value.at("H")), kTolerance);
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

struct Source {
  const char* name;
  Json (*read)(const std::string& name);
  const char* file;
};

class ReferenceTest : public ::testing::TestWithParam<Source> {
 protected:
  void SetUp() override {
    data_ = GetParam().read(GetParam().file);
    if (data_.is_null()) GTEST_SKIP() << GetParam().file << " does not stand beside the checkout";
  }
  [[nodiscard]] const Json& scene(const char* name) const { return data_.at("scenes").at(name); }

  Json data_;
};

INSTANTIATE_TEST_SUITE_P(
    From,
    ReferenceTest,
    ::testing::Values(Source{"own", test::own_reference, "initial_values.json"},
                      Source{"shared", test::shared_reference, "ivp.json"}),
    [](const auto& source) { return std::string(source.param.name); });

TEST_P(ReferenceTest, Vehicle) {
  check(scenes::Vehicle{}, scene("vehicle_free_alpha1_beta1_L1"), 10, {1, 1, 1, 1}, 1);
}
TEST_P(ReferenceTest, VehicleCosine) {
  check(scenes::VehicleCosine{}, scene("vehicle_cosr_alpha1_beta1_L1"), 10, {1, 1, 1, 1}, 1);
}
TEST_P(ReferenceTest, Unicycle) { check(scenes::Unicycle{}, scene("se2_beta1"), 10, {1, 1, 1}, 1); }
// The paper's run, p = (0.1, 0.3, 1), to its end at T = 100.
TEST_P(ReferenceTest, Heisenberg) {
  check(scenes::Heisenberg{}, scene("heisenberg_MI"), 100, {1, 1, 1}, 1);
}
// With g = (-y, x, 1) the third coordinate is -2 times ours and its multiplier -1/2.
TEST_P(ReferenceTest, HeisenbergGroup) {
  check(scenes::HeisenbergGroup{}, scene("heisenberg_std_g(-y,x,1)"), 10, {1, 1, -0.5}, -2);
}

TEST(OwnReferenceTest, IsThere) {
  EXPECT_FALSE(test::own_reference("initial_values.json").is_null())
      << "CARNOT_SOURCE_DIR must be the root of the project";
}

}  // namespace
}  // namespace carnot::reference_test
