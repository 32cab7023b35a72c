// Systems from the literature, in the texts of docs/examples/scenes, against what is known of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "carnot/laws/laws.h"
#include "carnot/load_scene.h"
#include "catalogue/scene_choice.h"

namespace carnot::literature_scenes_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
// What a hundred steps of order 16 leave of motions of size one.
constexpr double kRoundOff = 1e-12;

TextScene scene(const std::string& name) {
  return load_scene(CARNOT_SOURCE_DIR "/docs/examples/scenes/" + name + ".scene");
}
Dynamics dynamics(const std::string& name) { return make_dynamics(scene(name)); }

using Point = std::vector<double>;

// The phase point after time t.
Point flow(const Dynamics& d, Point z, double t, long steps = 100) {
  const FlowReport report = d.flow(StepPlan::equal(0, t, steps), z);
  EXPECT_TRUE(report.completed()) << report.reason();
  return z;
}

double hamiltonian(const Dynamics& d, const Point& z) {
  const auto n = static_cast<std::size_t>(d.dof);
  Point v(n);
  Point lambda(static_cast<std::size_t>(d.multipliers));
  const std::span<const double> at(z);
  const PointValues values = d.evaluate(0, at.first(n), at.subspan(n), v, lambda);
  EXPECT_EQ(values.status, RateStatus::kOk);
  return values.hamiltonian;
}

void expect_near(const Point& a, const Point& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i], b[i], tolerance * (1 + std::abs(b[i]))) << "number " << i;
  }
}

// ---- laws that all of them obey

std::vector<std::string> names() {
  std::vector<std::string> result;
  const std::filesystem::path folder = CARNOT_SOURCE_DIR "/docs/examples/scenes";
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    result.push_back(file.path().stem().string());
  }
  std::sort(result.begin(), result.end());
  return result;
}

class EveryText : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryText, KeepsEnergyConstraintsAndTheSymplecticForm) {
  const Dynamics d = dynamics(GetParam());
  PhaseStart start;
  for (int i = 0; i < 2 * d.dof; ++i) start.z.push_back(0.4 + 0.1 * std::sin(1.7 * i));
  constexpr double kStep = 0.02;
  constexpr long kSteps = 40;
  // Relative to max(1, |M|^2), with |M| up to 1e2 here.
  EXPECT_LE(measure_symplecticity(d, start, kStep, kSteps), 1e-12);
  const EnergyLaw energy = measure_energy(d, start, kStep, kSteps, {});
  ASSERT_TRUE(energy.report.completed()) << energy.report.reason();
  EXPECT_LE(energy.largest, 1e-12 * (1 + std::abs(hamiltonian(d, start.z))));
  EXPECT_LE(energy.constraint_error, 1e-13);
  const ReversalLaw reversal = measure_reversal(d, start, kStep, kSteps);
  EXPECT_LE(reversal.adjoint, 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Literature, EveryText, ::testing::ValuesIn(names()), [](const auto& each) {
  std::string name = each.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

// ---- what is known of each

// The rate of a scene of the program and of a text at the same point are the same.
void expect_same_motion(const Dynamics& a, const Dynamics& b, const Point& z, double t) {
  expect_near(flow(a, z, t), flow(b, z, t), kRoundOff);
}

TEST(Literature, HookedOnTheAxleTrailersAreThoseOfLaumond) {
  const Dynamics one = make_dynamics(scene("hooked").with({{"hook", 0}, {"w", 1}}));
  expect_same_motion(one,
                     apps::find_scene("trailer1").make({}, "gauss16"),
                     {0, 0, 0.2, 0.5, 1, 0.5, 0.3, -0.4},
                     1);
  const Dynamics two = make_dynamics(scene("two-hooked").with({{"hook", 0}}));
  expect_same_motion(two,
                     apps::find_scene("trailer2").make({}, "gauss16"),
                     {0, 0, 0.2, 0.5, -0.1, 1, 0.5, 0.3, -0.4, 0.2},
                     1);
}

// Both axles steered alike: the car moves without turning.
TEST(Literature, FourWheelSteeringMovesSideways) {
  const Dynamics d = dynamics("four-wheel-steering");
  Point q{0, 0, 0.3, 0.7, 0.7};
  Point v{std::cos(1.0), std::sin(1.0), 0, 0, 0};
  Point p(5);
  EXPECT_LE(d.momentum(0, q, v, Point{0, 0}, p), 4 * kEps);
  EXPECT_NEAR(v[2], 0, 4 * kEps);
  // Turning with the velocity of the middle along the body asks for opposite angles.
  q = {0, 0, 0, 0.4, -0.4};
  v = {1, 0, std::tan(0.4) / 0.5, 0, 0};
  EXPECT_LE(d.momentum(0, q, v, Point{0, 0}, p), 4 * kEps);
}

// Straight on at zero curvature.
TEST(Literature, ACurvatureCarDrivesStraightOn) {
  const Point z =
      flow(dynamics("curvature-car"), {0, 0, 0.5, 0, std::cos(0.5), std::sin(0.5), 0, 0}, 2);
  expect_near(z,
              {2 * std::cos(0.5), 2 * std::sin(0.5), 0.5, 0, std::cos(0.5), std::sin(0.5), 0, 0},
              kRoundOff);
}

// Rigid motions of the plane are found as symmetries, and so is the free angle of the rotor.
TEST(Literature, BoardsDoNotKnowWhereTheyAre) {
  const Symmetries board = scene("snakeboard").info().symmetries;
  EXPECT_EQ(board.x, 0);
  EXPECT_EQ(board.y, 1);
  EXPECT_EQ(std::count(board.angles.begin(), board.angles.end(), 2), 1);
  const Dynamics d = dynamics("snakeboard");
  const Point z0{0, 0, 0.2, 0.1, 0.5, 0.7, 0.4, 0.3, 0.2, 0.1};
  const Point z = flow(d, z0, 0.3);     // long before the trucks stand across
  EXPECT_NEAR(z[8], z0[8], kRoundOff);  // the momentum of the rotor
  const auto about_origin = [](const Point& at) { return at[0] * at[6] - at[1] * at[5] + at[7]; };
  EXPECT_NEAR(about_origin(z), about_origin(z0), kRoundOff);
  const Symmetries racer = scene("roller-racer").info().symmetries;
  EXPECT_EQ(racer.x, 0);
  EXPECT_EQ(racer.angles, std::vector<int>{2});
}

// With X3 = [X1, X2], X4 = [X1, X3], X5 = [X2, X3] and h_i = p.X_i, h4, h5 and the Casimir
// h3^2/2 + h1 h5 - h2 h4 are constant. X3 = d_z + x d_v + y d_w, X4 = d_v, X5 = d_w.
TEST(Literature, CartanKeepsItsCasimir) {
  const auto h = [](const Point& z) {
    const double x = z[0];
    const double y = z[1];
    const double* p = z.data() + 5;
    const double square = 0.5 * (x * x + y * y);
    return Point{p[0] - 0.5 * y * p[2] - square * p[4],
                 p[1] + 0.5 * x * p[2] + square * p[3],
                 p[2] + x * p[3] + y * p[4],
                 p[3],
                 p[4]};
  };
  const auto casimir = [&](const Point& z) {
    const Point a = h(z);
    return 0.5 * a[2] * a[2] + a[0] * a[4] - a[1] * a[3];
  };
  const Point z0{0.3, -0.2, 0.1, 0.4, 0.2, 1, 0.5, 0.7, -0.6, 0.3};
  const Point z = flow(dynamics("cartan"), z0, 3);
  EXPECT_NEAR(casimir(z), casimir(z0), kRoundOff);
  EXPECT_NEAR(h(z)[3], h(z0)[3], kRoundOff);
  EXPECT_NEAR(h(z)[4], h(z0)[4], kRoundOff);
}

// Each pair (x_i, y_i) runs through a circle, all with the same curvature p_z.
TEST(Literature, HeisenbergOfDimensionFiveTurnsInCircles) {
  constexpr double kTurn = 1.3;
  const Point z = flow(dynamics("heisenberg-5"), {0, 0, 0, 0, 0, 1, 0, 0, 0.5, kTurn}, 2);
  const double s = std::sin(2 * kTurn) / kTurn;
  const double c = (1 - std::cos(2 * kTurn)) / kTurn;
  EXPECT_NEAR(z[0], s, kRoundOff);
  EXPECT_NEAR(z[1], c, kRoundOff);
  EXPECT_NEAR(z[2], -0.5 * c, kRoundOff);
  EXPECT_NEAR(z[3], 0.5 * s, kRoundOff);
  const double square = 1.25;
  EXPECT_NEAR(z[4], square * (2 * kTurn - std::sin(2 * kTurn)) / (2 * kTurn * kTurn), kRoundOff);
}

// Projections are curves of geodesic curvature p_psi over the speed: on the equator of the sphere
// p_psi = 0 goes round, and every circle closes after 2 pi / sqrt(speed^2 + p_psi^2).
TEST(Literature, BundlesOverSurfacesOfConstantCurvatureCloseTheirCircles) {
  const Dynamics sphere = dynamics("su2");
  Point z{kPi / 2, 0, 0, 0.4, 0.9, 0.5};
  const double turn = std::sqrt(2 * hamiltonian(sphere, z) + z[5] * z[5]);
  const Point end = flow(sphere, z, 2 * kPi / turn);
  EXPECT_NEAR(end[0], z[0], kRoundOff);
  EXPECT_NEAR(std::remainder(end[1] - z[1], 2 * kPi), 0, 1e-11);
  const Dynamics hyperbolic = dynamics("sl2");
  z = {1, 0, 0, 0.2, -3, 2};
  const double speed2 = 2 * hamiltonian(hyperbolic, z);
  ASSERT_GT(z[5] * z[5], speed2);  // else the curve does not close
  const Point closed = flow(hyperbolic, z, 2 * kPi / std::sqrt(z[5] * z[5] - speed2), 400);
  EXPECT_NEAR(closed[0], z[0], 1e-10);
  EXPECT_NEAR(std::remainder(closed[1] - z[1], 2 * kPi), 0, 1e-10);
}

TEST(Literature, MartinetWithoutPerturbationIsFlat) {
  const TextScene flat =
      scene("martinet-perturbed").with({{"alpha", 0}, {"beta", 0}, {"gamma", 0}});
  const Point z{0.1, 0.3, -0.2, 1, 0.4, 0.8};
  expect_same_motion(make_dynamics(flat), apps::find_scene("martinet").make({}, "gauss16"), z, 2);
  EXPECT_GT(
      std::abs(flow(dynamics("martinet-perturbed"), z, 2)[0] - flow(make_dynamics(flat), z, 2)[0]),
      1e-3);
}

// With p_phi = 0 the disc is a unicycle whose speed costs 1 + rolling / radius^2.
TEST(Literature, ARollingDiscIsAUnicycle) {
  const Point disc = flow(dynamics("rolling-disc"), {0, 0, 0.4, 0, 1, 0.5, 0.3, 0}, 2);
  const Dynamics unicycle =
      apps::find_scene("unicycle").make({{"beta", std::sqrt(0.25 / 1.5)}}, "gauss16");
  // Momenta over 1.5, so that rates are the same.
  const Point wheel = flow(unicycle, {0, 0, 0.4, 1 / 1.5, 0.5 / 1.5, 0.3 / 1.5}, 2);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(disc[i], wheel[i], kRoundOff) << i;
}

// On the constraint the centre of mass only adds to the inertia.
TEST(Literature, AVariationalSleighIsAUnicycle) {
  const Dynamics unicycle =
      apps::find_scene("unicycle").make({{"beta", std::sqrt(1.25)}}, "gauss16");
  expect_same_motion(dynamics("chaplygin-sleigh"), unicycle, {0, 0, 0.4, 1, 0.5, 0.3}, 2);
}

// A great circle bends nowhere, at no cost.
TEST(Literature, GreatCirclesAreElastica) {
  const Dynamics d = dynamics("elastica-on-sphere");
  const Point z = flow(d, {kPi / 2, 0, kPi / 2 - 0.3, 0, 0, 0}, 2 * kPi);
  expect_near({z[0], z[1], z[2]}, {kPi / 2, 2 * kPi, kPi / 2 - 0.3}, 1e-11);
  EXPECT_EQ(hamiltonian(d, {kPi / 2, 0, kPi / 2 - 0.3, 0, 0, 0}), 0);
}

// p_x is constant and p_y falls evenly, so that y is a parabola and x a cubic.
TEST(Literature, ZermelosShipIsAPolynomial) {
  const double s = 0.5;
  const double a = 0.7;
  const double b = 0.4;
  const double t = 2;
  const Point z = flow(dynamics("zermelo"), {0, 1, a, b}, t);
  const double y = 1 + b * t - s * a * t * t / 2;
  const double x = a * t + s * (t + b * t * t / 2 - s * a * t * t * t / 6);
  expect_near(z, {x, y, a, b - s * a * t}, kRoundOff);
}

// Without damping an oscillator in resonance with its control.
TEST(Literature, VanDerPolWithoutDampingIsLinear) {
  const Dynamics d = make_dynamics(scene("van-der-pol").with({{"mu", 0}}));
  const double t = 3;
  // p_v = sin t, p_x = -p_v' ..., x'' = -x + sin t with x(0) = x'(0) = 0.
  const Point z = flow(d, {0, 0, -1, 0}, t);
  expect_near({z[0], z[3]}, {(std::sin(t) - t * std::cos(t)) / 2, std::sin(t)}, kRoundOff);
}

// An extremal to another circular orbit, twenty units of time away.
TEST(Literature, KeplerTransferArrives) {
  const Dynamics d = dynamics("kepler-transfer");
  const Point z =
      flow(d, {1, 0, 0, 1, 0.0055661408, 9.71017e-4, 8.14332e-4, 0.0057525071}, 20, 400);
  // The momenta are known to ten and six digits, and errors grow by about a hundred.
  expect_near({z[0], z[1], z[2], z[3]}, {-1.5, 0, 0, -1 / std::sqrt(1.5)}, 1e-6);
}

// The energy of the pole and the cart without a force, and of the pendulum without a torque.
TEST(Literature, CartsAndPendulumsKeepTheirEnergy) {
  constexpr double kCart = 2;
  constexpr double kRod = 0.7;
  constexpr double kGravity = 1.3;
  const Dynamics d = make_dynamics(
      scene("cart-pole").with({{"cart", kCart}, {"rod", kRod}, {"gravity", kGravity}}));
  const auto energy = [&](const Point& z) {
    const double vx = z[2] + kRod * z[3] * std::cos(z[1]);
    const double vy = kRod * z[3] * std::sin(z[1]);
    return 0.5 * (kCart * z[2] * z[2] + vx * vx + vy * vy) - kGravity * kRod * std::cos(z[1]);
  };
  const Point from{0, 0.5, 0.3, 1.2, 0, 0, 0, 0};
  EXPECT_NEAR(energy(flow(d, from, 2)), energy(from), kRoundOff);
  const Dynamics pendulum = dynamics("pendulum-swing-up");
  const Point at = flow(pendulum, {0.5, 1.2, 0, 0}, 2);
  EXPECT_NEAR(at[1] * at[1] / 2 - std::cos(at[0]), 0.72 - std::cos(0.5), kRoundOff);
}

TEST(Literature, ARegulatorHasFourRates) {
  // lambda^4 - 3 lambda^2 + 2 = 0; the eigenvector (x, v, p_x, p_v) has v = lambda x,
  // p_v = (lambda^2 - 1) x and p_x = v - lambda p_v.
  const Dynamics d = dynamics("regulator");
  const double t = 1.5;
  for (const double lambda : {1.0, -1.0, std::sqrt(2), -std::sqrt(2)}) {
    const auto eigenvector = [&](double x) {
      const double p_v = (lambda * lambda - 1) * x;
      return Point{x, lambda * x, lambda * (x - p_v), p_v};
    };
    expect_near(flow(d, eigenvector(1), t), eigenvector(std::exp(lambda * t)), kRoundOff);
  }
}

TEST(Literature, AVortexCarriesShipsInCircles) {
  const Dynamics d = dynamics("vortex");
  // Without momentum the ship drifts at the rate 1 / (1 + r^2).
  const double t = 3;
  const double angle = t / (1 + 4);
  const Point z = flow(d, {2, 0, 0, 0}, t);
  expect_near({z[0], z[1]}, {2 * std::cos(angle), 2 * std::sin(angle)}, kRoundOff);
}

TEST(Literature, AQuadrotorHovers) {
  const Dynamics d = dynamics("planar-quadrotor");
  const Point still{0.3, 0.2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  expect_near(flow(d, still, 5), still, kRoundOff);
  const Point z = flow(d, {0, 0, 0.1, 0, 0, 0, 0.2, 0.3, 0.1, 0.1, 0.2, 0.1}, 1);
  EXPECT_NEAR(z[6], 0.2, kRoundOff);  // H depends on velocities, not on the place
  EXPECT_NEAR(z[7], 0.3, kRoundOff);
}

// Near the equilibrium at zero an oscillator of frequency sqrt(a c).
TEST(Literature, PredatorAndPreyOscillate) {
  const Dynamics d = dynamics("lotka-volterra");
  constexpr double kSmall = 1e-6;
  const Point z = flow(d, {kSmall, 0}, kPi / 2);
  EXPECT_NEAR(z[0], 0, 2 * kSmall * kSmall);
  EXPECT_NEAR(std::abs(z[1]), kSmall, 2 * kSmall * kSmall);
  // prey' = 1 - e^predator.
  Point v(1);
  Point none;
  (void)d.evaluate(0, Point{0.3}, Point{0.5}, v, none);
  EXPECT_NEAR(v[0], 1 - std::exp(0.5), 4 * kEps);
}

// v turns clockwise at the rate of the field.
TEST(Literature, AChargedParticleMovesOnAHelix) {
  const double t = 2;
  // At the origin p = v.
  const Point z = flow(dynamics("charged-particle"), {0, 0, 0, 1, 0, 0.5}, t);
  expect_near({z[0], z[1], z[2]}, {std::sin(t), std::cos(t) - 1, 0.5 * t}, kRoundOff);
}

// Small oscillations have the frequencies sqrt(2 - sqrt 2) and sqrt(2 + sqrt 2).
TEST(Literature, ADoublePendulumHasItsNormalModes) {
  const Dynamics d = dynamics("double-pendulum");
  constexpr double kSmall = 1e-5;
  for (const double sign : {1.0, -1.0}) {
    const double root = sign * std::sqrt(2.0);
    const double period = 2 * kPi / std::sqrt(2 - root);
    const Point z0{kSmall, root * kSmall, 0, 0};
    expect_near(flow(d, z0, period), z0, 100 * kSmall * kSmall * kSmall);
  }
}

}  // namespace
}  // namespace carnot::literature_scenes_test
