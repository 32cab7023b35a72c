// What a problem says does not depend on the units it is written in, nor on where and in which
// direction of the plane it is put.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/shooting/continuation.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/problem/rescaled.h"
#include "carnot/shooting/steering_function.h"
#include "carnot/shooting/warm_start.h"
#include "shooting/problems.h"

namespace carnot::internal::invariance_test {
namespace {

// Units of length, of action per length squared, and of time.
struct Units {
  double length = 1;
  double action = 1;
  double time = 1;
};

struct Subject {
  std::string name;
  std::vector<double> powers;  // of the length in each coordinate
  std::vector<double> sizes;   // of random coordinates
  std::string text;            // a scene; L and A stand for its units
  bool drift = false;          // the last coordinate is a velocity
};

std::vector<Subject> subjects() {
  const std::string plane = "coordinates x, y [length], theta, phi [angle]\n";
  const std::string parameters = "parameters L = 1 > 0, A = 1 > 0\n";
  return {
      {"vehicle",
       {1, 1, 0, 0},
       {2, 2, 1, 1},
       plane + parameters +
           "kinetic = A (x'^2 + y'^2 + L^2 theta'^2 + L^2 phi'^2) / 2\n"
           "0 = x' sin(phi) - y' cos(phi)\n"
           "0 = x' sin(theta) - y' cos(theta) + L theta'\n"},
      {"hooked trailer",
       {1, 1, 0, 0},
       {2, 2, 1, 1},
       plane + parameters +
           "kinetic = A (x'^2 + y'^2 + 0.1 L^2 theta'^2) / 2\n"
           "0 = x' sin(theta) - y' cos(theta)\n"
           "0 = x' sin(phi) - y' cos(phi) + 0.3 L cos(theta - phi) theta' + L phi'\n"},
      {"tricycle",
       {1, 1, 0, 0},
       {1, 1, 1, 0.7},
       plane + parameters +
           "controls v, w\n"
           "x' = v cos(theta) cos(phi)\ny' = v sin(theta) cos(phi)\n"
           "theta' = v sin(phi) / L\nphi' = w\ncost = A (v^2 + L^2 w^2) / 2\n"},
      {"heisenberg",
       {1, 1, 2},
       {1, 1, 1},
       "coordinates x, y, z\n" + parameters +
           "kinetic = A (x'^2 + y'^2) / 2\n0 = z' - (x y' - y x') / 2 + 0 L\n"},
      {"martinet",
       {1, 1, 3},
       {1, 1, 1},
       "coordinates x, y, z\n" + parameters +
           "controls u, v\nx' = u\ny' = v\nz' = y^2 u / 2 + 0 L\ncost = A (u^2 + v^2) / 2\n"},
      {"double integrator",
       {1, 1},
       {1, 1},
       "coordinates x, v\n" + parameters + "controls u\nx' = v\nv' = u + 0 L\ncost = A u^2 / 2\n",
       true},
  };
}

std::string name_of(const ::testing::TestParamInfo<Subject>& subject) {
  std::string name = subject.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::vector<Subject> driftless() {
  std::vector<Subject> some;
  for (const Subject& subject : subjects()) {
    if (!subject.drift) some.push_back(subject);
  }
  return some;
}

BoundaryValueProblem problem_in(const Subject& subject,
                                const std::vector<double>& from,
                                const std::vector<double>& to,
                                const Units& units) {
  const Dynamics dynamics =
      make_dynamics(scene_from_text(subject.text).with({{"L", units.length}, {"A", units.action}}));
  BoundaryValueProblem problem(dynamics, from, to, units.time);
  const int n = dynamics.dof;
  for (int j = 0; j < n; ++j) {
    double unit = std::pow(units.length, subject.powers[j]);
    if (subject.drift && j == n - 1) unit /= units.time;
    problem.from[j] *= unit;
    problem.to[j] *= unit;
  }
  return problem;
}

// The unit of the action of an extremal.
double action_unit(const Subject& subject, const Units& units) {
  const double rate = subject.drift ? std::pow(units.time, 3) : units.time;
  return units.action * units.length * units.length / rate;
}

class Invariance : public ::testing::TestWithParam<Subject> {
 protected:
  std::mt19937_64 random_{11};
  std::vector<double> draw() {
    std::normal_distribution<double> normal;
    std::vector<double> q;
    for (const double size : GetParam().sizes) q.push_back(size * normal(random_));
    return q;
  }
};

TEST_P(Invariance, OfUnits) {
  constexpr double kSame = 1e-9;
  const Subject& subject = GetParam();
  const std::vector<double> from = draw();
  const std::vector<double> to = draw();
  GeodesicOptions options;
  options.samples = 0;
  const GeodesicReport one = find_geodesics(problem_in(subject, from, to, {}), options);
  ASSERT_FALSE(one.geodesics.empty()) << one.message;
  const Geodesic& a = one.geodesics[0];
  for (const Units units : {Units{1e-6, 1, 1},
                            Units{1e-3, 1, 1},
                            Units{1e6, 1, 1},
                            Units{1, 1e-6, 1},
                            Units{1, 1, 1e6},
                            Units{1e-4, 1e5, 1e-6},
                            Units{1e6, 1e6, 1e3}}) {
    SCOPED_TRACE(testing::Message() << units.length << ", " << units.action << ", " << units.time);
    const GeodesicReport other = find_geodesics(problem_in(subject, from, to, units), options);
    ASSERT_FALSE(other.geodesics.empty()) << other.message;
    const Geodesic& b = other.geodesics[0];
    EXPECT_NEAR(b.action / action_unit(subject, units), a.action, kSame * a.action);
    EXPECT_EQ(b.label, a.label);
    EXPECT_EQ(b.verification, a.verification);
    EXPECT_EQ(other.starts, one.starts);
    ASSERT_EQ(b.conjugate_times.has_value(), a.conjugate_times.has_value());
    if (!a.conjugate_times) continue;
    ASSERT_EQ(b.conjugate_times->size(), a.conjugate_times->size());
    for (std::size_t i = 0; i < a.conjugate_times->size(); ++i) {
      EXPECT_NEAR((*b.conjugate_times)[i] / units.time, (*a.conjugate_times)[i], kSame);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Invariance, ::testing::ValuesIn(subjects()), name_of);

// Rigid motions of the plane, the mirror y -> -y, and the way back.
// Geodesics that keep to a limit, too: the same arcs at the same times.
TEST(Invariances, OfUnitsWithLimits) {
  const std::vector<Subject> all = subjects();
  const std::vector<std::pair<Subject, std::string>> limited{
      {all[0], "limit -0.3 < phi - theta < 0.3\n"},
      {all[0], "limit y < 1.05 L\n"},
      {all[1], "limit -0.5 < phi - theta < 0.5\n"},
      {all[2], "limit -0.5 < phi < 0.5\n"}};
  for (const auto& [free, limit] : limited) {
    Subject subject = free;
    subject.text += limit;
    const std::vector<double> from{0, 0, 0, 0};
    const std::vector<double> to{0.3, 1, 0.2, 0.1};
    const auto in = [&](const Units& units) {
      const BoundaryValueProblem problem = problem_in(subject, from, to, units);
      const GeodesicReport report = find_geodesics(problem);
      EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
      return report.geodesics.empty() ? Geodesic{} : report.geodesics.front();
    };
    const Geodesic known = in({});
    ASSERT_EQ(known.limits.size(), 1U);
    for (const Units units : {Units{1e-6, 1, 1}, Units{1e6, 1, 1}, Units{1, 1e-5, 1e4}}) {
      const Geodesic geodesic = in(units);
      const double action = known.action * action_unit(subject, units);
      EXPECT_NEAR(geodesic.action, action, 1e-9 * action) << limit << units.length;
      EXPECT_EQ(geodesic.label, known.label);
      EXPECT_EQ(geodesic.verification, known.verification);
      ASSERT_EQ(geodesic.limits.size(), 1U);
      ASSERT_EQ(geodesic.limits[0].active.size(), known.limits[0].active.size());
      for (std::size_t i = 0; i < known.limits[0].active.size(); ++i) {
        EXPECT_NEAR(geodesic.limits[0].active[i].first,
                    known.limits[0].active[i].first * units.time,
                    1e-9 * units.time);
      }
    }
  }
}

// A curve of geodesics turns at the same place.
TEST(Invariances, OfUnitsInContinuation) {
  const Subject subject = subjects()[0];
  const std::vector<double> to{0.3, 1.2, 0.1, 0};
  const auto in = [&](const Units& units) {
    const BoundaryValueProblem problem = problem_in(subject, {0, 0, 0, 0}, {0, 1, 0, 0}, units);
    const GeodesicReport found = find_geodesics(problem);
    EXPECT_FALSE(found.geodesics.empty()) << found.message;
    return continue_geodesic(
        moving_target(problem, problem_in(subject, {0, 0, 0, 0}, to, units).to),
        found.geodesics.at(0));
  };
  const ContinuationReport known = in({});
  ASSERT_EQ(known.status, ContinuationStatus::kReturned) << known.message;
  ASSERT_EQ(known.folds.size(), 1U);
  for (const Units units : {Units{1e-6, 1, 1}, Units{1e6, 1, 1}, Units{1e3, 1e-5, 1e4}}) {
    const ContinuationReport report = in(units);
    ASSERT_EQ(report.status, known.status) << report.message;
    ASSERT_EQ(report.folds.size(), 1U);
    EXPECT_NEAR(report.folds[0].s, known.folds[0].s, 1e-9);
    const double unit = action_unit(subject, units);
    EXPECT_NEAR(report.folds[0].action / unit, known.folds[0].action, 1e-8);
    EXPECT_NEAR(
        report.points.back().geodesic.action / unit, known.points.back().geodesic.action, 1e-8);
  }
}

// The derivative of an end point is the same, in packs and stage by stage: with coordinates in
// small and in large units no column of it is lost beside another one.
TEST(Invariances, OfUnitsInTangentFlows) {
  // M is as large as 2000 and grows from round-off of 64 steps.
  constexpr double kSame = 1e4 * std::numeric_limits<double>::epsilon();
  const Subject subject = subjects()[0];
  const TextScene scene = scene_from_text(subject.text);
  const std::vector<double> p0{4.7, 8, -1.5, 2};
  for (const char* method : {"gauss16", "gauss4", "midpoint4", "lobatto6"}) {
    const auto tangent = [&](double length) {
      const Dynamics dynamics = make_dynamics(scene.with({{"L", length}}), method);
      std::vector<double> unit{length, length, 1, 1};
      for (int j = 0; j < 4; ++j) unit.push_back(length * length / unit[j]);
      std::vector<double> z(8, 0.0), m(64);
      for (int j = 0; j < 4; ++j) z[4 + j] = p0[j] * unit[4 + j];
      EXPECT_TRUE(dynamics.tangent_flow(StepPlan::equal(0, 1, 64), z, m).completed());
      for (int i = 0; i < 64; ++i) m[i] *= unit[i % 8] / unit[i / 8];
      return m;
    };
    const std::vector<double> known = tangent(1);
    const double size = *std::max_element(known.begin(), known.end());
    for (const double length : {1e-6, 1e-3, 1e3, 1e6}) {
      const std::vector<double> m = tangent(length);
      for (int i = 0; i < 64; ++i) {
        EXPECT_NEAR(m[i], known[i], kSame * size) << method << ' ' << length << ' ' << i;
      }
    }
  }
}

// A warm start takes the same flows to the same answers.
TEST(Invariances, OfUnitsInWarmStarts) {
  const Subject subject = subjects()[0];
  const std::vector<double> zero{0, 0, 0, 0};
  GeodesicOptions options;
  options.samples = 0;
  const BoundaryValueProblem own = problem_in(subject, zero, {0, 1, 0, 0}, {});
  const std::vector<double> parking = find_geodesics(own, options).geodesics.at(0).p0;
  struct Answer {
    WarmStartReport report;
    std::vector<double> p0;  // in units of one
  };
  const auto in = [&](const Units& units) {
    const BoundaryValueProblem problem = problem_in(subject, zero, {0, 1, 0, 0}, units);
    const std::vector<double> to = problem_in(subject, zero, {0.003, 1.01, 0.002, 0}, units).to;
    std::vector<double> unit, p0 = parking;
    for (const double power : subject.powers) {
      unit.push_back(action_unit(subject, units) / std::pow(units.length, power));
    }
    for (int j = 0; j < 4; ++j) p0[j] *= unit[j];
    const WarmStart start(problem, p0);
    EXPECT_TRUE(start.ready()) << units.length;
    Answer answer{start.solve(to.data(), p0.data()), p0};
    for (int j = 0; j < 4; ++j) answer.p0[j] /= unit[j];
    return answer;
  };
  const Answer known = in({});
  ASSERT_TRUE(known.report.converged);
  for (const Units units : {Units{1e-6, 1, 1}, Units{1e6, 1, 1}, Units{1e-3, 1e-5, 1e4}}) {
    const Answer answer = in(units);
    EXPECT_TRUE(answer.report.converged) << units.length << ' ' << answer.report.endpoint_error;
    // The last corrections are of round-off.
    EXPECT_LE(answer.report.flows, known.report.flows + 1);
    // |dq(T)/dp0|^-1 is about 100, and each is within the tolerance of 1e-10.
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(answer.p0[j], known.p0[j], 4e-8);
  }
}

// What is too near to be searched is told by the length of the scene: in small units, too, a target
// half of it away is not.
TEST(Invariances, OfUnitsInSteering) {
  constexpr double kSame = 1e-9;
  const TextScene unicycle = scene_from_text(
      "coordinates x, y [length], theta [angle]\nparameters L = 1 > 0\n"
      "kinetic = (x'^2 + y'^2 + L^2 theta'^2) / 2\n0 = x' sin(theta) - y' cos(theta)\n");
  const auto sideways = [&](double away, double length) {
    const SteeringFunction steer(make_dynamics(unicycle.with({{"L", length}})));
    const std::vector<double> from{0, 0, 0};
    const std::vector<double> to{0, away * length, 0};
    return steer.distance(from, to) / length;
  };
  for (const double away : {1e-10, 1e-4, 0.5}) {
    const double known = sideways(away, 1);
    for (const double length : {1e-12, 1e6}) {
      EXPECT_NEAR(sideways(away, length), known, kSame * known) << away << ' ' << length;
    }
  }
}

TEST(Invariances, OfPlaces) {
  constexpr double kSame = 1e-9;
  const double turn = 0.7;
  const auto moved = [&](const std::vector<double>& q) {
    return std::vector<double>{std::cos(turn) * q[0] - std::sin(turn) * q[1] + 300,
                               std::sin(turn) * q[0] + std::cos(turn) * q[1] - 20,
                               q[2] + turn,
                               q[3] + turn};
  };
  const auto mirrored = [](const std::vector<double>& q) {
    return std::vector<double>{q[0], -q[1], -q[2], -q[3]};
  };
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 3; ++i) {
    std::vector<double> from(4), to(4);
    for (int j = 0; j < 4; ++j) from[j] = normal(random);
    for (int j = 0; j < 4; ++j) to[j] = 2 * normal(random);
    const auto action = [](const std::vector<double>& a, const std::vector<double>& b) {
      GeodesicOptions options;
      options.samples = 0;
      return find_geodesics(test::vehicle(a, b), options).geodesics.at(0).action;
    };
    const double one = action(from, to);
    EXPECT_NEAR(action(moved(from), moved(to)), one, kSame * one);
    EXPECT_NEAR(action(mirrored(from), mirrored(to)), one, kSame * one);
    EXPECT_NEAR(action(to, from), one, kSame * one);
  }
}

// Scales of a problem at unit size are one, so that nothing is converted.
TEST(NaturalScales, OfAWheelbaseOfOneAreOne) {
  EXPECT_TRUE(natural_scales(test::sideways()).trivial());
  EXPECT_TRUE(natural_scales(test::unicycle({0, 0, 0}, {3, 1, 0})).trivial());
}

// s tan(s + delta) = 1 where the wheel is turned by delta at one end, so s is 0.86 for small ones.
TEST(NaturalScales, OfABicycleDoNotDependOnHowStraightItEnds) {
  constexpr double kBisected = 1e-5;
  for (const double delta : {1e-9, 1e-3, -1e-3, 0.1, -1.0}) {
    const double s = natural_scales(test::bicycle({1, 1, 1, delta})).q[0];
    EXPECT_NEAR(s * std::tan(s + std::abs(delta)), 1, 10 * kBisected) << delta;
  }
}

TEST(NaturalScales, AreThoseOfTheScene) {
  BoundaryValueProblem problem = test::long_vehicle({0, 0, 0, 0}, {0, 1, 0, 0}, 100);
  problem.time = 4;
  const NaturalScales scales = natural_scales(problem);
  EXPECT_EQ(scales.time, 4);
  EXPECT_DOUBLE_EQ(scales.energy() * scales.time, scales.action);
  // alpha = beta = 1 say what a radian is worth.
  EXPECT_EQ(scales.q, (std::vector<double>{1, 1, 1, 1}));
  EXPECT_EQ(scales.rows, (std::vector<double>{1, 1}));
  // A dilation of the Heisenberg group.
  const NaturalScales small = natural_scales(test::heisenberg_group({1e-3, 2e-3, 3e-6}));
  const NaturalScales large = natural_scales(test::heisenberg_group({1e3, 2e3, 3e6}));
  constexpr double kRounded = 1e-11;
  EXPECT_NEAR(large.q[0] / small.q[0], 1e6, 1e6 * kRounded);
  EXPECT_NEAR(large.q[2] / small.q[2], 1e12, 1e12 * kRounded);
  EXPECT_NEAR(large.action / small.action, 1e12, 1e12 * kRounded);
}

// Every call of the rescaled scene against that of the scene.
class RescaledTest : public ::testing::TestWithParam<Subject> {};
// Of those without a drift, which have a transcription.
class RescaledTranscription : public ::testing::TestWithParam<Subject> {};

TEST_P(RescaledTest, SaysTheSameInOtherUnits) {
  constexpr double kRounded = 1e-12;
  const Subject& subject = GetParam();
  const std::size_t n = subject.sizes.size();
  std::vector<double> from, to, p, p_own;
  for (std::size_t j = 0; j < n; ++j) {
    from.push_back(0.3 + 0.1 * static_cast<double>(j));
    to.push_back(0.9 - 0.2 * static_cast<double>(j));
    p.push_back(0.5 - 0.3 * static_cast<double>(j));
  }
  const BoundaryValueProblem own = problem_in(subject, from, to, {7, 3, 5});
  NaturalScales scales = natural_scales(own);
  scales.time = 5;
  const BoundaryValueProblem problem = rescaled(own, scales);
  const Dynamics& a = own.dynamics;
  const Dynamics& b = problem.dynamics;
  for (std::size_t j = 0; j < n; ++j) {
    p_own.push_back(p[j] * scales.momentum(static_cast<int>(j)));
    EXPECT_NEAR(problem.to[j] * scales.q[j], own.to[j], kRounded * std::abs(own.to[j]));
  }
  std::vector<double> va(n), vb(n), la(a.multipliers), lb(b.multipliers);
  const double ha = a.evaluate(0, own.from, p_own, va, la).hamiltonian;
  const double hb = b.evaluate(0, problem.from, p, vb, lb).hamiltonian;
  EXPECT_NEAR(hb * scales.energy(), ha, kRounded * std::abs(ha));
  for (std::size_t j = 0; j < n; ++j) {
    EXPECT_NEAR(vb[j] * scales.q[j] / scales.time, va[j], kRounded * (1 + std::abs(va[j])));
  }
  for (std::size_t i = 0; i < la.size(); ++i) {
    EXPECT_NEAR(lb[i] * scales.multipliers[i], la[i], kRounded * (1 + std::abs(la[i])));
  }
  // A flow, its tangent, and what is measured along it.
  std::vector<double> za = own.from, zb = problem.from;
  za.insert(za.end(), p_own.begin(), p_own.end());
  zb.insert(zb.end(), p.begin(), p.end());
  std::vector<double> ma(4 * n * n), mb(4 * n * n);
  std::vector<double> ya = za, yb = zb;
  ASSERT_TRUE(a.tangent_flow(StepPlan::equal(0, 5, 32), ya, ma).completed());
  ASSERT_TRUE(b.tangent_flow(StepPlan::equal(0, 1, 32), yb, mb).completed());
  std::vector<double> units = scales.q;
  for (std::size_t j = 0; j < n; ++j) units.push_back(scales.momentum(static_cast<int>(j)));
  for (std::size_t r = 0; r < 2 * n; ++r) {
    EXPECT_NEAR(yb[r] * units[r], ya[r], kRounded * (units[r] + std::abs(ya[r])));
    for (std::size_t c = 0; c < 2 * n; ++c) {
      const double expected = ma[r * 2 * n + c] * units[c] / units[r];
      EXPECT_NEAR(mb[r * 2 * n + c], expected, 1e2 * kRounded * (1 + std::abs(expected)));
    }
  }
  MonitorOptions options;
  options.times = {0, 0.5, 1};
  const FlowSummary measured = b.monitored_flow(StepPlan::equal(0, 1, 32), zb, options);
  options.times = {0, 2.5, 5};
  const FlowSummary expected = a.monitored_flow(StepPlan::equal(0, 5, 32), za, options);
  EXPECT_NEAR(measured.action * scales.action,
              expected.action,
              kRounded * (scales.action + std::abs(expected.action)));
  if (std::isfinite(expected.length)) {
    EXPECT_NEAR(measured.length * scales.length(), expected.length, kRounded * expected.length);
  }
  ASSERT_EQ(measured.trajectory.t, (std::vector<double>{0, 0.5, 1}));
  for (std::size_t j = 0; j < n; ++j) {
    EXPECT_NEAR(measured.trajectory.q[1][j] * scales.q[j],
                expected.trajectory.q[1][j],
                kRounded * (scales.q[j] + std::abs(expected.trajectory.q[1][j])));
  }
}

// Its transcription is consistent: first derivatives against differences of the action, second ones
// against those of the first.
TEST_P(RescaledTranscription, HasConsistentDerivatives) {
  constexpr double kStep = 1e-5;
  constexpr double kDifference = 1e-8;
  const Subject& subject = GetParam();
  const std::vector<double> from{0.3, 0.4, 0.5, 0.2};
  const std::vector<double> to{0.9, 0.7, 0.6, 0.1};
  const auto n = static_cast<long>(subject.sizes.size());
  const BoundaryValueProblem own = problem_in(
      subject, {from.begin(), from.begin() + n}, {to.begin(), to.begin() + n}, {7, 3, 5});
  const BoundaryValueProblem problem = rescaled(own, natural_scales(own));
  ASSERT_TRUE(problem.dynamics.has_transcription());
  std::vector<double> x = problem.from;
  x.insert(x.end(), problem.to.begin(), problem.to.end());
  for (int i = 0; i < problem.dynamics.transcribed; ++i) x.push_back(0.4 - 0.3 * i);
  const std::size_t m = x.size();
  std::vector<double> gradient(m), hessian(m * m), ahead(m), behind(m);
  problem.dynamics.discrete_lagrangian(0.1, x, gradient, hessian);
  for (std::size_t j = 0; j < m; ++j) {
    std::vector<double> moved = x;
    moved[j] = x[j] + kStep;
    problem.dynamics.discrete_lagrangian(0.1, moved, ahead);
    moved[j] = x[j] - kStep;
    problem.dynamics.discrete_lagrangian(0.1, moved, behind);
    for (std::size_t i = 0; i < m; ++i) {
      const double difference = (ahead[i] - behind[i]) / (2 * kStep);
      EXPECT_NEAR(hessian[i * m + j], difference, kDifference * (100 + std::abs(difference)));
    }
  }
}

// Intervals side by side are those one by one, in units that are not the scene's.
TEST_P(RescaledTranscription, IsTheSameSideBySide) {
  // Packs contract sums in another way; the condition of M and of F'F is below a hundred.
  constexpr double kPacked = 1000 * std::numeric_limits<double>::epsilon();
  constexpr int kLanes = Dynamics::kMidpointLanes;
  const Subject& subject = GetParam();
  const std::vector<double> from{0.3, 0.4, 0.5, 0.2};
  const std::vector<double> to{0.9, 0.7, 0.6, 0.1};
  const auto n = static_cast<long>(subject.sizes.size());
  const BoundaryValueProblem own = problem_in(
      subject, {from.begin(), from.begin() + n}, {to.begin(), to.begin() + n}, {7, 3, 5});
  const BoundaryValueProblem problem = rescaled(own, natural_scales(own));
  const std::size_t m = 2 * n + problem.dynamics.transcribed;
  std::vector<double> x(m * kLanes), gradient(x.size()), hessian(m * x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = std::sin(static_cast<double>(i + 1)) + (i < x.size() / 2 ? 2 : 0);
  problem.dynamics.discrete_lagrangians(0.1, x, gradient, hessian);
  for (int l = 0; l < kLanes; ++l) {
    std::vector<double> at(m), first(m), second(m * m);
    for (std::size_t i = 0; i < m; ++i) at[i] = x[i * kLanes + l];
    problem.dynamics.discrete_lagrangian(0.1, at, first, second);
    double size = 1;
    for (const double entry : second) size = std::max(size, std::abs(entry));
    for (std::size_t i = 0; i < m; ++i) {
      EXPECT_NEAR(gradient[i * kLanes + l], first[i], kPacked * size);
    }
    for (std::size_t i = 0; i < m * m; ++i) {
      EXPECT_NEAR(hessian[i * kLanes + l], second[i], kPacked * size);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RescaledTest, ::testing::ValuesIn(subjects()), name_of);

INSTANTIATE_TEST_SUITE_P(Scenes, RescaledTranscription, ::testing::ValuesIn(driftless()), name_of);

}  // namespace
}  // namespace carnot::internal::invariance_test
