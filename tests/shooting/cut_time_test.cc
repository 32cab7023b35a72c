// Cut times, of cut_time() and as where the list of geodesics changes its first entry.
//
// On SE(2), the unicycle with angles modulo 2 pi:
//
// At unit speed, with rho = |(p_x, p_y)|, theta'^2 = 1 - rho^2 cos^2(theta - phi): a pendulum. A
// geodesic is the shortest up to the time (Sachkov, ESAIM: COCV 16 (2010), 1018)
//
//   2 K(rho) for rho < 1,      2 k p1(k), k = 1 / rho, for rho > 1,
//
// where p1(k) is the least positive zero of cn(p) (E(p) - p) - dn(p) sn(p).
#include "carnot/shooting/cut_time.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::cut_time_test {
namespace {

double cut_time(double rho) {
  if (rho < 1) return 2 * std::comp_ellint_1(rho);
  const double k = 1 / rho;
  const auto f = [&](double amplitude) {
    const double sn = std::sin(amplitude);
    return std::cos(amplitude) * (std::ellint_2(k, amplitude) - std::ellint_1(k, amplitude)) -
           std::sqrt(1 - k * k * sn * sn) * sn;
  };
  double low = 0.5 * std::numbers::pi;  // f < 0
  double high = std::numbers::pi;       // f > 0
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0 ? low : high) = middle;
  }
  return 2 * k * std::ellint_1(k, low);
}

// A geodesic from the origin at unit speed.
struct Ray {
  double rho;
  double p_x;  // the speed at first
};

class CutTimes : public testing::TestWithParam<Ray> {
 protected:
  // The momentum for which time 1 is time t at unit speed.
  [[nodiscard]] std::vector<double> momentum(double t) const {
    const auto [rho, p_x] = GetParam();
    return {t * p_x, t * std::sqrt(rho * rho - p_x * p_x), t * std::sqrt(1 - p_x * p_x)};
  }

  // From the origin to where the ray is at time t.
  [[nodiscard]] BoundaryValueProblem problem(double t) const {
    BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 0, 0});
    constexpr long kSteps = 128;
    std::vector<double> z{0, 0, 0};
    for (const double p : momentum(t)) z.push_back(p);
    EXPECT_TRUE(problem.dynamics.flow(StepPlan::equal(0, 1, kSteps), z).completed());
    problem.to.assign(z.begin(), z.begin() + 3);
    return problem;
  }

  [[nodiscard]] Geodesic shortest(double t) const {
    GeodesicOptions options;
    options.samples = 0;
    options.mod_angles = true;
    const GeodesicReport report = find_geodesics(problem(t), options);
    EXPECT_EQ(report.status, GeodesicStatus::kConverged);
    return report.geodesics.at(0);
  }

  // Follows a rival of the ray to time t. How much more its action is.
  [[nodiscard]] double lead(double t, Geodesic& rival) const {
    GeodesicOptions options;
    options.samples = 0;
    options.guess = rival.p0;
    BoundaryValueProblem there = problem(t);
    there.to[2] += 2 * std::numbers::pi * rival.windings[2];
    const GeodesicReport report = find_geodesics(there, options);
    if (report.geodesics.empty()) return std::nan("");
    rival.p0 = report.geodesics[0].p0;
    return report.geodesics[0].action - 0.5 * t * t;
  }
};

TEST_P(CutTimes, UpToItTheRayIsTheShortest) {
  constexpr double kBefore = 0.99;
  constexpr double kTolerance = 1e-9;  // ends agree to 1e-10
  const double t = kBefore * cut_time(GetParam().rho);
  const Geodesic first = shortest(t);
  EXPECT_NEAR(first.action, 0.5 * t * t, kTolerance);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(first.p0[j], momentum(t)[j], kTolerance);
  EXPECT_EQ(first.label, Label::kLocallyMinimal);
}

TEST_P(CutTimes, FromItOnAnotherOneIs) {
  constexpr double kAfter = 1.01;
  constexpr double kTolerance = 1e-9;  // relative, of the cut time
  const double expected = cut_time(GetParam().rho);
  double t = kAfter * expected;
  Geodesic rival = shortest(t);
  double ahead = rival.action - 0.5 * t * t;
  EXPECT_LT(ahead, -1e-4);
  // The time at which both are as long, by the secant method.
  double next = 0.5 * (1 + kAfter) * expected;
  constexpr int kIterations = 8;
  for (int i = 0; i < kIterations && std::abs(next - t) > 1e-12 * t; ++i) {
    const double ahead_there = lead(next, rival);
    ASSERT_TRUE(std::isfinite(ahead_there));
    const double slope = (ahead_there - ahead) / (next - t);
    t = next;
    ahead = ahead_there;
    next = t - ahead / slope;
  }
  EXPECT_NEAR(next, expected, kTolerance * expected);
  EXPECT_GT(std::abs(rival.p0[2] - momentum(next)[2]) + std::abs(rival.p0[0] - momentum(next)[0]),
            1e-3);  // it is another one
}

// Windings of the wheel as the pendulum turns over, and oscillates.
INSTANTIATE_TEST_SUITE_P(
    Sides,
    CutTimes,
    testing::Values(Ray{0.5, 0.3}, Ray{0.9, 0.5}, Ray{1.3, 0.6}, Ray{2.5, 0.5}),
    [](const auto& test) { return "Rho" + std::to_string(std::lround(10 * test.param.rho)); });

using std::numbers::pi;

CutTime cut_of(const BoundaryValueProblem& problem,
               const std::vector<double>& p0,
               const CutTimeOptions& options = {}) {
  return cut_time(problem.dynamics, problem.from, p0, options);
}

std::vector<double> scaled(std::vector<double> p, double factor) {
  for (double& x : p) x *= factor;
  return p;
}

// Momenta whose entries are drawn from a normal distribution.
std::vector<std::vector<double>> drawn(int count, int n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> list;
  for (int i = 0; i < count; ++i) {
    std::vector<double> p(n);
    for (double& x : p) x = normal(random);
    list.push_back(p);
  }
  return list;
}

// Where the extremal is at time t.
std::vector<double> end_of(const BoundaryValueProblem& problem,
                           const std::vector<double>& p0,
                           double t) {
  constexpr long kSteps = 512;
  std::vector<double> z = problem.from;
  z.insert(z.end(), p0.begin(), p0.end());
  EXPECT_TRUE(problem.dynamics.flow(StepPlan::equal(0, t, kSteps), z).completed());
  z.resize(problem.from.size());
  return z;
}

double speed_on_se2(const std::vector<double>& p) { return std::hypot(p[0], p[2]); }

TEST(CutTime, OnSE2IsThatOfTheClosedForm) {
  constexpr int kMomenta = 200;
  constexpr double kTolerance = 1e-10;  // 400 others were good to 4e-13
  const BoundaryValueProblem at = test::unicycle({0, 0, 0}, {0, 0, 0});
  for (const std::vector<double>& p : drawn(kMomenta, 3, 8)) {
    const double speed = speed_on_se2(p);
    const double expected = cut_time(std::hypot(p[0], p[1]) / speed) / speed;
    const CutTime cut = cut_of(at, p);
    ASSERT_TRUE(cut.cut_time) << cut.message;
    EXPECT_EQ(cut.status, CutStatus::kConverged);
    EXPECT_NEAR(*cut.cut_time, expected, kTolerance * expected);
    EXPECT_NE(cut.label, "none-found");
  }
}

TEST(CutTime, ThePartnerArrivesAtTheSamePlaceAndItsCutTimeIsTheSame) {
  constexpr double kTolerance = 1e-10;
  const BoundaryValueProblem at = test::unicycle({0, 0, 0}, {0, 0, 0});
  for (const std::vector<double>& p : drawn(6, 3, 3)) {
    const CutTime cut = cut_of(at, p);
    ASSERT_TRUE(cut.cut_time && cut.partner_p0);
    const std::vector<double> end = end_of(at, p, *cut.cut_time);
    const std::vector<double> other = end_of(at, *cut.partner_p0, *cut.cut_time);
    EXPECT_NEAR(other[0], end[0], kTolerance);
    EXPECT_NEAR(other[1], end[1], kTolerance);
    EXPECT_NEAR(std::remainder(other[2] - end[2], 2 * pi), 0, kTolerance);
    EXPECT_NEAR(speed_on_se2(*cut.partner_p0), speed_on_se2(p), kTolerance);
    const CutTime back = cut_of(at, *cut.partner_p0);
    ASSERT_TRUE(back.cut_time && back.partner_p0);
    EXPECT_NEAR(*back.cut_time, *cut.cut_time, kTolerance * *cut.cut_time);
    for (int j = 0; j < 3; ++j) EXPECT_NEAR((*back.partner_p0)[j], p[j], 1e-8);
    EXPECT_EQ(back.label, cut.label);
  }
}

TEST(CutTime, OfAFasterExtremalIsShorter) {
  constexpr double kTolerance = 1e-12;
  const BoundaryValueProblem at = test::martinet({0, 0, 0});
  const std::vector<double> p{0.6, 0.8, 1.3};
  const CutTime one = cut_of(at, p);
  for (const double factor : {0.25, 7.0, 300.0}) {
    const CutTime fast = cut_of(at, scaled(p, factor));
    ASSERT_TRUE(one.cut_time && fast.cut_time && fast.partner_p0);
    EXPECT_NEAR(*fast.cut_time * factor, *one.cut_time, kTolerance * *one.cut_time);
    EXPECT_NEAR(*fast.conjugate_time * factor, *one.conjugate_time, 1e-10);
    EXPECT_NEAR((*fast.partner_p0)[1], -factor * p[1], 1e-9 * factor);
  }
}

TEST(CutTime, InFlatMartinetIsTheFirstReturn) {
  constexpr double kTolerance = 1e-10;
  const BoundaryValueProblem at = test::martinet({0, 0, 0});
  for (const std::vector<double>& p : drawn(12, 3, 5)) {
    const double speed = std::hypot(p[0], p[1]);
    const double k = std::sqrt(0.5 * (1 - std::copysign(1, p[2]) * p[0] / speed));
    const double expected = 2 * std::comp_ellint_1(k) / std::sqrt(std::abs(p[2]) * speed);
    const CutTime cut = cut_of(at, p);
    ASSERT_TRUE(cut.cut_time) << cut.message;
    EXPECT_NEAR(*cut.cut_time, expected, kTolerance * expected);
    EXPECT_EQ(cut.label, "mirror");
  }
}

TEST(CutTime, OfTheAbnormalLineIsInfinite) {
  // With p_z = 1 its neighbours are conjugate at pi, but it is the extremal of p_z = 0, too.
  const CutTime cut = cut_of(test::martinet({0, 0, 0}), {1, 0, 1});
  EXPECT_EQ(cut.status, CutStatus::kConverged);
  EXPECT_FALSE(cut.cut_time);
  EXPECT_EQ(cut.label, "none-found");
}

TEST(CutTime, OnTheHeisenbergGroupIsTheConjugateTime) {
  constexpr double kTolerance = 1e-12;
  for (const double p_z : {0.05, 1.0, -20.0}) {
    const CutTime cut = cut_of(test::heisenberg_group({0, 0, 0}), {0.3, 0.4, p_z});
    ASSERT_TRUE(cut.cut_time) << cut.message;
    EXPECT_NEAR(*cut.cut_time * std::abs(p_z), 2 * pi, kTolerance * 2 * pi);
    EXPECT_EQ(cut.label, "conjugate");
    EXPECT_FALSE(cut.partner_p0);  // a family arrives
  }
}

TEST(CutTime, OfGrushinIsTheFirstReturnToTheAxis) {
  const CutTime cut = cut_of(test::grushin({0, 0}, {0, 0}), {-0.3, 0.7});
  ASSERT_TRUE(cut.cut_time && cut.partner_p0);
  EXPECT_NEAR(*cut.cut_time, pi / 0.7, 1e-12);
  EXPECT_EQ(cut.label, "mirror");
  // From beside the axis it is the same time (Agrachev, Barilari & Boscain, A Comprehensive
  // Introduction to Sub-Riemannian Geometry, 2019, section 13.5), and no symmetry of the start.
  const CutTime beside = cut_of(test::grushin({1, 0}, {0, 0}), {-0.8, 0.7});
  ASSERT_TRUE(beside.cut_time && beside.partner_p0);
  EXPECT_NEAR(*beside.cut_time, pi / 0.7, 1e-11);
  EXPECT_NEAR((*beside.partner_p0)[0], 0.8, 1e-9);
  EXPECT_EQ(beside.label, "none");
}

TEST(CutTime, OfUnitQuaternionsIsThatOfTheSphere) {
  // Rates (omega_x, omega_y) of two wheels turn by a as they go: at 2 pi / sqrt(|omega|^2 / 4 +
  // a^2) quaternions that start with the same a are where one of them is (Boscain & Rossi, SIAM J.
  // Control Optim. 47 (2008), SU(2)); |q'| is half the body rate.
  const CutTime cut = cut_of(test::satellite_quaternion({1, 0, 0, 0}), {0, 1, 0.5, 0.7});
  ASSERT_TRUE(cut.cut_time);
  const double rate = std::hypot(1, 0.5) / 2;
  EXPECT_NEAR(*cut.cut_time, 2 * pi / std::hypot(rate, 0.35), 1e-11);
  EXPECT_EQ(cut.label, "conjugate");
}

// Of rotations, where q and -q are one. With rates of speed 1 and a third component c of the
// momentum the real part of q at time t is
//
//   cos(a t / 2) cos(c t / 2) + c / a sin(a t / 2) sin(c t / 2),     a = sqrt(1 + c^2),
//
// and both are as far from 1 where it vanishes; if it does not before 2 pi / a, neighbours arrive
// there (Boscain & Rossi 2008, SO(3)).
double rotation_cut_time(double c) {
  const double a = std::hypot(1, c);
  const auto real_part = [&](double t) {
    return std::cos(a * t / 2) * std::cos(c * t / 2) +
           c / a * std::sin(a * t / 2) * std::sin(c * t / 2);
  };
  double low = 0;
  double high = 2 * pi / a;
  if (real_part(high) > 0) return high;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (real_part(middle) > 0 ? low : high) = middle;
  }
  return low;
}

TEST(CutTime, OfRotationsIsThatOfTheClosedForm) {
  CutTimeOptions options;
  options.signs = {-1, -1, -1, -1};
  const BoundaryValueProblem at = test::satellite_quaternion({1, 0, 0, 0});
  for (const double c : {-1.2, -0.3, 0.0, 0.4, 0.9, 2.5}) {
    SCOPED_TRACE(c);
    // q' is half the rate, so p is twice its momentum.
    const CutTime cut = cut_of(at, {0, 2 * std::cos(c), 2 * std::sin(c), 2 * c}, options);
    ASSERT_TRUE(cut.cut_time) << cut.message;
    EXPECT_NEAR(*cut.cut_time, rotation_cut_time(c), 1e-10);
  }
}

TEST(CutTime, RefusesSignsThatAreNoSymmetry) {
  CutTimeOptions options;
  for (const std::vector<double>& signs :
       {std::vector<double>{-1, -1}, {-1, -1, -1, 0.5}, {1, 1, 1, -1}}) {
    options.signs = signs;
    const BoundaryValueProblem at = test::satellite_quaternion({1, 0, 0, 0});
    EXPECT_THROW((void)cut_of(at, {0, 1, 0.5, 0.7}, options), std::invalid_argument);
  }
}

TEST(CutTime, OnTheEngelGroupIsWhereSearchesTellIt) {
  constexpr double kBeside = 0.01;
  const BoundaryValueProblem at = test::engel({0, 0, 0, 0});
  GeodesicOptions search;
  search.samples = 0;
  search.seed = 77;  // another one than that of the cut time
  int told = 0;
  for (const std::vector<double>& p : drawn(20, 4, 2)) {
    const CutTime cut = cut_of(at, p);
    ASSERT_TRUE(cut.cut_time) << cut.message;
    const double energy = 0.5 * (p[0] * p[0] + p[1] * p[1]);
    BoundaryValueProblem problem = at;
    for (const double part : {1 - kBeside, 1 + kBeside}) {
      problem.time = part * *cut.cut_time;
      problem.to = end_of(at, p, problem.time);
      const GeodesicReport report = find_geodesics(problem, search);
      if (report.geodesics.empty()) continue;  // to one target far away nothing is found so
      ++told;
      const double ahead = report.geodesics[0].action / (energy * problem.time) - 1;
      if (part < 1) {
        EXPECT_NEAR(ahead, 0, 1e-9);
      } else {
        EXPECT_LT(ahead, -1e-9);
      }
    }
  }
  EXPECT_GE(told, 38);
}

TEST(CutTime, OnTheCoverIsLater) {
  CutTimeOptions cover;
  cover.mod_angles = false;
  cover.max_time = 20;
  const BoundaryValueProblem at = test::unicycle({0, 0, 0}, {0, 0, 0});
  const CutTime turning = cut_of(at, {0.4, 0.3, std::sqrt(1 - 0.16)}, cover);
  EXPECT_EQ(turning.status, CutStatus::kConverged);
  EXPECT_FALSE(turning.cut_time);
  EXPECT_EQ(turning.max_time, 20);
  // Where the pendulum oscillates no angle goes round, and both are the same.
  const std::vector<double> p{0.6, std::sqrt(1.69 - 0.36), 0.8};
  const CutTime swinging = cut_of(at, p, cover);
  ASSERT_TRUE(swinging.cut_time);
  EXPECT_NEAR(*swinging.cut_time, *cut_of(at, p).cut_time, 1e-11);
}

TEST(CutTime, SaysThatItWasStopped) {
  const BoundaryValueProblem at = test::unicycle({0, 0, 0}, {0, 0, 0});
  CutTimeOptions options;
  options.progress = [](double /*fraction*/) { return false; };
  const CutTime stopped = cut_of(at, {0.4, 0.3, 0.9}, options);
  EXPECT_EQ(stopped.status, CutStatus::kInterrupted);
  EXPECT_FALSE(stopped.cut_time);
  options.progress = [](double /*fraction*/) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW((void)cut_of(at, {0.4, 0.3, 0.9}, options), std::runtime_error);
  options = {};
  options.time_limit = 1e-9;
  const CutTime late = cut_of(at, {0.4, 0.3, 0.9}, options);
  EXPECT_EQ(late.status, CutStatus::kNotConverged);
  EXPECT_FALSE(late.cut_time);
  EXPECT_NE(late.message, "");
}

TEST(CutTime, RefusesWhatHasNone) {
  const BoundaryValueProblem at = test::unicycle({0, 0, 0}, {0, 0, 0});
  EXPECT_THROW((void)cut_of(at, {1, 0}), std::invalid_argument);
  EXPECT_THROW((void)cut_of(at, {1, 0, std::nan("")}), std::invalid_argument);
  EXPECT_THROW((void)cut_of(at, {0, 1, 0}), std::invalid_argument);  // sideways
  CutTimeOptions options;
  options.max_time = -1;
  EXPECT_THROW((void)cut_of(at, {1, 0, 0}, options), std::invalid_argument);
  options = {};
  options.time_limit = 0;
  EXPECT_THROW((void)cut_of(at, {1, 0, 0}, options), std::invalid_argument);
  EXPECT_THROW((void)cut_of(test::pendulum(0, 1, 1), {1}), std::invalid_argument);  // a potential
}

}  // namespace
}  // namespace carnot::cut_time_test
