// The tangent of one step, for every kind of coupling, against the step itself.
#include "carnot/step/tangent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/flow/tangent_flow.h"
#include "carnot/step/gauss.h"
#include "testing/counting_system.h"
#include "testing/distance.h"
#include "testing/method_runs.h"
#include "testing/oscillator.h"

namespace carnot::tangent_test {
namespace {

using test::Generator;
using test::largest_change;
using test::Oscillator;
using System = VelocityConstraints<scenes::VehicleCosine>;
// Differences need the room below double.
using T = long double;
using Step = RungeKutta<System, kAnyStages, T>;
using Square = Matrix<T, 8, 8>;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr T kWideEps = std::numeric_limits<T>::epsilon();
constexpr int kSteps = 3;

const System& cosine() {
  static const System kSystem(test::uneven<scenes::VehicleCosine>());
  return kSystem;
}

using TangentTest = test::MethodTest;
INSTANTIATE_TEST_SUITE_P(Representatives,
                         TangentTest,
                         ::testing::ValuesIn(test::kRepresentatives),
                         test::method_test_name);

template <class U, int n>
Compensated<Matrix<U, n, n>> identity_map() {
  return {identity<n, U>(), filled<n, n>(U(0))};
}

// A few steps with their tangent; the first from the rate, the others from what the last one left.
Square run(const Tableau<T>& tableau, const State<T, 4>& start, const T& h) {
  Step step(cosine(), tableau);
  Tangent<Step> tangent;
  Compensated<Square> m = identity_map<T, 8>();
  State<T, 4> z = start;
  for (int i = 0; i < kSteps; ++i) {
    EXPECT_EQ(step.step(T(i) * h, h, z).status, StepStatus::kOk);
    EXPECT_TRUE(tangent.advance(step, m));
  }
  return m.value;
}

Vector<T, 8> end_point(const Tableau<T>& tableau, const State<T, 4>& start, const T& h) {
  Step step(cosine(), tableau);
  State<T, 4> z = start;
  for (int i = 0; i < kSteps; ++i) {
    EXPECT_EQ(step.step(T(i) * h, h, z).status, StepStatus::kOk);
  }
  return z.value;
}

TEST_P(TangentTest, IsTheDerivativeOfTheStep) {
  // Central differences: third derivatives times d^2, and round-off over d.
  constexpr T kDifference = 1e-6L;
  constexpr double kTolerance = 1e-10;
  const auto tableau = test::tableau_of<T>(name_);
  const T h = 0.2L;
  Generator generator(1);
  for (int sample = 0; sample < 5; ++sample) {
    const auto start = test::cast_state<T, 4>(test::random_state<4>(generator));
    const Square m = run(tableau, start, h);
    const T size = std::max(T(1), largest_entry(m));
    for (int j = 0; j < 8; ++j) {
      auto above = start;
      auto below = start;
      above.value[j] += kDifference;
      below.value[j] -= kDifference;
      const Vector<T, 8> right = end_point(tableau, above, h);
      const Vector<T, 8> left = end_point(tableau, below, h);
      T error(0);
      for (int i = 0; i < 8; ++i) {
        const T slope = (right[i] - left[i]) / (above.value[j] - below.value[j]);
        error = maximum(error, std::abs(slope - m(i, j)));
      }
      EXPECT_LE(static_cast<double>(error / size), kTolerance) << "column " << j;
    }
  }
}

// M'JM = J, for the symplectic ones, and for no other.
TEST_P(TangentTest, IsSymplecticWhereTheMethodIs) {
  const auto tableau = test::tableau_of<T>(name_);
  // Round-off of s stages and of products of 8 x 8 matrices.
  const double tolerance = 64.0 * tableau.stages() * static_cast<double>(kWideEps);
  Generator generator(2);
  double largest = 0;
  for (int sample = 0; sample < 10; ++sample) {
    const auto start = test::cast_state<T, 4>(test::random_state<4>(generator));
    const Square m = run(tableau, start, 0.4L);
    const T size = std::max(T(1), largest_entry(m));
    largest = std::max(largest, static_cast<double>(symplecticity_defect(m) / (size * size)));
  }
  if (find_method(name_)->symplectic) {
    EXPECT_LE(largest, tolerance);
  } else {
    EXPECT_GE(largest, 1e-9) << "yet it is not claimed to be";
  }
}

// Of a linear system the step is its tangent; with a stiff one the fixed points do not contract.
TEST_P(TangentTest, OfALinearSystemIsTheStep) {
  using Linear = RungeKutta<Oscillator>;
  for (const double stiffness : {1.0, 1e4}) {
    if (!implicit() && stiffness > 1) continue;  // far from stable there
    const Oscillator system{stiffness};
    Linear step(system, tableau_);
    Tangent<Linear> tangent;
    const Vector<double, 2> start(0.3, -0.8);
    State<double, 1> z{start, filled<2>(0.0)};
    using Small = Matrix<double, 2, 2>;
    Compensated<Small> m = identity_map<double, 2>();
    for (int i = 0; i < 10; ++i) {
      ASSERT_EQ(step.step(i, 1, z).status, StepStatus::kOk);
      ASSERT_TRUE(tangent.advance(step, m));
      const Vector<double, 2> image = product(m.value, start);
      // Ten steps, each with round-off amplified by (h w)^2.
      const double tolerance = 64 * (i + 1) * stiffness * kEps;
      EXPECT_LE(largest_change(z.value, image), tolerance * largest_entry(m.value));
    }
  }
}

TEST_P(TangentTest, OfAStepOfLengthZeroIsTheIdentity) {
  const auto tableau = test::tableau_of<T>(name_);
  Step step(cosine(), tableau);
  Tangent<Step> tangent;
  Generator generator(3);
  auto z = test::cast_state<T, 4>(test::random_state<4>(generator));
  Compensated<Square> m = identity_map<T, 8>();
  ASSERT_EQ(step.step(0, 0, z).status, StepStatus::kOk);
  ASSERT_TRUE(tangent.advance(step, m));
  EXPECT_EQ(largest_change(m.value, identity<8, T>()), 0);
}

// The first guess decides the cost only: a new Tangent for each step gives the same.
TEST_P(TangentTest, WarmStartDoesNotChangeIt) {
  const auto tableau = test::tableau_of<T>(name_);
  Step step(cosine(), tableau);
  Tangent<Step> warm;
  Generator generator(4);
  auto z = test::cast_state<T, 4>(test::random_state<4>(generator));
  Compensated<Square> a = identity_map<T, 8>();
  Compensated<Square> b = a;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(step.step(T(i) / 10, 0.1L, z).status, StepStatus::kOk);
    Tangent<Step> cold;
    ASSERT_TRUE(warm.advance(step, a));
    ASSERT_TRUE(cold.advance(step, b));
    const T size = std::max(T(1), largest_entry(a.value));
    const T error = largest_change(a.value, b.value);
    EXPECT_LE(error, T(32 * (i + 1)) * kWideEps * size);
  }
}

// Side by side in packs, as where the compiler knows the number of stages, or one by one.
TEST(TangentInPacks, AgreesWithThatOfOneStageAtATime) {
  constexpr int kStages = 8;
  using Small = Matrix<double, 8, 8>;
  const auto tableau = test::tableau_of<double>("gauss16");
  const auto fixed_tableau = fixed_stages<kStages>(tableau);
  Generator generator(5);
  for (const double h : {0.05, 0.2, 0.4}) {
    const auto start = test::random_state<4>(generator);
    RungeKutta<System> plain(cosine(), tableau);
    RungeKutta<System, kStages> packed(cosine(), fixed_tableau);
    Tangent<RungeKutta<System>> plain_tangent;
    Tangent<RungeKutta<System, kStages>> packed_tangent;
    Compensated<Small> a = identity_map<double, 8>();
    Compensated<Small> b = a;
    auto za = start;
    auto zb = start;
    for (int i = 0; i < 6; ++i) {
      ASSERT_EQ(plain.step(i * h, h, za).status, StepStatus::kOk);
      ASSERT_EQ(packed.step(i * h, h, zb).status, StepStatus::kOk);
      ASSERT_TRUE(plain_tangent.advance(plain, a));
      ASSERT_TRUE(packed_tangent.advance(packed, b));
    }
    // The round-off of the two points is amplified by M, and once more by its derivative.
    const double size = std::max(1.0, largest_entry(a.value));
    EXPECT_LE(largest_change(a.value, b.value), 200 * kEps * size * size) << "h = " << h;
    EXPECT_LE(symplecticity_defect(b.value), 200 * kEps * size * size) << "h = " << h;
  }
}

// A rate whose derivative is not a number, although its value is finite.
struct Kinked : Oscillator {
  template <class U>
  [[nodiscard]] RateStatus rate(const U& t,
                                const Vector<U, 1>& q,
                                const Vector<U, 1>& p,
                                Vector<U, 0>& y,
                                Rate<U, 1>& out) const {
    const RateStatus status = Oscillator::rate(t, q, p, y, out);
    if constexpr (kIsJet<U>) out.p_dot[0].v *= std::numeric_limits<double>::quiet_NaN();
    return status;
  }
};

TEST_P(TangentTest, RefusesWhatIsNotANumber) {
  using Small = Matrix<double, 2, 2>;
  const Kinked system{{1}};
  RungeKutta<Kinked> step(system, tableau_);
  Tangent<RungeKutta<Kinked>> tangent;
  auto z = make_state<double, 1>(Vector<double, 1>(0.3), Vector<double, 1>(-0.8));
  ASSERT_EQ(step.step(0, 0.1, z).status, StepStatus::kOk);
  const Small twice = diagonal<double>(2, 2);
  Compensated<Small> m{twice, filled<2, 2>(0.0)};
  EXPECT_FALSE(tangent.advance(step, m));
  EXPECT_EQ(largest_change(m.value, twice), 0);
}

}  // namespace
}  // namespace carnot::tangent_test
