// Nothing is allocated inside a step, a flow or a tangent flow: malloc itself is counted, so
// Eigen's own allocations and operator new are seen too. The counter is tested first.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include "carnot/flow/tangent_flow.h"
#include "carnot/step/gauss.h"
#include "carnot/tableau/make_tableau.h"
#include "carnot/tableau/methods.h"
#include "testing/allocation_counter.h"
#include "testing/runs.h"

namespace carnot::no_allocation_test {
namespace {

#ifdef CARNOT_TEST_COUNTS_MALLOC

using test::allocations_in;

// Hides a pointer from the optimiser, which may else remove the allocation.
void keep(const void* pointer) { asm volatile("" : : "g"(pointer) : "memory"); }

TEST(AllocationCounterTest, SeesEveryKind) {
  EXPECT_EQ(allocations_in([] {}), 0);
  EXPECT_EQ(allocations_in([] { keep(std::make_unique<int>(1).get()); }), 1);
  EXPECT_EQ(allocations_in([] { keep(std::vector<double>(10).data()); }), 1);
  EXPECT_GE(allocations_in([] { keep(Eigen::VectorXd(10).data()); }), 1);
  EXPECT_EQ(allocations_in([] {
              void* p = std::calloc(3, 5);
              keep(p);
              p = std::realloc(p, 1000);
              keep(p);
              std::free(p);
            }),
            2);
  // A dynamic product has a temporary: the kind of slip that this test is for.
  const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(20, 20);
  Eigen::MatrixXd b = a;
  EXPECT_GE(allocations_in([&] { b = a * b; }), 1);
}

template <class Scene, int s>
void expect_no_allocation(const Tableau<double, s>& tableau, double h, bool newton) {
  using System = VelocityConstraints<Scene>;
  using Step = RungeKutta<System, s>;
  constexpr int kSize = Step::kSize;
  const System system(test::uneven<Scene>());
  test::Generator generator(1);
  long newton_steps = 0;
  for (int sample = 0; sample < 20; ++sample) {
    const auto start = test::random_state<Scene::kDof>(generator);
    const StepPlan plan = StepPlan::equal(0, 3 * h, 3);
    FlowReport report;
    EXPECT_EQ(allocations_in([&] {
                Step step(system, tableau);
                auto z = start;
                report = flow(step, plan, z);
              }),
              0);
    newton_steps += report.newton_steps;
    EXPECT_EQ(allocations_in([&] {
                using Square = Matrix<double, kSize, kSize>;
                Step step(system, tableau);
                auto z = start;
                Compensated<Square> m{Square::Identity(), Square::Zero()};
                report = tangent_flow(
                    step, plan, z, m, [](long, const Step&, const auto&) { return true; });
              }),
              0);
  }
  EXPECT_EQ(newton_steps > 0, newton) << newton_steps;
}

template <class Scene, int s>
void expect_no_allocation(double h, bool newton) {
  expect_no_allocation<Scene, kKnownStages<double, s>>(fixed_gauss_tableau<double, s>(), h, newton);
}

constexpr double kFixedPointStep = 0.1;
constexpr double kNewtonStep = 2;

TEST(NoAllocationTest, MidpointRule) {
  expect_no_allocation<scenes::VehicleCosine, 1>(kFixedPointStep, false);
  expect_no_allocation<scenes::VehicleCosine, 1>(kNewtonStep, true);
}
// The largest linear systems: 64 unknowns.
TEST(NoAllocationTest, EightStages) {
  expect_no_allocation<scenes::VehicleCosine, 8>(kFixedPointStep, false);
  expect_no_allocation<scenes::VehicleCosine, 8>(kNewtonStep, true);
}
TEST(NoAllocationTest, HeisenbergGroup) {
  expect_no_allocation<scenes::HeisenbergGroup, 4>(kFixedPointStep, false);
}
// Full, diagonal, partitioned and explicit, with the number of stages known at run time.
TEST(NoAllocationTest, EveryCoupling) {
  for (const char* name : {"gauss24", "midpoint8", "lobatto4", "dop853"}) {
    const Tableau<double> tableau = make_tableau(*find_method(name));
    expect_no_allocation<scenes::VehicleCosine>(tableau, kFixedPointStep, false);
    if (tableau.coupling == Coupling::kExplicit) continue;
    expect_no_allocation<scenes::VehicleCosine>(tableau, kNewtonStep, true);
  }
}

#else

TEST(NoAllocationTest, CannotBeCounted) {
  GTEST_SKIP() << "allocations are counted with glibc and without sanitizers only";
}

#endif

}  // namespace
}  // namespace carnot::no_allocation_test
