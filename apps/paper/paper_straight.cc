// Section 5 with V = 0: the straight line x = c t, exact in double, and its instability.
//
// Deviations with p_y = 0 from the line, theta, phi, p_theta, p_phi, grow like exp(s t) with
// beta l^2 s^4 - (l^2 + alpha + beta) c^2 s^2 + c^4 = 0; for alpha = beta = l = c = 1 that is
// s^4 - 3 s^2 + 1 = 0, s = golden ratio or its inverse, of either sign. The eigenvector is
//
//   phi = 1, theta = 1/(s + 1), y = 1/s, p_phi = s, p_theta = -s/(s^2 - 1), the others 0.
//
// A perturbation has parts in all of them. The symplectic form separates them: w(v_-s, .) is zero
// on every eigenvector but v_s, so w(v_-s, dz)/w(v_-s, v_s) is the part that grows fastest, and it
// grows exponentially from the start.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "carnot/plots/series_plot.h"
#include "paper/paper_parts.h"

namespace carnot::apps {
namespace {

using plots::Series;
using plots::SeriesPage;
using plots::SeriesPanel;
using Phase = std::array<double, 8>;  // x, y, theta, phi and their momenta

constexpr double kRate = std::numbers::phi;
constexpr double kFineStep = 0.02;

Phase eigenvector(double s) { return {0, 1 / s, 1 / (s + 1), 1, 0, 0, -s / (s * s - 1), s}; }

// The symplectic form dq ^ dp.
double form(const Phase& a, const Phase& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += a[i] * b[i + 4] - a[i + 4] * b[i];
  return sum;
}

// How much of exp(kRate t) is in the deviation of z from the line. x does not enter.
double unstable_part(const std::vector<double>& z) {
  const Phase left = eigenvector(-kRate);
  Phase deviation{};
  for (std::size_t i = 1; i < z.size(); ++i) deviation[i] = z[i];
  deviation[4] -= 1;
  return form(left, deviation) / form(left, eigenvector(kRate));
}

// On the line at x = y = 0, its direction turned by `angle`. What leaves it grows at the rates
// above times the speed.
std::vector<double> on_the_line(double angle, double speed = 1) {
  return {0, 0, angle, angle, speed * std::cos(angle), speed * std::sin(angle), 0, 0};
}

void add_line_momenta(const Dynamics& dynamics, PaperPart& part) {
  const std::vector<double> q(4, 0.0);
  std::vector<double> velocity{1, 0, 0, 0};
  const std::vector<double> lambda{0, 0};
  std::vector<double> p(4);
  const double violated = dynamics.momentum(0, q, velocity, lambda, p);
  const bool right = violated == 0 && p == std::vector<double>{1, 0, 0, 0};
  part.rows.push_back({"momenta of x' = 1 at q = 0",
                       "all zero except p_x = 1",
                       fmt::format("({:g}, {:g}, {:g}, {:g})", p[0], p[1], p[2], p[3]),
                       holds(right)});
}

void add_exactness(PaperWork& work, const Dynamics& dynamics, PaperPart& part) {
  constexpr double kStep = 0.1;
  constexpr long kSteps = 100000;
  std::vector<double> z = on_the_line(0);
  const StepPlan plan = StepPlan::equal(0, kSteps * kStep, kSteps);
  const Trajectory nodes = work.flow(dynamics, plan, z, kSteps + 1).trajectory;
  double off = 0;
  double late = 0;
  for (std::size_t i = 1; i < nodes.t.size(); ++i) {
    const auto& q = nodes.q[i];
    off = std::max({off, std::abs(q[1]), std::abs(q[2]), std::abs(q[3])});
    late = std::max(late, std::abs(q[0] / nodes.t[i] - 1));
  }
  part.rows.push_back(
      {"theta, phi and y on the line, 1e5 steps",
       "exact solution",
       off == 0 ? "exactly 0 at every node" : fmt::format("{:.1e}", off),
       holds(off == 0),
       "zeros stay zeros in double, so along the x axis round-off does not make the "
       "vehicle wander",
       off,
       0});
  part.rows.push_back({"x/t - 1, largest",
                       "exact solution",
                       fmt::format("{:.1e}", late),
                       holds(late <= 4 * kEps),
                       "",
                       late,
                       0});
}

// When the vehicle has left a line of direction `angle` by 0.1 rad.
double wandering_time(PaperWork& work, const Dynamics& dynamics, double angle, double speed) {
  constexpr double kFar = 0.1;
  constexpr double kTime = 40;
  std::vector<double> z = on_the_line(angle, speed);
  const StepPlan plan = StepPlan::of_length(0, kTime, kFineStep);
  const Trajectory nodes = work.flow(dynamics, plan, z, plan.count + 1).trajectory;
  for (std::size_t i = 0; i < nodes.t.size(); ++i) {
    if (std::abs(nodes.q[i][3] - angle) > kFar) return nodes.t[i];
  }
  return std::nan("");
}

void add_wandering(PaperWork& work, const Dynamics& dynamics, PaperPart& part) {
  // In some directions, which depend on the instruction set, nothing is rounded. Where products and
  // sums are not fused, that is so in all directions at speed 1: cos(a) sin(a) - sin(a) cos(a) is 0
  // in double. A momentum along the line that was rounded itself is not that regular. So this is
  // the first direction in which something is rounded, at speed 1 if there is one.
  constexpr std::array kDirections{0.3, 0.7, 1.1, 0.5, 0.9};
  double angle = 0;
  double speed = 0;
  double time = std::nan("");
  for (const double tried_speed : {1.0, 1.1}) {
    for (const double tried : kDirections) {
      if (std::isfinite(time)) break;
      angle = tried;
      speed = tried_speed;
      time = wandering_time(work, dynamics, angle, speed);
    }
  }
  // From a rounding error of an angle to 0.1 rad.
  const double rate = speed * kRate;
  const double expected = std::log(0.1 / (angle * kEps)) / rate;
  const std::string faster = speed == 1 ? "" : fmt::format(" at speed {}", speed);
  part.rows.push_back({fmt::format("the same line in direction {} rad{}", angle, faster),
                       "round-off makes it wander",
                       fmt::format("phi off by 0.1 at t = {:.1f}", time),
                       holds(std::isfinite(time)),
                       fmt::format("log(0.1/({} eps))/{:.3f} = {:.1f}, give or take the luck of "
                                   "the rounding",
                                   angle,
                                   rate,
                                   expected),
                       time,
                       expected});
}

// A run with phi perturbed.
struct Departure {
  double perturbation = 0;
  Trajectory nodes;
  std::vector<double> unstable;  // the part that grows fastest, at the nodes
  std::vector<double> phi;       // absolute values
};

Departure departure(PaperWork& work, const Dynamics& dynamics, double perturbation) {
  constexpr double kTime = 40;
  std::vector<double> z = on_the_line(0);
  z[3] = perturbation;
  const StepPlan plan = StepPlan::of_length(0, kTime, kFineStep);
  Departure run{perturbation, work.flow(dynamics, plan, z, plan.count + 1).trajectory, {}, {}};
  for (std::size_t i = 0; i < run.nodes.t.size(); ++i) {
    run.unstable.push_back(std::abs(unstable_part(phase_point(run.nodes, i))));
    run.phi.push_back(std::abs(run.nodes.q[i][3]));
  }
  return run;
}

void add_line_rates(const std::vector<Departure>& runs, PaperPart& part) {
  constexpr double kAccepted = 0.01;
  constexpr double kLinear = 0.02;  // beyond, cubic terms change the rate by more than 1e-3
  const auto add = [&](const std::string& what, const LineFit& fit, const std::string& note) {
    part.rows.push_back({what,
                         "unstable",
                         fmt::format("{:.5f}", fit.slope),
                         holds(std::abs(fit.slope / kRate - 1) < kAccepted),
                         note,
                         fit.slope,
                         kRate});
  };
  for (const Departure& run : runs) {
    const bool first = &run == &runs.front();
    add(fmt::format("growth rate, phi perturbed by {:.0e}", run.perturbation),
        fit_growth(run.nodes.t, run.unstable, 0, kLinear),
        first ? fmt::format("golden ratio s = 1.61803, for the midpoint rule s (1 + s^2 h^2/12) = "
                            "{:.5f}; fitted to the part of the deviation along the fastest growing "
                            "eigenvector, up to {}",
                            kRate * (1 + std::pow(kRate * kFineStep, 2) / 12),
                            kLinear)
              : "");
  }
  add("growth rate of |phi| itself, the last run",
      fit_growth(runs.back().nodes.t, runs.back().phi, 1e3 * runs.back().perturbation, kLinear),
      "fitted where |phi| is between 1000 times the perturbation and 0.02");
}

SeriesPage departure_page(const std::vector<Departure>& runs) {
  SeriesPanel growth;
  SeriesPanel path;
  for (const Departure& run : runs) {
    const std::string exponent = fmt::format("{:.0f}", std::log10(1 / run.perturbation));
    Series phi;
    Series way;
    phi.title = way.title = "\u03c6(0) = 10^{\u2212" + exponent + "}";
    bool linear = true;
    for (std::size_t i = 0; i < run.nodes.t.size(); ++i) {
      way.x.push_back(run.nodes.q[i][0]);
      way.y.push_back(run.nodes.q[i][1]);
      if (linear) {
        phi.x.push_back(run.nodes.t[i]);
        phi.y.push_back(run.phi[i]);
      }
      linear = linear && run.phi[i] < 1;  // then it swings
    }
    growth.series.push_back(phi);
    path.series.push_back(way);
  }
  growth.title = "growth of the perturbation";
  growth.x = {"t [time]", false, {}};
  growth.y = {"|\u03c6| [rad]", true, {}};
  growth.slopes = {{"exp(1.618 t)", kRate, 2, 1e-12, 17}};
  growth.legend = plots::Legend::kBottomRight;
  path.title = "path of the front wheel, t \u2264 40";
  path.x = {"x [length]", false, {}};
  path.y = {"y [length]", false, {}};
  path.legend = plots::Legend::kTopRight;
  path.equal_axes = true;
  SeriesPage page;
  page.title = "vehicle, V = 0: the straight line is unstable";
  page.panels = {growth, path};
  return page;
}

void add_growth(PaperWork& work, const Dynamics& dynamics, PaperPart& part) {
  std::vector<Departure> runs;
  for (const double perturbation : {1e-4, 1e-8, 1e-12}) {
    runs.push_back(departure(work, dynamics, perturbation));
  }
  add_line_rates(runs, part);
  const SeriesPage page = departure_page(runs);
  part.figures.push_back({"straight_line",
                          "growth of perturbations of phi on the straight line, and the paths",
                          [page](const auto& file) { return plots::write_series(file, page); }});
}

}  // namespace

PaperPart paper_straight(PaperWork& work) {
  const Dynamics dynamics = paper_dynamics("vehicle", "midpoint");
  PaperPart part;
  part.title = "Section 5: V = 0, straight line, midpoint rule";
  add_line_momenta(dynamics, part);
  add_exactness(work, dynamics, part);
  add_wandering(work, dynamics, part);
  add_growth(work, dynamics, part);
  return part;
}

}  // namespace carnot::apps
