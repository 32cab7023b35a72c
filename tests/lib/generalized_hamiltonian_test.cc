#include "carnot/system/generalized_hamiltonian.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/flow/flow.h"
#include "carnot/flow/tangent_flow.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/step/runge_kutta.h"
#include "carnot/tableau/gauss_tableau.h"
#include "testing/distance.h"
#include "testing/generalized_scenes.h"
#include "testing/runs.h"

namespace carnot::generalized_hamiltonian_test {
namespace {

using CanonicalVehicle = test::AsGeneralized<scenes::Vehicle>;
using test::distance;
using test::InBasis;
using test::norm;
using Vehicle = VelocityConstraints<scenes::Vehicle>;
using VehicleAnywhere = InBasis<CanonicalVehicle>;
using Anywhere = GeneralizedHamiltonian<VehicleAnywhere>;

constexpr double kEps = std::numeric_limits<double>::epsilon();

const scenes::Vehicle kVehicle = test::uneven<scenes::Vehicle>();
const CanonicalVehicle kCanonical{kVehicle};
const VehicleAnywhere kOwn{kCanonical, identity<10, double>()};

// The paper's start, lambda = 0.
Vector<double, 10> vehicle_start() {
  Vector<double, 10> z = filled<10>(0.0);
  store(test::vehicle_start(Vehicle(kVehicle)).value, z.data());
  return z;
}

// z = T (q, p, y) at a phase point of the system, y solved for.
template <class System>
Vector<double, System::kSize> lifted(const System& system,
                                     const State<double, System::kDof>& state) {
  const auto q = part<0, System::kDof>(state.value);
  const auto p = part<System::kDof, System::kDof>(state.value);
  auto y = filled<System::kAlgebraic>(0.0);
  Rate<double, System::kDof> rate;
  EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
  return system.from_darboux(q, p, y);
}

template <class System>
State<double, System::kDof> start_at(const System& system, const Vector<double, System::kSize>& z) {
  const auto point = system.to_darboux(z);
  return make_state<double, System::kDof>(point.q, point.p);
}

// The Gauss method of order 2s: one instantiation for all s.
template <class System>
RungeKutta<System> method_on(const System& system, const Tableau<double>& tableau) {
  return RungeKutta<System>(system, tableau);
}

// The end of the vehicle's run from the paper's start, (q, p, lambda), with velocity constraints.
Vector<double, 10> vehicle_end(const Tableau<double>& tableau, const StepPlan& plan) {
  const Vehicle system(kVehicle);
  auto method = method_on(system, tableau);
  auto state = test::vehicle_start(system);
  EXPECT_TRUE(flow(method, plan, state).completed());
  const Vector<double, 4> q = part<0, 4>(state.value);
  const Vector<double, 4> p = part<4, 4>(state.value);
  Vector<double, 2> u;
  Rate<double, 4> rate;
  Vector<double, 2> lambda;
  EXPECT_EQ(system.rate(0.0, q, p, u, rate), RateStatus::kOk);
  EXPECT_EQ(system.multipliers(0.0, q, p, u, lambda), RateStatus::kOk);
  Vector<double, 10> z;
  store(state.value, z.data());
  store(lambda, z.data() + 8);
  return z;
}

// The same from the generalized Hamiltonian form in coordinates of its own.
Vector<double, 10> generalized_end(const VehicleAnywhere& scene,
                                   const Tableau<double>& tableau,
                                   const StepPlan& plan) {
  const Anywhere system(scene);
  auto method = method_on(system, tableau);
  auto state = start_at(system, scene.from_original(vehicle_start()));
  EXPECT_TRUE(flow(method, plan, state).completed());
  return product(scene.basis, lifted(system, state));
}

// Prop. 4: Runge-Kutta methods commute with linear maps, so the basis shows by its condition only.
TEST(GeneralizedHamiltonianTest, VehicleInAnyBasis) {
  const StepPlan plan = StepPlan::equal(0, 5, 50);
  for (const int stages : {1, 2, 4}) {
    const auto tableau = gauss_tableau<double>(stages);
    const Vector<double, 10> expected = vehicle_end(tableau, plan);
    for (unsigned seed = 0; seed <= 3; ++seed) {
      const VehicleAnywhere scene = seed == 0 ? kOwn : test::in_random_basis(kCanonical, seed);
      // cond(A) of round-off in the map, and ten by the steps and the tangent of the flow.
      const double tolerance = 10 * scene.condition() * kEps;
      const Vector<double, 10> end = generalized_end(scene, tableau, plan);
      EXPECT_LE(test::relative_distance(end, expected), tolerance) << stages << ", " << seed;
    }
  }
}

// dz/d(q, p) along H_y = 0.
template <class System>
Matrix<double, System::kSize, 2 * System::kDof> tangent_of_graph(
    const System& system, const State<double, System::kDof>& state) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  using J = Jet<double, 2 * n>;
  const Vector<J, 2 * n> x = seeded(state.value);
  const Vector<J, n> q = part<0, n>(x);
  const Vector<J, n> p = part<n, n>(x);
  Vector<J, m> y = filled<m>(J(0));
  Rate<J, n> rate;
  EXPECT_EQ(system.rate(J(0), q, p, y, rate), RateStatus::kOk);
  const Vector<J, System::kSize> z = system.from_darboux(q, p, y);
  Matrix<double, System::kSize, 2 * n> tangent;
  for (int i = 0; i < System::kSize; ++i) {
    for (int j = 0; j < 2 * n; ++j) tangent(i, j) = z[i].v[j];
  }
  return tangent;
}

// Z'J Z, Z the tangent of the flow in the scene's own coordinates, at the start and at the end.
template <class Scene>
void expect_form_is_preserved(const Scene& scene,
                              int stages,
                              const Vector<double, Scene::kSize>& start) {
  using System = GeneralizedHamiltonian<Scene>;
  constexpr int kSize = 2 * System::kDof;
  const System system(scene);
  const Matrix<double, Scene::kSize, Scene::kSize> j = scene.structure_matrix();
  const auto tableau = gauss_tableau<double>(stages);
  auto method = method_on(system, tableau);
  auto state = start_at(system, start);
  const Matrix<double, Scene::kSize, kSize> before = tangent_of_graph(system, state);
  Compensated<Matrix<double, kSize, kSize>> m{identity<kSize, double>(), filled<kSize, kSize>(0.0)};
  const auto go_on = [](long, const auto&, const auto&) { return true; };
  ASSERT_TRUE(tangent_flow(method, StepPlan::equal(0, 3, 30), state, m, go_on).completed());
  const Matrix<double, Scene::kSize, kSize> after =
      product(tangent_of_graph(system, state), m.value);
  const Matrix<double, kSize, kSize> form = transposed_times(after, product(j, after));
  const Matrix<double, kSize, kSize> expected = transposed_times(before, product(j, before));
  EXPECT_GT(distance(after, before), 0.1 * norm(before)) << "something has moved";
  // Round-off of the products of N terms, by their own size.
  const double tolerance = 10 * Scene::kSize * kEps * norm(after) * norm(after) * norm(j);
  EXPECT_LE(test::largest_change(form, expected), tolerance);
}

TEST(GeneralizedHamiltonianTest, PresymplecticFormIsPreserved) {
  for (const int stages : {1, 2, 5}) {
    const auto scene = test::in_random_basis(kCanonical, 6);
    expect_form_is_preserved(scene, stages, scene.from_original(vehicle_start()));
  }
}

// J z' = grad H(z) at random points of H_y = 0 in the scene's own coordinates, z' by Jets.
TEST(GeneralizedHamiltonianTest, RateSolvesTheEquations) {
  const auto scene = test::in_random_basis(kCanonical, 11);
  const Anywhere system(scene);
  test::Generator generator(11);
  for (int sample = 0; sample < 20; ++sample) {
    const auto state = start_at(system, test::random_vector<10>(generator));
    Vector<double, 2> y(0, 0);
    Vector<double, 8> velocity;
    ASSERT_EQ(phase_rate(system, 0.0, state.value, y, velocity), RateStatus::kOk);
    const Vector<double, 10> z = lifted(system, state);
    const Vector<double, 10> z_dot = product(tangent_of_graph(system, state), velocity);
    const Vector<double, 10> slope =
        gradient([&](const auto& x) { return scene.hamiltonian(x); }, z);
    const Vector<double, 10> moved = product(scene.structure_matrix(), z_dot);
    // Two maps by A, of what H_z is made of.
    const double tolerance =
        10 * std::pow(scene.condition(), 2) * kEps * std::max(1.0, norm(z) * norm(z));
    EXPECT_LE(distance(moved, slope), tolerance);
  }
}

TEST(GeneralizedHamiltonianTest, DarbouxCoordinatesAndBack) {
  const auto scene = test::in_random_basis(kCanonical, 12);
  const Anywhere system(scene);
  test::Generator generator(12);
  const auto z = test::random_vector<10>(generator);
  const auto point = system.to_darboux(z);
  const double tolerance = 10 * scene.condition() * kEps;
  EXPECT_LE(distance(system.from_darboux(point.q, point.p, point.y), z), tolerance);
  EXPECT_NEAR(system.hamiltonian(0.0, point.q, point.p, point.y),
              scene.hamiltonian(z),
              tolerance * scene.hamiltonian(z));
  // A canonical J keeps its coordinates.
  const auto own = Anywhere(kOwn).to_darboux(z);
  EXPECT_EQ(test::largest_change(own.q, part<0, 4>(z)), 0);
  EXPECT_EQ(test::largest_change(own.p, part<4, 4>(z)), 0);
  EXPECT_EQ(test::largest_change(own.y, part<8, 2>(z)), 0);
}

// J without a kernel: nothing to solve.
struct Oscillator {
  static constexpr int kSize = 2;
  static constexpr int kDof = 1;
  template <class T>
  [[nodiscard]] T hamiltonian(const Vector<T, 2>& z) const {
    return constant<T>(0.5) * (z[0] * z[0] + z[1] * z[1]);
  }
  // z2' = 2 z1, z1' = -2 z2.
  [[nodiscard]] Matrix<double, 2, 2> structure_matrix() const {
    return Matrix<double, 2, 2>{{0, 0.5}, {-0.5, 0}};
  }
};

TEST(GeneralizedHamiltonianTest, RegularStructure) {
  using System = GeneralizedHamiltonian<Oscillator>;
  static_assert(System::kMultipliers == 0 && IndexOneSystem<System>);
  const System system({});
  const auto state = start_at(system, {0.3, 0.7});
  Vector<double, 0> y;
  Vector<double, 2> velocity;
  ASSERT_EQ(phase_rate(system, 0.0, state.value, y, velocity), RateStatus::kOk);
  const Vector<double, 2> z_dot = product(system.basis(), velocity);
  EXPECT_NEAR(z_dot[0], -2 * 0.7, 4 * kEps);
  EXPECT_NEAR(z_dot[1], 2 * 0.3, 4 * kEps);

  const Vector<double, 1> q = part<0, 1>(state.value);
  const Vector<double, 1> p = part<1, 1>(state.value);
  EXPECT_EQ(system.branch(0, q, p, y, y), RateStatus::kOk);
  EXPECT_EQ(system.regularity(0, q, p, y).condition, 1);
}

}  // namespace
}  // namespace carnot::generalized_hamiltonian_test
