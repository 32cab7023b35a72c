// Near the loss of index 1.
//
// Two rows of constraints that are parallel but for e leave the same velocities as two rows that
// are not: only their Gram determinant is of the order e^2. And where a row vanishes, momenta tell
// no velocity any more: a flow must say when it comes there.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "benchmark/stress_case.h"
#include "carnot/load_scene.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kIndexGroup = "near loss of index 1";
constexpr double kGramTime = 2;
constexpr long kGramSteps = 20;

Dynamics parallel_rows(double apart) {
  return make_dynamics(
      scene_from_text("coordinates x, y, z, w\nparameters e = 1 > 0\n"
                      "kinetic = (x'^2 + y'^2 + z'^2 + w'^2) / 2\n"
                      "0 = z' - y x' + 0.3 w' + e (w' - x y' + 0.4 z')\n"
                      "0 = 0.7 (z' - y x' + 0.3 w') - 1.3 e (w' - x y' + 0.4 z')\n")
          .with({{"e", apart}}));
}

std::vector<double> gram_start() { return {0.3, 0.2, 0, 0, 1, 0.5, 0.2, 0.15}; }

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (int j = 0; j < 4; ++j) largest = std::max(largest, std::abs(a[j] - b[j]));
  return largest;
}

// |a v| / |v| of the velocity v = p - G' (G G')^-1 G p at the start, for the first of the rows a, b
// that G combines.
double gram_violation(double e) {
  using Row = Eigen::RowVector4d;
  const std::vector<double> z = gram_start();
  const Row a(-z[1], 0, 1, 0.3);
  const Row b(0, -z[0], 0.4, 1);
  Eigen::Matrix<double, 2, 4> g;
  g << a + e * b, 0.7 * a - 1.3 * e * b;
  const Eigen::Vector4d p(z[4], z[5], z[6], z[7]);
  const Eigen::Matrix2d gram = g * g.transpose();
  const Eigen::Vector4d v = p - g.transpose() * (gram.inverse() * (g * p));
  return std::abs(a * v) / v.norm();
}

StressCase parallel_case(double e) {
  const StepPlan plan = StepPlan::equal(0, kGramTime, kGramSteps);
  std::vector<double> known = gram_start();
  std::vector<double> z = gram_start();
  StressCase one{kIndexGroup,
                 "rows " + text_number(e, 2) + " apart, Gram determinant " + text_number(e * e, 2),
                 "q(T) is that of rows 1 apart",
                 std::nan(""),
                 16 * kUnitRoundOff / e,  // the condition of the rows, over 20 steps; measured: 2
                 "velocity by the inverse of the Gram matrix, |g v| / |v|",
                 gram_violation(e)};
  if (parallel_rows(1).flow(plan, known).completed() &&
      parallel_rows(e).flow(plan, z).completed()) {
    one.figure = largest_difference(z, known);
  }
  return one;
}

// Along rays to (1, 0). There p_theta = r w is kept, so that the momentum w across the ray grows
// like 1/r until the rank drops.
constexpr const char* kRays =
    "coordinates x, y\nkinetic = (x'^2 + y'^2) / 2\n"
    "0 = (1 - x) y' + y x'\n";

using Ray = std::array<double, 4>;
// H = (p.u)^2 / 2 with the unit vector u to (1, 0).
Ray ray_rate(const Ray& z) {
  const double dx = 1 - z[0];
  const double dy = -z[1];
  const double r = std::hypot(dx, dy);
  const double along = (z[2] * dx + z[3] * dy) / r;
  return {along * dx / r,
          along * dy / r,
          along * (z[2] / r - along * dx / (r * r)),
          along * (z[3] / r - along * dy / (r * r))};
}

// Whether Runge and Kutta's steps end with finite numbers.
bool runge_kutta_goes_across(const StepPlan& plan, Ray z) {
  const auto moved = [&z](const Ray& rate, double h) {
    Ray to = z;
    for (int i = 0; i < 4; ++i) to[i] += h * rate[i];
    return to;
  };
  for (long i = 0; i < plan.count; ++i) {
    const double h = plan.length(i);
    const Ray a = ray_rate(z);
    const Ray b = ray_rate(moved(a, h / 2));
    const Ray c = ray_rate(moved(b, h / 2));
    const Ray d = ray_rate(moved(c, h));
    for (int j = 0; j < 4; ++j) z[j] += h / 6 * (a[j] + 2 * b[j] + 2 * c[j] + d[j]);
  }
  return std::all_of(z.begin(), z.end(), [](double x) { return std::isfinite(x); });
}

StressCase drop_case() {
  // The rank drops in the middle of a step, where a fixed step may leap across it: the stages of 64
  // steps to T = 2.1 happen to lie so that they do.
  const StepPlan plan = StepPlan::equal(0, 2, 63);
  const Ray start{0, 0, 1, 0.5};
  std::vector<double> z(start.begin(), start.end());
  const FlowReport report = make_dynamics(scene_from_text(kRays)).flow(plan, z);
  StressCase one{kIndexGroup,
                 "a rank that drops at t = 1, told at " + text_number(report.time_reached, 4),
                 "the flow ends within a step of it",
                 std::nan(""),
                 plan.step,
                 "Runge-Kutta 4 to T = 2.1 goes across, beyond it by",
                 0};
  if (!report.completed()) one.figure = std::abs(report.time_reached - 1);
  const StepPlan naive = StepPlan::equal(0, 2.1, 64);
  if (runge_kutta_goes_across(naive, start)) one.naive_figure = naive.end - 1;
  return one;
}

bool fixed_steps_go_across(double end, long count) {
  std::vector<double> z{0, 0, 1, 0.5};
  return make_dynamics(scene_from_text(kRays)).flow(StepPlan::equal(0, end, count), z).completed();
}

// Steps that are chosen for a tolerance do not leap across it.
StressCase tolerance_case() {
  constexpr double kTolerance = 1e-8;
  const double end = 2.1;
  std::vector<double> z{0, 0, 1, 0.5};
  const AutomaticFlow flow =
      make_dynamics(scene_from_text(kRays)).automatic_flow(0, end, kTolerance, z);
  return {kIndexGroup,
          "a rank that drops at t = 1, steps for a tolerance",
          "no answer beyond it",
          flow.reached ? end - 1 : 0,
          0,
          "64 fixed steps of gauss16, beyond it by",
          fixed_steps_go_across(end, 64) ? end - 1 : 0};
}

}  // namespace

std::vector<StressCase> index_cases(const SuiteOptions& options, const Progress& progress) {
  std::vector<StressCase> cases;
  for (double e = 1e-1; e > 0.5e-7; e *= options.brief ? 1e-3 : 1e-1) {
    cases.push_back(parallel_case(e));
  }
  if (progress && !progress(0.5)) return {};
  cases.push_back(drop_case());
  cases.push_back(tolerance_case());
  return cases;
}

}  // namespace carnot::apps
