// Geodesics whose ends are free in some coordinates: closed forms, transversality, and the same
// problem solved in another way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "carnot/shooting/continuation.h"
#include "carnot/shooting/extremal/symmetry.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/path/discrete_equations.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/warm_start.h"
#include "shooting/drift_problems.h"
#include "shooting/problems.h"

namespace carnot::internal::free_ends_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSolved = 1e-9;  // the tolerance of an extremal, magnified by what it leads to

BoundaryValueProblem with_free(BoundaryValueProblem problem,
                               const std::vector<int>& from,
                               const std::vector<int>& to) {
  problem.free_from.assign(problem.from.size(), false);
  problem.free_to.assign(problem.to.size(), false);
  for (const int j : from) problem.free_from[j] = true;
  for (const int j : to) problem.free_to[j] = true;
  return problem;
}

Geodesic best(const BoundaryValueProblem& problem, const std::string& minimiser = "newton") {
  GeodesicOptions options;
  options.minimiser = minimiser;
  const GeodesicReport report = find_geodesics(problem, options);
  EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  return report.geodesics.empty() ? Geodesic{} : report.geodesics.front();
}

// What transversality asks of the samples, which are flows of their own.
void expect_transversal(const BoundaryValueProblem& problem, const Geodesic& geodesic) {
  const Trajectory& path = geodesic.trajectory;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (problem.is_free_from(j)) {
      EXPECT_EQ(path.p.front()[j], 0) << j;
    } else {
      EXPECT_EQ(geodesic.from[j], problem.from[j]) << j;
    }
    if (problem.is_free_to(j)) {
      EXPECT_NEAR(path.p.back()[j], 0, kSolved) << j;
    } else {
      EXPECT_EQ(geodesic.to[j], problem.to[j]) << j;
    }
    EXPECT_NEAR(path.q.front()[j], geodesic.from[j], kSolved) << j;
    EXPECT_NEAR(path.q.back()[j], geodesic.to[j], kSolved) << j;
  }
  EXPECT_LE(geodesic.transversality_error, kSolved);
}

// The straight line is shortest to a vertical line of the Heisenberg group; it ends where its own
// height leads.
TEST(FreeEnds, ReachAVerticalLineOfTheHeisenbergGroup) {
  const BoundaryValueProblem problem = with_free(test::heisenberg_group({1, 0.5, 3}), {}, {2});
  const Geodesic geodesic = best(problem);
  EXPECT_NEAR(geodesic.action, 0.5 * 1.25, kSolved);
  EXPECT_NEAR(geodesic.to[2], 0, kSolved);
  EXPECT_EQ(geodesic.label, Label::kLocallyMinimal);
  expect_transversal(problem, geodesic);
}

// With free headings at both ends the unicycle drives straight, forwards or backwards.
TEST(FreeEnds, LetTheUnicycleDriveStraight) {
  const BoundaryValueProblem problem = with_free(test::unicycle({0, 0, 0}, {1, 2, 0}), {2}, {2});
  const Geodesic geodesic = best(problem);
  EXPECT_NEAR(geodesic.action, 2.5, kSolved);
  EXPECT_NEAR(std::tan(geodesic.from[2]), 2, 1e-4);  // the action is flat there: sqrt(1e-9)
  expect_transversal(problem, geodesic);
}

// d(action) / d(to_j) = p_j(T): no fixed heading nearby is better, and the slope beside it is p.
TEST(FreeEnds, AreWhereTheActionOfFixedEndsIsStationary) {
  constexpr double kStep = 1e-3;
  constexpr double kThirdOrder = 1e-4;  // of the difference quotient of actions of about 5
  const BoundaryValueProblem fixed = test::unicycle({0, 0, 0}, {1, 2, 0});
  const Geodesic free = best(with_free(fixed, {}, {2}));
  double actions[2];
  for (const int side : {0, 1}) {
    BoundaryValueProblem beside = fixed;
    beside.to[2] = free.to[2] + (side == 0 ? -kStep : kStep);
    const Geodesic geodesic = best(beside);
    actions[side] = geodesic.action;
    EXPECT_GT(geodesic.action, free.action);
    const double slope = (geodesic.action - free.action) / (beside.to[2] - free.to[2]);
    EXPECT_NEAR(2 * slope, geodesic.trajectory.p.back()[2], kThirdOrder);
  }
  EXPECT_NEAR(actions[0], actions[1], kThirdOrder * kStep);
}

TEST(FreeEnds, AreTheSameByEveryMinimiserAndFromBothSides) {
  const BoundaryValueProblem problem = with_free(test::sideways(), {3}, {3});
  const Geodesic by_newton = best(problem);
  expect_transversal(problem, by_newton);
  EXPECT_EQ(by_newton.label, Label::kLocallyMinimal);
  for (const std::string minimiser : {"ceres", "nlopt", "nlopt:lbfgs"}) {
    const Geodesic other = best(problem, minimiser);
    EXPECT_NEAR(other.action, by_newton.action, kSolved * by_newton.action) << minimiser;
    expect_transversal(problem, other);
  }
  const BoundaryValueProblem one = with_free(test::sideways(), {}, {3});
  BoundaryValueProblem reversed = with_free(one, {3}, {});
  std::swap(reversed.from, reversed.to);
  EXPECT_NEAR(best(one).action, best(reversed).action, kSolved * by_newton.action);
}

// Its momentum stays zero along the whole path. Driven backwards the same path has the same label.
TEST(FreeEnds, AreLabelledWhereTheStartIsFreeInWhatTheSceneDoesNotDependOn) {
  const struct {
    BoundaryValueProblem forth;
    std::vector<int> free;
  } cases[] = {{test::heisenberg_group({1, 0, 0}), {2}},
               {test::vehicle({0, 0, 0, 0}, {1, 1, 0, 0}), {0}},
               {test::vehicle({0, 0, 0, 0}, {1, 1, 0, 0}), {1}},
               {test::unicycle({0, 0, 0}, {1, 1, 0.5}), {0}},
               {test::martinet({0.5, 0.5, 0.5}), {2}}};
  for (const auto& [forth, free] : cases) {
    SCOPED_TRACE(forth.dynamics.info.name);
    const Geodesic start = best(with_free(forth, free, {}));
    BoundaryValueProblem back = forth;
    std::swap(back.from, back.to);
    const Geodesic target = best(with_free(back, {}, free));
    EXPECT_NEAR(start.action, target.action, kSolved * target.action);
    EXPECT_EQ(target.label, Label::kLocallyMinimal);
    EXPECT_EQ(start.label, target.label);
    EXPECT_EQ(start.morse_index, target.morse_index);
    EXPECT_EQ(start.abnormal, target.abnormal);
  }
}

TEST(FreeEnds, NeverCostMoreThanFixedOnes) {
  constexpr int kTargets = 100;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int i = 0; i < kTargets; ++i) {
    std::vector<double> to(4);
    for (double& x : to) x = uniform(random);
    const BoundaryValueProblem fixed = test::vehicle({0, 0, 0, 0}, to);
    const BoundaryValueProblem free = with_free(fixed, {}, {3});
    const Geodesic geodesic = best(free);
    EXPECT_LE(geodesic.action, best(fixed).action * (1 + kSolved)) << i;
    EXPECT_EQ(geodesic.label, Label::kLocallyMinimal) << i;
    expect_transversal(free, geodesic);
  }
}

// x'' = u at the cost u^2 / 2 from rest to x = 1 at any speed: u = 3 (1 - t), 3 / 2.
TEST(FreeEnds, SolveADoubleIntegratorThatNeedNotStop) {
  const BoundaryValueProblem problem =
      with_free({test::double_integrator(), {0, 0}, {1, 0}, 1}, {}, {1});
  const Geodesic geodesic = best(problem);
  EXPECT_NEAR(geodesic.action, 1.5, kSolved);
  EXPECT_NEAR(geodesic.p0[0], 3, kSolved);
  EXPECT_NEAR(geodesic.to[1], 1.5, kSolved);
  EXPECT_EQ(geodesic.label, Label::kLocallyMinimal);
}

// The pendulum that may pass its upper position at any speed takes less than the one that stops.
TEST(FreeEnds, SwingUpAPendulumThatNeedNotStop) {
  const BoundaryValueProblem stops = test::swing_up();
  const BoundaryValueProblem passes = with_free(stops, {}, {1});
  const Geodesic geodesic = best(passes);
  EXPECT_LT(geodesic.action, best(stops).action);
  expect_transversal(passes, geodesic);
}

// x'' = -x from a free start at rest is a cos t: focal at pi / 2, not at pi.
BoundaryValueProblem spring(double from, double to, double time) {
  const Dynamics dynamics = test::from_text("coordinates x\nlagrangian = (x'^2 - x^2) / 2\n");
  return {dynamics, {from}, {to}, time};
}

TEST(FocalTimes, AreThoseOfASpringThatIsLetGo) {
  const Geodesic before = best(with_free(spring(0, 1, 1.5), {0}, {}));
  EXPECT_NEAR(before.from[0], 1 / std::cos(1.5), 1e-8);
  ASSERT_TRUE(before.conjugate_times);
  EXPECT_TRUE(before.conjugate_times->empty());
  EXPECT_EQ(before.label, Label::kLocallyMinimal);
  const Geodesic after = best(with_free(spring(0, 1, 2), {0}, {}));
  ASSERT_TRUE(after.conjugate_times);
  ASSERT_EQ(after.conjugate_times->size(), 1U);
  EXPECT_NEAR(after.conjugate_times->front(), kPi / 2, 1e-10);
  EXPECT_EQ(after.morse_index, 1);
  EXPECT_EQ(after.label, Label::kConjugatePassed);
}

// From x = 1 to a free end x = cos(T - t) / cos T. Its index is one from pi / 2 to 3 pi / 2, where
// conjugate times alone say one from pi on.
TEST(FocalTimes, CountWhatMovingAFreeTargetGains) {
  constexpr double kBeside = 1e-12;  // far less than the doubt of phases, far more than round-off
  for (const double time :
       {1.0, 1.5, 1.7, 3.0, kPi * (1 - kBeside), kPi, kPi * (1 + kBeside), 3.3, 4.6, 4.8}) {
    const Geodesic geodesic = best(with_free(spring(1, 0, time), {}, {0}));
    EXPECT_NEAR(geodesic.to[0], 1 / std::cos(time), 1e-8 / std::abs(std::cos(time))) << time;
    const int index = static_cast<int>(std::floor(time / kPi + 0.5));
    EXPECT_EQ(geodesic.morse_index, index) << time;
    EXPECT_EQ(geodesic.label, index == 0 ? Label::kLocallyMinimal : Label::kConjugatePassed)
        << time;
  }
}

// The gradient of the discrete action by everything that is free, by differences.
TEST(FreeEnds, AreInTheEquationsOfTheGrid) {
  constexpr int kIntervals = 8;
  constexpr double kStep = 1e-6;
  constexpr double kDifferences = 1e-6;  // of second derivatives of some hundreds
  for (const bool by_hamiltonian : {false, true}) {
    BoundaryValueProblem problem = with_free(test::sideways(), {2, 3}, {3});
    if (by_hamiltonian) {
      problem = with_free({test::double_integrator(), {0, 0}, {1, 0}, 1}, {0}, {1});
    }
    const int n = problem.dynamics.dof;
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Path path{kIntervals, n, std::vector<double>((kIntervals + 1) * n), {}, {}};
    path.lambda.resize(kIntervals * PathLagrangian::multipliers(problem.dynamics));
    for (double& x : path.q) x = uniform(random);
    for (double& x : path.lambda) x = uniform(random);
    DiscreteEquations equations(problem, kIntervals);
    BandedLu matrix = equations.matrix();
    std::vector<double> residual;
    equations.evaluate(path, residual, &matrix);
    ASSERT_EQ(static_cast<int>(residual.size()), equations.size());
    int multipliers = 0;
    for (int c = 0; c < equations.size(); ++c) {
      multipliers += equations.is_multiplier(c) ? 1 : 0;
      std::vector<double> along(equations.size(), 0.0);
      along[c] = 1;
      std::vector<double> up, down;
      Path moved = path;
      equations.move(path, along, -kStep, moved);
      equations.evaluate(moved, up, nullptr);
      equations.move(path, along, kStep, moved);
      equations.evaluate(moved, down, nullptr);
      for (int r = std::max(0, c - 2 * n); r < std::min(equations.size(), c + 2 * n); ++r) {
        EXPECT_NEAR((up[r] - down[r]) / (2 * kStep), matrix(r, c), kDifferences) << r << ' ' << c;
      }
    }
    EXPECT_EQ(multipliers, static_cast<int>(path.lambda.size()));
  }
}

// Unknowns and conditions stand where they should, and lead back.
TEST(FreeEnds, ExchangeConfigurationsAndMomenta) {
  const BoundaryValueProblem problem =
      with_free(test::vehicle({1, 2, 3, 4}, {5, 6, 7, 8}), {1}, {3});
  const std::vector<double> x{10, 20, 30, 40};
  const std::vector<double> z = phase_point(problem, x);
  EXPECT_EQ(z, (std::vector<double>{1, 20, 3, 4, 10, 0, 30, 40}));
  EXPECT_EQ(start_unknowns(problem, z.data()), x);
  EXPECT_EQ(target_index(problem, 2), 2);
  EXPECT_EQ(target_index(problem, 3), 7);
  EXPECT_EQ(target_value(problem, 2), 7);
  EXPECT_EQ(target_value(problem, 3), 0);
  EXPECT_EQ(distance_between_ends(problem), 4);  // of x and theta alone
  EXPECT_EQ(endpoint_error(problem, z.data()), 14);
  EXPECT_EQ(transversality_error(problem, z.data()), 40);
  EXPECT_EQ(miss(problem, z.data(), 1), 40);
  EXPECT_EQ(length_per_momentum(problem, z.data() + 4), 0.1);
}

TEST(FreeEnds, KeepTheSymmetriesThatTheyShare) {
  // Backwards, and the mirror image, of both ends with a free wheel; without the other end's free
  // wheel backwards is no symmetry.
  const std::size_t both = symmetries_of(with_free(test::sideways(), {3}, {3})).size();
  const std::size_t one = symmetries_of(with_free(test::sideways(), {}, {3})).size();
  EXPECT_GT(both, one);
}

TEST(FreeEnds, StayWhereNothingNeedsToMove) {
  BoundaryValueProblem problem = with_free(test::sideways(), {}, {3});
  problem.to[1] = 0;
  problem.to[3] = 2;
  const Geodesic geodesic = best(problem);
  EXPECT_EQ(geodesic.action, 0);
  EXPECT_EQ(geodesic.to, problem.from);
  problem = with_free(test::sideways(), {1, 3}, {});
  problem.from[3] = 2;
  EXPECT_EQ(best(problem).from, problem.to);
}

TEST(FreeEnds, AreFollowedAlongALineOfProblems) {
  const BoundaryValueProblem problem = with_free(test::sideways(), {3}, {3});
  const std::vector<double> to{0, 0.5, 0, 0};
  for (const ProblemLine& line :
       {moving_target(problem, to), moving_start(problem, {0, 0.5, 0, 0})}) {
    const ContinuationReport report = continue_geodesic(line, best(problem));
    ASSERT_EQ(report.status, ContinuationStatus::kReached) << report.message;
    const BoundaryValueProblem last = line.at(1);
    for (const ContinuationPoint& point : report.points) {
      EXPECT_LE(point.geodesic.transversality_error, kSolved);
    }
    EXPECT_NEAR(report.points.back().geodesic.action, best(last).action, 1e-7);
  }
}

TEST(FreeEnds, AreReachedFromAWarmStart) {
  const BoundaryValueProblem problem = with_free(test::sideways(), {}, {3});
  const Geodesic known = best(problem);
  const WarmStart warm(problem, known.p0);
  ASSERT_TRUE(warm.ready());
  const std::vector<double> to{0.02, 0.98, 0.01, 77};  // what is free does not count
  std::vector<double> p0(4);
  const WarmStartReport report = warm.solve(to.data(), p0.data());
  ASSERT_TRUE(report.converged);
  BoundaryValueProblem moved = problem;
  moved.to = to;
  moved.to[3] = 0;
  GeodesicOptions options;
  options.guess = p0;
  const GeodesicReport checked = find_geodesics(moved, options);
  ASSERT_EQ(checked.geodesics.size(), 1U);
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(checked.geodesics[0].p0[j], p0[j], 1e-7) << j;
}

// The guess has the coordinates of the caller, also where the search moves the origin.
TEST(FreeEnds, StartFromAGuess) {
  BoundaryValueProblem problem = with_free(test::sideways(), {0}, {});
  problem.to[0] = 5;
  const Geodesic known = best(problem);
  GeodesicOptions options;
  options.guess = known.p0;
  options.guess[0] = known.from[0];
  const GeodesicReport report = find_geodesics(problem, options);
  ASSERT_EQ(report.geodesics.size(), 1U);
  EXPECT_NEAR(report.geodesics[0].from[0], known.from[0], kSolved);
  EXPECT_NEAR(report.geodesics[0].action, known.action, kSolved * known.action);
}

TEST(FreeEnds, AreRefusedWhereTheyCannotBe) {
  BoundaryValueProblem problem = test::sideways();
  problem.free_to = {true};
  EXPECT_THROW(problem.validate(), std::invalid_argument);
  const Dynamics dynamics =
      test::from_text("coordinates x, y\nkinetic = (x'^2 + y'^2) / 2\n0 = x^2 + y^2 - 1\n");
  BoundaryValueProblem circle(dynamics, {1, 0}, {0, 1});
  circle.validate();
  circle.free_to = {false, true};
  EXPECT_THROW(circle.validate(), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::internal::free_ends_test
