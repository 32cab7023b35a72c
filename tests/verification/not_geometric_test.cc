// The laws can fail: explicit Runge-Kutta 4 breaks symplecticity, reversibility and the energy.
#include <gtest/gtest.h>

#include "testing/geometry_laws.h"
#include "testing/runge_kutta4.h"

namespace carnot::not_geometric_test {
namespace {

constexpr double kStep = 0.2;
constexpr int kSteps = 20;
// Errors of a step of order 4 at h = 0.2 are about 1e-5: far above what the laws allow.
constexpr double kClearlyBroken = 1e-8;

class NotGeometricTest : public ::testing::Test {
 protected:
  const VelocityConstraints<scenes::Vehicle> system_{test::uneven<scenes::Vehicle>()};
  test::Generator generator_{1};
  const Vector<double, 8> start_ = test::random_state<4>(generator_).value;
};

TEST_F(NotGeometricTest, SymplecticityFails) {
  Vector<double, 8> z = start_;
  Matrix<double, 8, 8> m = Matrix<double, 8, 8>::Identity();
  for (int i = 0; i < kSteps; ++i) {
    m = (test::runge_kutta4_tangent(system_, kStep, z) * m).eval();
    z = test::runge_kutta4_step(system_, kStep, z);
  }
  EXPECT_GT(test::relative_symplecticity_defect(m), kClearlyBroken);
}

TEST_F(NotGeometricTest, ReversibilityFails) {
  Vector<double, 8> z = start_;
  for (int i = 0; i < kSteps; ++i) z = test::runge_kutta4_step(system_, kStep, z);
  for (int i = 0; i < kSteps; ++i) z = test::runge_kutta4_step(system_, -kStep, z);
  EXPECT_GT(test::relative_distance(z, start_), kClearlyBroken);
}

}  // namespace
}  // namespace carnot::not_geometric_test
