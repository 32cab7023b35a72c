// Boundary-value problems at the ends of scales, where geodesics cease to be unique, and where a
// momentum does not tell the path.
//
// Each has a law in closed form: a circle of area z in Heisenberg's group has the length 2 sqrt(pi
// z), whatever its direction; a unicycle that turns on the spot by a has the length a, and sideways
// by e it is 2 sqrt(pi e) to first order; T times the action does not depend on T. Beside it stands
// Newton's method on the end of one flow, from the momentum of the straight line.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "benchmark/stress_case.h"
#include "carnot/numerics/parallel.h"
#include "carnot/shooting/find_geodesics.h"
#include "catalogue/scene_choice.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kBoundaryGroup = "boundary-value extremes";
constexpr double kPi = std::numbers::pi;
constexpr double kExact = 1e-9;

struct ExtremeProblem {
  std::string name;
  std::string law;
  const char* scene;
  std::vector<double> from;
  std::vector<double> to;
  double time = 1;
  double length = 0;                        // the law; 0: that of `reference`
  double bound = kExact;                    // relative
  std::vector<double> reference = {};       // the target of another problem, in time 1,
  std::vector<double> reference_from = {};  // and where it starts; empty: at the origin
  bool brief = true;
  ParameterValues parameters = {};
};

BoundaryValueProblem problem_of(const ExtremeProblem& p) {
  return {find_scene(p.scene).make(p.parameters, "gauss16"), p.from, p.to, p.time};
}

double length_of(const BoundaryValueProblem& problem) {
  GeodesicOptions options;
  options.threads = 1;
  options.samples = 0;
  const GeodesicReport report = find_geodesics(problem, options);
  if (report.geodesics.empty()) return std::nan("");
  return report.geodesics.front().length.value_or(std::nan(""));
}

// What Newton's method on one flow leaves of the way to the target, at its best.
double naive_miss(const BoundaryValueProblem& problem) {
  constexpr int kIterations = 30;
  constexpr long kSteps = 64;
  const int n = problem.dynamics.dof;
  double away = 0;
  Eigen::VectorXd p(n);
  for (int j = 0; j < n; ++j) {
    p[j] = (problem.to[j] - problem.from[j]) / problem.time;
    away = std::max(away, std::abs(problem.to[j] - problem.from[j]));
  }
  double best = 1;
  std::vector<double> m(4 * n * n);
  for (int i = 0; i < kIterations && p.allFinite(); ++i) {
    std::vector<double> z = problem.from;
    z.insert(z.end(), p.data(), p.data() + n);
    const StepPlan plan = StepPlan::equal(0, problem.time, kSteps);
    if (!problem.dynamics.tangent_flow(plan, z, m).completed()) break;
    Eigen::MatrixXd slope(n, n);
    Eigen::VectorXd residual(n);
    for (int r = 0; r < n; ++r) {
      residual[r] = z[r] - problem.to[r];
      for (int c = 0; c < n; ++c) slope(r, c) = m[r * 2 * n + n + c];
    }
    best = std::min(best, residual.cwiseAbs().maxCoeff() / away);
    p -= slope.fullPivLu().solve(residual);
  }
  return best;
}

std::vector<ExtremeProblem> extreme_problems() {
  constexpr double kOffset = 4.5e9;  // displacements below are exact there
  std::vector<ExtremeProblem> all;
  for (const double z : {1e-12, 1e-6, 1.0, 1e6}) {
    all.push_back({"Heisenberg's group, the cut locus at z = " + text_number(z, 1),
                   "length 2 sqrt(pi z)",
                   "heisenberg-group",
                   {0, 0, 0},
                   {0, 0, z},
                   1,
                   2 * std::sqrt(kPi * z)});
  }
  for (const double e : {1e-12, 1e-9, 1e-6}) {
    all.push_back({"unicycle, sideways by " + text_number(e, 1),
                   "length 2 sqrt(pi e) to first order",
                   "unicycle",
                   {0, 0, 0},
                   {0, e, 0},
                   1,
                   2 * std::sqrt(kPi * e),
                   std::max(kExact, e),
                   {},
                   {},
                   e != 1e-9});
  }
  all.push_back({"vehicle, straight on by 1e6",
                 "length 1e6",
                 "vehicle",
                 {0, 0, 0, 0},
                 {1e6, 0, 0, 0},
                 1,
                 1e6});
  for (const double turn : {kPi, kPi - 1e-9, 2000 * kPi}) {
    all.push_back({"unicycle, a turn by " + text_number(turn, 10),
                   "length is the angle",
                   "unicycle",
                   {0, 0, 0},
                   {0, 0, turn},
                   1,
                   turn});
  }
  all.push_back(
      {"Martinet, the abnormal line", "length 1", "martinet", {0, 0, 0}, {1, 0, 0}, 1, 1});
  all.push_back({"unicycle, 4.5e9 from the origin",
                 "length is that at the origin",
                 "unicycle",
                 {kOffset, -kOffset, 0},
                 {kOffset + 1, -kOffset + 0.5, 1},
                 1,
                 0,
                 kExact,
                 {1, 0.5, 1}});
  for (const double time : {1e-6, 1e6}) {
    all.push_back({"vehicle, sideways in T = " + text_number(time, 1),
                   "length is that of T = 1",
                   "vehicle",
                   {0, 0, 0, 0},
                   {0, 1, 0, 0},
                   time,
                   0,
                   kExact,
                   {0, 1, 0, 0}});
  }
  for (const double turn : {kPi, kPi - 1e-9}) {
    all.push_back({"vehicle, a reversal by " + text_number(turn, 10),
                   "length is that of its mirror image",
                   "vehicle",
                   {0, 0, 0, 0},
                   {1, 0, turn, turn},
                   1,
                   0,
                   kExact,
                   {1, 0, -turn, -turn},
                   {},
                   turn == kPi});
  }
  // Lighter or heavier ones are not found: see docs/limits.md.
  for (const auto& [alpha, beta] : {std::pair{1e-3, 1.0}, {1e-3, 1e3}, {1.0, 1e3}, {1e3, 1e3}}) {
    all.push_back({"vehicle, alpha " + text_number(alpha, 1) + ", beta " + text_number(beta, 1),
                   "length is that of the way back",
                   "vehicle",
                   {0, 0, 0, 0},
                   {2, 1, 0.5, 0.5},
                   1,
                   0,
                   kExact,
                   {0, 0, 0, 0},
                   {2, 1, 0.5, 0.5},
                   beta == 1,
                   {{"alpha", alpha}, {"beta", beta}}});
  }
  return all;
}

StressCase case_of(const ExtremeProblem& p) {
  const BoundaryValueProblem problem = problem_of(p);
  double law = p.length;
  if (law == 0) {
    ExtremeProblem reference = p;
    reference.from = p.reference_from;
    reference.from.resize(p.from.size(), 0.0);
    reference.to = p.reference;
    reference.time = 1;
    law = length_of(problem_of(reference));
  }
  return {kBoundaryGroup,
          p.name,
          p.law + ", relative",
          std::abs(length_of(problem) / law - 1),
          p.bound,
          "Newton on one flow: of the way left",
          naive_miss(problem)};
}

}  // namespace

std::vector<StressCase> boundary_cases(const SuiteOptions& options, const Progress& progress) {
  std::vector<ExtremeProblem> all = extreme_problems();
  if (options.brief) std::erase_if(all, [](const ExtremeProblem& p) { return !p.brief; });
  std::vector<StressCase> cases(all.size());
  const auto count = static_cast<int>(all.size());
  parallel_for(count, thread_count(options.threads), [&](int i) { cases[i] = case_of(all[i]); });
  if (progress && !progress(1)) return {};
  return cases;
}

}  // namespace carnot::apps
