// Large steps and stiffness.
//
// The midpoint rule on q'' = -w^2 q: iteration on the stage is multiplied by h w / 2 each time, so
// it cannot settle for h w > 2, and Newton's method takes over. The rule itself keeps H for any
// step. Runge and Kutta's method of order 4 multiplies by R(i h w), which is above 1 from sqrt(8)
// on.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "benchmark/stress_case.h"
#include "carnot/load_scene.h"
#include "carnot/shooting/find_geodesics.h"
#include "catalogue/limit_choice.h"
#include "catalogue/scene_choice.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kStiffGroup = "large steps and stiffness";
constexpr long kSwings = 1000;

// w = 1.
FlowReport oscillate(double step, std::vector<double>& z) {
  static const Dynamics kOscillator = make_dynamics(
      scene_from_text("coordinates q\nkinetic = q'^2 / 2\npotential = q^2 / 2\n"), "midpoint");
  return kOscillator.flow(StepPlan::equal(0, step * kSwings, kSwings), z);
}

double runge_kutta_factor(double hw) {
  const std::complex<double> x(0, hw);
  return std::abs(1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0))));
}

// The largest step without Newton's method, by bisection.
StressCase contraction_case() {
  double low = 0.01;
  double high = 10;
  for (int i = 0; i < 30; ++i) {
    const double middle = std::sqrt(low * high);
    std::vector<double> z{1, 0};
    (oscillate(middle, z).newton_steps == 0 ? low : high) = middle;
  }
  return {kStiffGroup,
          "midpoint rule, iteration up to h w = " + text_number(low, 4),
          "Newton's method where it cannot settle, from 2 on",
          std::max(0.0, low - 2),
          0,
          "iterating on, factor of its error at h w = 10",
          5};
}

StressCase oscillator_case(double hw) {
  std::vector<double> z{1, 0};
  StressCase one{
      kStiffGroup,
      "midpoint rule, h w = " + text_number(hw, 2) + ", " + std::to_string(kSwings) + " steps",
      "H is kept, relative",
      std::nan(""),
      16 * kUnitRoundOff * std::sqrt(static_cast<double>(kSwings)) * std::max(1.0, hw),
      "Runge-Kutta 4, factor of a step",
      runge_kutta_factor(hw)};
  if (oscillate(hw, z).completed()) one.figure = std::abs(z[0] * z[0] + z[1] * z[1] - 1);
  return one;
}

// Straight ahead and nearly so, there and back.
double missed_on_return(const ParameterValues& masses, double time, const char* method) {
  constexpr long kCount = 20;
  const Dynamics vehicle = find_scene("vehicle").make(masses, method);
  const std::vector<double> start{0, 0, 1e-3, 2e-3, 1, 0, 0, 0};
  std::vector<double> z = start;
  if (!vehicle.flow(StepPlan::equal(0, time, kCount), z).completed() ||
      !vehicle.flow(StepPlan::equal(time, -time, kCount), z).completed()) {
    return std::numeric_limits<double>::infinity();
  }
  double missed = 0;
  for (int j = 0; j < 4; ++j) missed = std::max(missed, std::abs(z[j] - start[j]));
  return std::isfinite(missed) ? missed : std::numeric_limits<double>::infinity();
}

// Light masses part at once: the time is that of five powers of e, there and back.
StressCase mass_case(double alpha, double beta) {
  constexpr double kPowers = 5;
  const ParameterValues masses{{"alpha", alpha}, {"beta", beta}};
  const double time = std::min(1.0, kPowers / rates_of_line(alpha, beta, 1).first);
  return {kStiffGroup,
          "vehicle, alpha " + text_number(alpha, 1) + ", beta " + text_number(beta, 1),
          "20 steps there and back lead to the start",
          missed_on_return(masses, time, "gauss16"),
          64 * kUnitRoundOff,  // measured: 7; what grows there shrinks back again
          "the same by DOP853",
          missed_on_return(masses, time, "dop853")};
}

StressCase wall_case() {
  // From the direct method of `carnot benchmark --limits --peers`, and from shooting arc by arc.
  constexpr double kKnown = 23.275244006;
  constexpr double kKnownTo = 1e-9;
  constexpr double kBound = 0.3;
  const SceneEntry& entry = find_scene("vehicle");
  BoundaryValueProblem problem(entry.make({}, "gauss16"), {0, 0, 0, 0}, {0, 1, 0, 0});
  const GeodesicReport free = find_geodesics(problem);
  AskedLimits asked;
  asked.limits = {"phi-theta in -0.3:0.3"};
  problem.limits = choose_limits(entry, {}, asked);
  const GeodesicReport report = find_geodesics(problem);
  StressCase one{kStiffGroup,
                 "vehicle sideways, wheel within 0.3",
                 "action 23.275244006, relative",
                 std::nan(""),
                 kKnownTo,
                 "without the limit, radians beyond it",
                 0};
  if (!report.geodesics.empty()) {
    one.figure = std::abs(report.geodesics.front().action / kKnown - 1);
  }
  for (const Geodesic& geodesic : free.geodesics) {
    for (const auto& q : geodesic.trajectory.q) {
      one.naive_figure = std::max(one.naive_figure, std::abs(q[3] - q[2]) - kBound);
    }
  }
  return one;
}

}  // namespace

std::vector<StressCase> stiff_cases(const SuiteOptions& options, const Progress& progress) {
  std::vector<StressCase> cases{contraction_case()};
  for (double hw = 0.1; hw < 2e6; hw *= options.brief ? 1e3 : 10) {
    cases.push_back(oscillator_case(hw));
  }
  for (double alpha = 1e-6; alpha < 2e6; alpha *= options.brief ? 1e6 : 1e3) {
    for (double beta = 1e-6; beta < 2e6; beta *= options.brief ? 1e6 : 1e3) {
      cases.push_back(mass_case(alpha, beta));
    }
  }
  if (progress && !progress(0.5)) return {};
  cases.push_back(wall_case());
  return cases;
}

}  // namespace carnot::apps
