// Section 5 with V = 0: the circle theta = a t, phi = theta + pi/2, (x, y) = l (cos, sin)(theta).
//
// The momenta are (0, 0, a (l^2 + alpha), beta a), constant, hence lambda = (0, -c), c = a l: with
// the paper's lambda = (1, -c) p_x and p_y would be -cos(theta), -sin(theta).
#include "paper/paper_circle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "carnot/plots/figure.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr double kSpeed = 1;  // c = a l

// For people: without the round-off that stands for 0.
std::string rounded_text(std::vector<double> values) {
  for (double& x : values) x = std::abs(x) <= 4 * kEps ? 0 : x;
  return text_vector(values, 3);
}

// p that belongs to the motion on the circle and to multipliers.
std::vector<double> momenta(const Dynamics& dynamics, const std::vector<double>& lambda) {
  const std::vector<double> z = circle_start();
  std::vector<double> velocity{0, kSpeed, 1, 1};
  std::vector<double> p(4);
  dynamics.momentum(0, std::span(z).first(4), velocity, lambda, p);
  return p;
}

void add_circle_momenta(const Dynamics& dynamics, PaperPart& part) {
  const std::vector<double> right{0, 0, 2, 1};
  const std::vector<double> p = momenta(dynamics, {0, -kSpeed});
  part.rows.push_back({"momenta, a = L = 1",
                       "(0, 0, a(1 + L^2), a)",
                       rounded_text(p),
                       holds(max_distance(p, right) <= 4 * kEps)});
  const std::vector<double> z = circle_start();
  std::vector<double> velocity(4);
  std::vector<double> lambda(2);
  dynamics.evaluate(0, std::span(z).first(4), std::span(z).last(4), velocity, lambda);
  const double off = max_distance(lambda, {0, -kSpeed});
  part.rows.push_back({"lambda on the circle",
                       "(1, -c) = (1, -1)",
                       rounded_text(lambda),
                       off <= 4 * kEps ? PaperVerdict::kMisprint : PaperVerdict::kFails,
                       fmt::format("with lambda = (1, -1) the momenta would be {}, not constant",
                                   rounded_text(momenta(dynamics, {1, -kSpeed}))),
                       off,
                       0});
  const std::vector<double> exact{0, kSpeed, 1, 1};
  part.rows.push_back({"front wheel's speed",
                       "c = a L",
                       fmt::format("{:.3g}", std::hypot(velocity[0], velocity[1])),
                       holds(max_distance(velocity, exact) <= 4 * kEps),
                       "",
                       std::hypot(velocity[0], velocity[1]),
                       kSpeed});
}

// Along one turn with step h.
struct Turn {
  double path = 0;     // largest distance of (x, y) from the circle's
  double angles = 0;   // largest error of theta and phi
  double momenta = 0;  // largest change of p
  double lambda = 0;   // largest distance from (0, -c)
};

Turn one_turn(PaperWork& work, const Dynamics& dynamics, double h) {
  std::vector<double> z = circle_start();
  const std::vector<double> p0(z.begin() + 4, z.end());
  const StepPlan plan = StepPlan::of_length(0, 2 * kPi, h);
  const Trajectory nodes = work.flow(dynamics, plan, z, plan.count + 1).trajectory;
  Turn turn;
  for (std::size_t i = 0; i < nodes.t.size(); ++i) {
    const double t = nodes.t[i];
    const auto& q = nodes.q[i];
    turn.path = std::max(turn.path, std::hypot(q[0] - std::cos(t), q[1] - std::sin(t)));
    turn.angles = std::max({turn.angles, std::abs(q[2] - t), std::abs(q[3] - t - kPi / 2)});
    turn.momenta = std::max(turn.momenta, max_distance(nodes.p[i], p0));
    turn.lambda = std::max(turn.lambda, max_distance(nodes.lambda[i], {0, -kSpeed}));
  }
  return turn;
}

void add_turn(PaperWork& work, const Dynamics& dynamics, PaperPart& part) {
  constexpr int kSteps = 314;  // a whole number, so that every sample is a node
  constexpr double kStep = 2 * kPi / kSteps;
  // Round-off grows by exp(2 pi mu) = 2198 in one turn.
  const double round_off = 4 * kEps * std::exp(2 * kPi * CircleMotion{}.growth_rate());
  const Turn coarse = one_turn(work, dynamics, kStep);
  const Turn fine = one_turn(work, dynamics, kStep / 2);
  const double order = std::log2(coarse.path / fine.path);
  part.rows.push_back({"theta - t, phi - t - pi/2 in one turn",
                       "circle confirmed",
                       fmt::format("{:.1e}", coarse.angles),
                       holds(coarse.angles <= round_off),
                       "h = 0.02; the midpoint rule has this exactly, but for round-off",
                       coarse.angles,
                       0});
  part.rows.push_back({"p - p(0), lambda - (0, -1)",
                       "-",
                       fmt::format("{:.1e}, {:.1e}", coarse.momenta, coarse.lambda),
                       holds(std::max(coarse.momenta, coarse.lambda) <= round_off),
                       "",
                       std::max(coarse.momenta, coarse.lambda),
                       0});
  part.rows.push_back({"(x, y) off the circle",
                       "circle confirmed",
                       fmt::format("{:.1e}, falls like h^{:.2f}", coarse.path, order),
                       holds(std::abs(order - 2) < 0.02),
                       "the nodes are on a circle of radius (a h/2)/sin(a h/2), which is h^2/24 "
                       "larger",
                       order,
                       2});
}

void add_departure(PaperWork& work, PaperPart& part) {
  constexpr double kTime = 60;
  const Trajectory nodes = circle_run(work, 0, kTime);
  double time = std::nan("");
  for (std::size_t i = 0; i < nodes.t.size() && std::isnan(time); ++i) {
    if (circle_distance(nodes, i) > 0.1) time = nodes.t[i];
  }
  const double mu = CircleMotion{}.growth_rate();
  part.rows.push_back(
      {"for larger times it leaves the circle",
       "appears unstable",
       fmt::format("by 0.1 at t = {:.1f}, from round-off", time),
       holds(std::isfinite(time)),
       fmt::format("log(0.1/eps)/mu = {:.1f}, give or take the luck of the rounding",
                   std::log(0.1 / kEps) / mu),
       time});
}

void add_figure(PaperWork& work, const Dynamics& dynamics, PaperPart& part) {
  constexpr double kTime = 2 * kPi;
  std::vector<double> z = circle_start();
  const auto run = std::make_shared<const FlowSummary>(
      work.flow(dynamics, StepPlan::equal(0, kTime, 314), z, 315));
  part.figures.push_back(
      {"circle",
       "one turn on the circle: path, q, p, lambda and energy error",
       [run, info = dynamics.info](const std::string& file) {
         const plots::Curve curve{
             "circle, midpoint rule", &run->trajectory, run->action, run->length, {}};
         return plots::write_figure(file, info, {curve}, plots::Figure::kOverview);
       }});
}

}  // namespace

std::vector<double> circle_start(double perturbation) {
  return {1, 0, 0, kPi / 2 + perturbation, 0, 0, 2, 1};
}

double circle_excess(const Trajectory& trajectory, std::size_t row) {
  return trajectory.q[row][3] - trajectory.q[row][2] - kPi / 2;
}

double circle_distance(const Trajectory& trajectory, std::size_t row) {
  return std::hypot(std::sin(circle_excess(trajectory, row)), trajectory.p[row][3] - 1);
}

Trajectory circle_run(PaperWork& work, double perturbation, double time) {
  const Dynamics dynamics = paper_dynamics("vehicle", "midpoint");
  std::vector<double> z = circle_start(perturbation);
  const StepPlan plan = StepPlan::of_length(0, time, kCircleStep);
  return work.flow(dynamics, plan, z, plan.count + 1).trajectory;
}

PaperPart paper_circle(PaperWork& work) {
  const Dynamics dynamics = paper_dynamics("vehicle", "midpoint");
  PaperPart part;
  part.title = "Section 5: V = 0, circle, midpoint rule";
  add_circle_momenta(dynamics, part);
  add_turn(work, dynamics, part);
  add_departure(work, part);
  add_figure(work, dynamics, part);
  return part;
}

}  // namespace carnot::apps
