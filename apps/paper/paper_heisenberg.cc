// Section 6: the Heisenberg problem, q = 0, p = (0.1, 0.3, 1).
//
// H_lambda = 0 gives lambda = -g.p/g.g, at the start -1. The paper prints 1, which would make the
// velocity p + lambda g = (0.1, 0.3, 2), off the constraint.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "carnot/plots/figure.h"
#include "paper/paper_parts.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

const std::vector<double> kStart{0, 0, 0, 0.1, 0.3, 1};

// (q, p) at T = 10 in 128 bits by two methods (tests/reference/initial_values.json).
const std::vector<double> kReference{-0.0230956158191804117457627339709,
                                     -0.0601059616755405910547438664881,
                                     0.53011854676771988216832114668592,
                                     0.11105841473972115122850849100930289,
                                     0.28902770432076125306238947578725,
                                     1};
constexpr double kReferenceTime = 10;

void add_start(const Dynamics& dynamics, PaperPart& part) {
  std::vector<double> velocity(3);
  std::vector<double> lambda(1);
  const std::span z(kStart);
  const PointValues at = dynamics.evaluate(0, z.first(3), z.last(3), velocity, lambda);
  const bool right = std::abs(lambda[0] + 1) <= 4 * kEps;
  part.rows.push_back({"lambda at q = 0, p = (0.1, 0.3, 1)",
                       "1",
                       fmt::format("{:g}", lambda[0]),
                       right ? PaperVerdict::kMisprint : PaperVerdict::kFails,
                       "lambda = -g.p/g.g = -1; with 1 the velocity would be (0.1, 0.3, 2) and "
                       "g.q' = 2",
                       lambda[0],
                       -1});
  part.rows.push_back({"velocity there",
                       "(0.1, 0.3, 0)",
                       text_vector(velocity, 3),
                       holds(max_distance(velocity, {0.1, 0.3, 0}) <= 4 * kEps)});
  part.rows.push_back({"energy there",
                       "-",
                       fmt::format("{:.4g}", at.hamiltonian),
                       holds(std::abs(at.hamiltonian - 0.05) <= 4 * kEps),
                       "",
                       at.hamiltonian,
                       0.05});
}

double error(PaperWork& work, const char* method, double step) {
  const Dynamics dynamics = paper_dynamics("heisenberg", method);
  std::vector<double> z = kStart;
  work.flow(dynamics, StepPlan::of_length(0, kReferenceTime, step), z);
  return max_distance(z, kReference);
}

void add_errors(PaperWork& work, PaperPart& part) {
  const double exact = error(work, "gauss16", 0.25);
  part.rows.push_back({"(q, p) at T = 10, Gauss 16, h = 0.25",
                       "-",
                       fmt::format("error {:.1e}", exact),
                       holds(exact <= 16 * kEps),
                       "against 30 digits computed in 128 bits",
                       exact,
                       0});
  const double coarse = error(work, "midpoint", 0.05);
  const double fine = error(work, "midpoint", 0.025);
  const double order = std::log2(coarse / fine);
  part.rows.push_back({"the same, midpoint rule, h = 0.05",
                       "any order",
                       fmt::format("error {:.1e}, falls like h^{:.2f}", coarse, order),
                       holds(std::abs(order - 2) < 0.02),
                       "",
                       order,
                       2});
}

// The trajectory of the figure.
void add_trajectory(PaperWork& work, const Dynamics& dynamics, PaperPart& part) {
  constexpr double kTime = 60;
  constexpr double kStep = 0.05;
  std::vector<double> z = kStart;
  const StepPlan plan = StepPlan::of_length(0, kTime, kStep);
  const auto run =
      std::make_shared<const FlowSummary>(work.flow(dynamics, plan, z, plan.count + 1));
  double moved = 0;  // p_z and the angular momentum x p_y - y p_x are constant
  for (std::size_t i = 0; i < run->trajectory.t.size(); ++i) {
    const auto& q = run->trajectory.q[i];
    const auto& p = run->trajectory.p[i];
    moved = std::max({moved, std::abs(p[2] - 1), std::abs(q[0] * p[1] - q[1] * p[0])});
  }
  part.rows.push_back({"p_z and x p_y - y p_x along T = 60",
                       "-",
                       fmt::format("change {:.1e}", moved),
                       holds(moved <= 64 * kEps),
                       "quadratic invariants, which the midpoint rule keeps",
                       moved,
                       0});
  part.rows.push_back({"constraint at stages and nodes",
                       "-",
                       fmt::format("{:.1e}", run->constraint_error),
                       holds(run->constraint_error <= 4 * kEps),
                       "",
                       run->constraint_error,
                       0});
  part.figures.push_back(
      {"heisenberg",
       "the trajectory of q = 0, p = (0.1, 0.3, 1) in space and over time",
       [run, info = dynamics.info](const std::string& file) {
         const plots::Curve curve{"q(0) = 0, p(0) = (0.1, 0.3, 1), midpoint rule",
                                  &run->trajectory,
                                  run->action,
                                  run->length,
                                  {}};
         return plots::write_figure(file, info, {curve}, plots::Figure::kOverview);
       }});
}

}  // namespace

PaperPart paper_heisenberg(PaperWork& work) {
  const Dynamics dynamics = paper_dynamics("heisenberg", "midpoint");
  PaperPart part;
  part.title = "Section 6: the Heisenberg problem";
  add_start(dynamics, part);
  add_errors(work, part);
  add_trajectory(work, dynamics, part);
  return part;
}

}  // namespace carnot::apps
