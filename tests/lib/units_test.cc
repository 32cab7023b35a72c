// The same motion in other units: what is reported must be the same number of them.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/make_dynamics.h"
#include "carnot/make_rattle_dynamics.h"
#include "carnot/scene/unit_sizes.h"
#include "carnot/scenes/spherical_pendulum.h"
#include "carnot/scenes/vehicle.h"
#include "testing/lagrangian_forms.h"

namespace carnot::units_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr int n = 4;
using Numbers = std::vector<double>;

// Units of (q, p) of the vehicle where that of length is u: momenta of lengths are u per time.
Numbers units_of_vehicle(double u) { return {u, u, 1, 1, u, u, u * u, u * u}; }

Dynamics vehicle(double u, const std::string& method = "gauss4") {
  return make_dynamics(scenes::Vehicle{.alpha = u * u, .beta = u * u, .length = u}, method);
}

// d z(T)/d z(0) of two steps that are too long to be iterated on, in units of length u, told in
// those of u = 1.
Numbers tangent_in_units(double u, const std::string& method, double step) {
  const Dynamics dynamics = vehicle(u, method);
  const Numbers units = units_of_vehicle(u);
  Numbers z{0, 0, 0.3, 0.7, 1.1, 0.4, 0.8, -0.9};
  for (int i = 0; i < 2 * n; ++i) z[i] *= units[i];
  Numbers m(4 * n * n);
  const FlowReport report = dynamics.tangent_flow(StepPlan::equal(0, 2 * step, 2), z, m);
  EXPECT_TRUE(report.completed()) << method;
  for (int i = 0; i < 2 * n; ++i) {
    for (int j = 0; j < 2 * n; ++j) m[i * 2 * n + j] *= units[j] / units[i];
  }
  return m;
}

// Where the equations of the tangent are solved by elimination, its pivots do not depend on the
// units. Without that, up to 3e-9 were lost.
TEST(UnitsTest, TangentsOfLongStepsAreTheSameInAllOfThem) {
  struct Case {
    const char* method;
    double step;
  };
  for (const auto& [method, step] : {Case{"gauss16", 1.5}, {"gauss8", 1.5}, {"radau5", 1.0}}) {
    const Numbers plain = tangent_in_units(1, method, step);
    double size = 0;
    for (const double x : plain) size = std::max(size, std::abs(x));
    for (const double u : {std::ldexp(1, 40), std::ldexp(1, -40), std::ldexp(1, 20), 1e-6}) {
      const Numbers other = tangent_in_units(u, method, step);
      for (std::size_t i = 0; i < plain.size(); ++i) {
        EXPECT_NEAR(other[i], plain[i], 1000 * kEps * size) << method << " " << u;
      }
    }
  }
}

TEST(UnitsTest, MultipliersAreFoundInAllOfThem) {
  const Numbers q{0, 0, 0.25, 0.25};
  const Numbers lambda{0.3, -0.2};
  Numbers v{std::cos(0.25), std::sin(0.25), 0, 1};
  Numbers p(n);
  EXPECT_LE(vehicle(1).momentum(0, q, v, lambda, p), 4 * kEps);
  // With a wheelbase of 1e-12 the rows of the constraints are no more than that apart.
  for (const double u : {1e-12, 1e-6, 1.0, 1e6, 1e12}) {
    const Numbers units = units_of_vehicle(u);
    Numbers momentum = p;
    for (int i = 0; i < n; ++i) momentum[i] *= units[n + i];
    Numbers rate(n);
    Numbers found(2);
    EXPECT_EQ(vehicle(u).evaluate(0, q, momentum, rate, found).status, RateStatus::kOk) << u;
    for (int i = 0; i < n; ++i) EXPECT_NEAR(rate[i] / units[i], v[i], 16 * kEps) << u;
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(found[i] / u, lambda[i], 64 * kEps) << u;
  }
}

// The vehicle by masses and rows, by L and g, and by both from text.
std::vector<Dynamics> forms_of_vehicle(double u) {
  const scenes::Vehicle scene{.alpha = u * u, .beta = u * u, .length = u};
  const std::string rows = fmt::format(
      "coordinates x, y, theta, phi\n"
      "parameters u = {:.17g}\n"
      "0 = x' sin(phi) - y' cos(phi)\n"
      "0 = x' sin(theta) - y' cos(theta) + u theta'\n",
      u);
  const std::string energy = "(x'^2 + y'^2 + u^2 theta'^2 + u^2 phi'^2) / 2\n";
  return {make_dynamics(scene),
          make_dynamics(test::LagrangianVehicle{scene}),
          make_dynamics(scene_from_text(rows + "kinetic = " + energy)),
          make_dynamics(scene_from_text(rows + "lagrangian = " + energy))};
}

// Their projection, how far it is, and the momentum of it. With rows that are 1e-12 apart there was
// none.
TEST(UnitsTest, VelocitiesAreProjectedAlikeInAllOfThem) {
  const Numbers q{0, 0, 0.25, 0.3};
  const Numbers lambda{0.3, -0.2};
  const Numbers given{0.4, 0.9, -0.3, 0.7};
  Numbers plain = given;
  Numbers p(n);
  const double moved = vehicle(1).momentum(0, q, plain, lambda, p);
  EXPECT_NEAR(std::hypot(plain[0] - given[0], plain[1] - given[1], plain[2] - given[2]),
              moved * std::hypot(0.4, 0.9, std::hypot(0.3, 0.7)),
              8 * kEps);
  for (const double u : {1e-12, 1e-6, 1.0, 1e6, 1e12}) {
    const Numbers units = units_of_vehicle(u);
    const Numbers forces{lambda[0] * u, lambda[1] * u};
    for (const Dynamics& form : forms_of_vehicle(u)) {
      Numbers v = given;
      for (int i = 0; i < n; ++i) v[i] *= units[i];
      Numbers momentum(n);
      EXPECT_NEAR(form.momentum(0, q, v, forces, momentum), moved, 16 * kEps) << u;
      for (int i = 0; i < n; ++i) {
        EXPECT_NEAR(v[i] / units[i], plain[i], 64 * kEps) << u;
        EXPECT_NEAR(momentum[i] / units[n + i], p[i], 64 * kEps) << u;
      }
    }
  }
}

TEST(UnitsTest, SizesAreThoseOfOneUnit) {
  SceneInfo info;
  info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"a", "rad", 0}};
  EXPECT_EQ(sizes_by_unit(info, Numbers{-3, 2, 0.5}, 1), (Numbers{3, 3, 1}));
  EXPECT_EQ(sizes_by_unit(info, Numbers{-3, 2, 0.5}, 0), (Numbers{3, 3, 0.5}));
  EXPECT_EQ(sizes_by_unit({}, Numbers{-3, 2, 0.5}, 1), (Numbers{3, 3, 3}));
}

Dynamics pendulum(double u) {
  return make_rattle_dynamics(scenes::SphericalPendulum{.length = u, .gravity = u});
}

// A rod that is right to round-off, and one that is six per cent too long.
TEST(UnitsTest, ResidualsOfHolonomicConstraintsHaveNone) {
  for (const double u : {1e-12, 1e-6, 1.0, 1e6, 1e12}) {
    const Dynamics dynamics = pendulum(u);
    const auto right =
        dynamics.holonomic_residuals(0, Numbers{0.6 * u, 0, -0.8 * u, 0.4 * u, u, 0.3 * u});
    EXPECT_LE(right.relative_position, 4 * kEps) << u;
    EXPECT_LE(right.relative_velocity, 4 * kEps) << u;
    const auto wrong = dynamics.holonomic_residuals(0, Numbers{0.6 * u, 0, -0.85 * u, 0, 0, u});
    // h = 0.0825 u^2 against 2 (0.6 + 0.85) 0.85 u^2.
    EXPECT_NEAR(wrong.position, 0.0825 * u * u, 4 * kEps * u * u) << u;
    EXPECT_NEAR(wrong.relative_position, 0.0825 / 2.465, 4 * kEps) << u;
    // It is led away along z, by 2 z z' = 1.7 u^2.
    EXPECT_NEAR(wrong.relative_velocity, 1.7 / 2.9, 4 * kEps) << u;
  }
}

TEST(UnitsTest, ResidualsOfWhatIsNotANumberAreNone) {
  const Dynamics dynamics = pendulum(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto residuals = dynamics.holonomic_residuals(0, Numbers{nan, 0, -1, 0, 1, 0});
  EXPECT_TRUE(std::isnan(residuals.position));
  EXPECT_TRUE(std::isnan(residuals.relative_position));
  EXPECT_TRUE(std::isnan(residuals.relative_velocity));
}

}  // namespace
}  // namespace carnot::units_test
