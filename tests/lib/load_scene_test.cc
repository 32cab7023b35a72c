// Scenes from text in C++: parameters, sizes, methods, and that nothing is allocated on the way.
#include "carnot/load_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "carnot/make_dynamics.h"
#include "testing/allocation_counter.h"

namespace carnot::load_scene_test {
namespace {

using ::testing::HasSubstr;

constexpr double kEps = std::numeric_limits<double>::epsilon();

// Oscillators of frequencies sqrt(1), sqrt(2), ...
std::string oscillators(int count) {
  std::string coordinates;
  std::string kinetic;
  std::string potential;
  for (int i = 1; i <= count; ++i) {
    const std::string q = "q" + std::to_string(i);
    coordinates += (i > 1 ? ", " : "") + q;
    kinetic += (i > 1 ? " + " : "") + q + "'^2";
    potential += (i > 1 ? " + " : "") + std::to_string(i) + " " + q + "^2";
  }
  return "coordinates " + coordinates + "\nkinetic = (" + kinetic + ")/2\npotential = (" +
         potential + ")/2\n";
}

class TextSizes : public ::testing::TestWithParam<int> {};

TEST_P(TextSizes, FlowByEveryKernel) {
  const int n = GetParam();
  const Dynamics d = make_dynamics(scene_from_text(oscillators(n)));
  std::vector<double> z(static_cast<std::size_t>(2 * n));
  for (int i = 0; i < n; ++i) z[i] = 1;
  std::vector<double> m(z.size() * z.size());
  ASSERT_TRUE(d.tangent_flow(StepPlan::equal(0, 2, 20), z, m).completed());
  for (int i = 0; i < n; ++i) {
    const double w = std::sqrt(i + 1.0);
    EXPECT_NEAR(z[i], std::cos(2 * w), 64 * kEps) << i;
    EXPECT_NEAR(z[n + i], -w * std::sin(2 * w), 256 * kEps) << i;
    EXPECT_NEAR(m[2 * n * i + i], std::cos(2 * w), 64 * kEps) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Coordinates, TextSizes, ::testing::Range(1, 13));

// A quadratic Lagrangian makes motion wherever its mass is regular, of whatever signs.
TEST(LoadScene, AMassMayBeIndefinite) {
  constexpr double kRoundOff = 64 * kEps;
  const auto end = [](const std::string& text, std::vector<double> z) {
    const Dynamics d = make_dynamics(scene_from_text(text));
    EXPECT_TRUE(d.flow(StepPlan::equal(0, 1, 20), z).completed()) << text;
    return z;
  };
  const double c = std::cos(1.0);
  const double s = std::sin(1.0);
  // x'' = -x, y'' = 0.
  auto z = end("coordinates x, y\nlagrangian = (x'^2 - y'^2 - x^2) / 2\n", {0.1, 0.2, 0.3, -0.4});
  EXPECT_NEAR(z[0], 0.1 * c + 0.3 * s, kRoundOff);
  EXPECT_NEAR(z[1], 0.2 + 0.4, kRoundOff);
  EXPECT_NEAR(z[3], -0.4, kRoundOff);
  // p_x = y' and p_y = x': x'' = -x, y'' = -y.
  z = end("coordinates x, y\nlagrangian = x' y' - x y\n", {0.1, 0.2, 0.3, 0.4});
  EXPECT_NEAR(z[0], 0.1 * c + 0.4 * s, kRoundOff);
  EXPECT_NEAR(z[1], 0.2 * c + 0.3 * s, kRoundOff);
  // With x' = z', -(y'^2 / 2) + x'^2.
  z = end("coordinates x, y, z\nlagrangian = (x'^2 - y'^2 + z'^2) / 2\n0 = x' - z'\n",
          {0, 0, 0, 0.7, 0.5, 0.1});
  EXPECT_NEAR(z[0], 0.4, kRoundOff);
  EXPECT_NEAR(z[1], -0.5, kRoundOff);
  // Negative for some x only: where (1 + 3 x)^(3/2) is linear in time.
  for (const double x : {0.5, -0.5}) {
    const double p = 0.1 * (1 + 3 * x);
    z = end("coordinates x\nlagrangian = (1 + 3 x) x'^2 / 2\n", {x, p});
    const double root = std::sqrt(std::abs(1 + 3 * x));
    const double now = std::pow(std::abs(1 + 3 * z[0]), 1.5);
    const double slope = (x > 0 ? 4.5 : -4.5) * root * 0.1;
    EXPECT_NEAR(now, root * root * root + slope, kRoundOff) << x;
  }
}

TEST(LoadScene, RefusesMoreThanTwelveCoordinates) {
  try {
    (void)scene_from_text(oscillators(13));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("at most 12"));
  }
}

TEST(LoadScene, ChangesParameters) {
  const TextScene scene = scene_from_text(
      "coordinates x\nparameters k = 4 > 0, unused = 1\nkinetic = x'^2/2\npotential = k x^2/2\n");
  const auto end = [](const TextScene& of) {
    std::vector<double> z{1, 0};
    EXPECT_TRUE(make_dynamics(of).flow(StepPlan::equal(0, 1, 20), z).completed());
    return z[0];
  };
  EXPECT_NEAR(end(scene), std::cos(2.0), 64 * kEps);
  const TextScene other = scene.with({{"k", 9}});
  EXPECT_NEAR(end(other), std::cos(3.0), 64 * kEps);
  EXPECT_NEAR(end(other.with({{"unused", 2}})), std::cos(3.0), 64 * kEps);  // k is still 9
  EXPECT_NEAR(end(scene), std::cos(2.0), 64 * kEps);
  EXPECT_EQ(other.parameters()[0].value, 9);
  EXPECT_EQ(other.parameters()[0].default_value, 4);
  EXPECT_THROW((void)scene.with({{"k", 0}}), std::invalid_argument);
  EXPECT_THROW((void)scene.with({{"kk", 1}}), std::invalid_argument);
  EXPECT_THROW((void)make_dynamics(scene, "gauss17"), std::invalid_argument);
}

TEST(LoadScene, ReadsFiles) {
  const TextScene scene = load_scene(CARNOT_SOURCE_DIR "/lib/carnot/scenes/vehicle-cosine.scene");
  EXPECT_EQ(scene.info().name, "vehicle-cosine");
  EXPECT_EQ(scene.dof(), 4);
  EXPECT_EQ(scene.multipliers(), 2);
  EXPECT_EQ(scene.holonomic(), 0);
  EXPECT_THAT(scene.text(), HasSubstr("potential"));
  EXPECT_THROW((void)load_scene("/no/such.scene"), std::invalid_argument);
  EXPECT_THROW((void)load_scene(CARNOT_SOURCE_DIR), std::invalid_argument);
}

// Derivatives that the text takes symbol by symbol are those of nested dual numbers on packs.
struct Frameless {
  static constexpr int kDof = 8;
  static constexpr int kMultipliers = 2;
  template <class T>
  [[nodiscard]] Matrix<T, 8, 8> mass(const Vector<T, 8>& q) const {
    using std::cos;
    Matrix<T, 8, 8> m = diagonal<T>(1, 1, 1, 1, 1, 1, 1, 1);
    m(0, 0) = 2 + cos(q[3]);
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 2, 8> constraints(const Vector<T, 8>& q) const {
    using std::cos, std::sin;
    Matrix<T, 2, 8> g = Matrix<T, 2, 8>::Zero();
    g(0, 0) = sin(q[2]);
    g(0, 1) = cos(q[4]);
    g(0, 5) = 1;
    g(1, 3) = sin(q[1]);
    g(1, 7) = 1;
    return g;
  }
};

TEST(LoadScene, AgreesWithASceneOfEightCoordinatesWithoutAFrame) {
  const Dynamics text = make_dynamics(scene_from_text(
      "coordinates a, b, c, d, e, f, g, h\n"
      "kinetic = ((2 + cos(d)) a'^2 + b'^2 + c'^2 + d'^2 + e'^2 + f'^2 + g'^2 + h'^2)/2\n"
      "0 = sin(c) a' + cos(e) b' + f'\n"
      "0 = sin(b) d' + h'\n"));
  const Dynamics twin = make_dynamics(Frameless{});
  std::vector<double> z;
  for (int i = 0; i < 16; ++i) z.push_back(0.3 + 0.5 * std::sin(1.3 * i));
  std::vector<double> w = z;
  std::vector<double> m(256);
  std::vector<double> expected(256);
  const StepPlan plan = StepPlan::equal(0, 1, 20);
  ASSERT_TRUE(text.tangent_flow(plan, z, m).completed());
  ASSERT_TRUE(twin.tangent_flow(plan, w, expected).completed());
  for (std::size_t i = 0; i < z.size(); ++i) EXPECT_NEAR(z[i], w[i], 1e-13) << i;
  for (std::size_t i = 0; i < m.size(); ++i) EXPECT_NEAR(m[i], expected[i], 1e-12) << i;
}

// The same bits on every run, whatever runs beside.
TEST(LoadScene, ThreadsShareAScene) {
  const Dynamics d =
      make_dynamics(load_scene(CARNOT_SOURCE_DIR "/lib/carnot/scenes/vehicle.scene"));
  const auto end = [&d] {
    std::vector<double> z{0, 0, 0.1, 0.4, 1, 0.5, 0.3, -0.2};
    EXPECT_TRUE(d.flow(StepPlan::equal(0, 20, 400), z).completed());
    return z;
  };
  const std::vector<double> expected = end();
  std::vector<std::vector<double>> ends(4);
  std::vector<std::thread> threads;
  for (auto& other : ends) threads.emplace_back([&other, &end] { other = end(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& other : ends) EXPECT_EQ(other, expected);
}

#ifdef CARNOT_TEST_COUNTS_MALLOC
TEST(LoadScene, FlowsWithoutAllocating) {
  for (const char* name : {"vehicle", "boat", "satellite"}) {
    const Dynamics d = make_dynamics(
        load_scene(std::string(CARNOT_SOURCE_DIR "/lib/carnot/scenes/") + name + ".scene"));
    std::vector<double> start(static_cast<std::size_t>(2 * d.dof), 0.3);
    std::vector<double> m(start.size() * start.size());
    const StepPlan plan = StepPlan::equal(0, 1, 10);
    const auto run = [&] { (void)d.tangent_flow(plan, start, m); };
    run();
    EXPECT_EQ(test::allocations_in(run), 0) << name;
  }
}
#endif

}  // namespace
}  // namespace carnot::load_scene_test
