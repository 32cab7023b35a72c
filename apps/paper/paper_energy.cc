// The energy error of the vehicle on V = -cos r over a long run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "carnot/plots/series_plot.h"
#include "paper/paper_cosine.h"

namespace carnot::apps {
namespace {

using plots::Series;
using plots::SeriesPage;
using plots::SeriesPanel;

// The paper's method, another symplectic one and, for contrast, two that are not.
const std::vector<std::string> kEnergyMethods{"midpoint", "gauss4", "radau5", "dop853"};

// Energy error of one method over the long run.
struct EnergyRun {
  std::string method;
  bool symplectic = true;
  double largest = 0;  // over all nodes
  double growth = 0;   // largest of the second half / of the first half, at the samples
  double correlation = 0;
  double constraint_error = 0;
  double size = 0;           // largest |q|
  double lambda_first = 0;   // largest |lambda| of the first half
  double lambda_second = 0;  // of the second half
  std::vector<double> t;
  std::vector<double> error;
};

EnergyRun energy_run(PaperWork& work, const std::string& method) {
  constexpr long kSteps = 100000;
  constexpr long kEvery = 10;
  const Dynamics dynamics = paper_dynamics(kCosineScene, method);
  std::vector<double> z = cosine_start(dynamics);
  const StepPlan plan = StepPlan::equal(0, kSteps * kCosineStep, kSteps);
  const FlowSummary summary = work.flow(dynamics, plan, z, kSteps / kEvery + 1);
  const Trajectory& trajectory = summary.trajectory;
  EnergyRun run;
  run.method = method;
  run.symplectic = dynamics.symplectic;
  run.largest = summary.energy_drift;
  run.constraint_error = summary.constraint_error;
  run.t = trajectory.t;
  double first = 0;
  double second = 0;
  for (std::size_t i = 0; i < run.t.size(); ++i) {
    const bool late = 2 * i >= run.t.size();
    run.error.push_back(trajectory.hamiltonian[i] - trajectory.hamiltonian.front());
    double& energy = late ? second : first;
    energy = std::max(energy, std::abs(run.error.back()));
    double& lambda = late ? run.lambda_second : run.lambda_first;
    for (const double x : trajectory.q[i]) run.size = std::max(run.size, std::abs(x));
    for (const double l : trajectory.lambda[i]) lambda = std::max(lambda, std::abs(l));
  }
  run.growth = second / first;
  run.correlation = fit_line(run.t, run.error).correlation;
  return run;
}

constexpr double kBounded = 1.1;        // growth from the first half of a run to the second
constexpr double kUncorrelated = 0.01;  // 1e4 samples

void add_energy_rows(const EnergyRun& run, PaperPart& part) {
  part.rows.push_back({"lambda along 1e5 steps, T = 5000",
                       "(no initial values)",
                       fmt::format("max |lambda| {:.3f}, 2nd half {:.3f}",
                                   std::max(run.lambda_first, run.lambda_second),
                                   run.lambda_second),
                       holds(run.lambda_second <= kBounded * run.lambda_first),
                       fmt::format("chosen so that lambda stays bounded: {}", kCosineStart),
                       run.lambda_second / run.lambda_first});
  const double rounding = kEps * run.size;
  part.rows.push_back(
      {"constraints at stages and nodes",
       "exact up to round-off",
       fmt::format(
           "{:.1e} = {:.1f} eps max |q|", run.constraint_error, run.constraint_error / rounding),
       holds(run.constraint_error <= 2 * rounding),
       fmt::format("|g(q).q'| / max(1, |q'|), largest of the same steps; the angles "
                   "have turned to {:.0f} rad, where they are rounded to eps |q|",
                   run.size),
       run.constraint_error,
       0});
  part.rows.push_back(
      {"energy error along them, h = 0.05",
       "appears bounded",
       fmt::format("max {:.2e}, 2nd half / 1st half {:.3f}", run.largest, run.growth),
       holds(run.growth <= kBounded),
       "",
       run.largest});
  part.rows.push_back({"its correlation with time",
                       "-",
                       fmt::format("{:.1e}", run.correlation),
                       holds(std::abs(run.correlation) < kUncorrelated),
                       "",
                       run.correlation,
                       0});
}

// Most initial values are like these: V holds the vehicle and lambda grows.
void add_trapped(PaperWork& work, PaperPart& part) {
  constexpr double kTime = 1000;
  const Dynamics dynamics = paper_dynamics(kCosineScene, "midpoint");
  std::vector<double> z = vehicle_start(dynamics, {1, 0.5, 0.3, 0.8}, 1, 0.2);
  // Large multipliers ask for small steps.
  constexpr double kStep = kCosineStep / 5;
  const StepPlan plan = StepPlan::of_length(0, kTime, kStep);
  const Trajectory trajectory = work.flow(dynamics, plan, z, 1001).trajectory;
  // The trajectory is chaotic: only sizes mean something.
  constexpr double kEarly = 20;
  constexpr double kGrowth = 5;
  double early = 0;
  double all = 0;
  for (std::size_t i = 0; i < trajectory.t.size(); ++i) {
    for (const double l : trajectory.lambda[i]) all = std::max(all, std::abs(l));
    if (trajectory.t[i] <= kEarly) early = all;
  }
  part.rows.push_back({"lambda from other initial values, T = 1000",
                       "-",
                       fmt::format("max {:.0f}, until t = 20 {:.1f}", all, early),
                       holds(all > kGrowth * early),
                       "grows from q = (1, 0.5, 0.3, 0.8), u = (1, 0.2), lambda = 0, as from most: "
                       "the reason for the choice",
                       all / early});
}

// Energy error at every node of the beginning.
Series beginning_of(PaperWork& work, const std::string& method) {
  constexpr double kTime = 25;
  const Dynamics dynamics = paper_dynamics(kCosineScene, method);
  const StepPlan plan = StepPlan::of_length(0, kTime, kCosineStep);
  std::vector<double> z = cosine_start(dynamics);
  const Trajectory nodes = work.flow(dynamics, plan, z, plan.count + 1).trajectory;
  Series series;
  series.x = nodes.t;
  for (const double h : nodes.hamiltonian) series.y.push_back(h - nodes.hamiltonian.front());
  return series;
}

SeriesPage energy_page(const Series& beginning, const std::vector<EnergyRun>& runs) {
  const EnergyRun& midpoint = runs.front();
  SeriesPage page;
  page.title = "vehicle, V = \u2212cos r: energy error";
  page.subtitle = "1e5 steps of h = 0.05";
  Series whole;
  whole.mark = Series::Mark::kDots;
  SeriesPanel so_far;
  for (const EnergyRun& run : runs) {
    Series largest;
    largest.title = run.method;
    double record = 0;
    for (std::size_t i = 1; i < run.t.size(); ++i) {
      record = std::max(record, std::abs(run.error[i]));
      largest.x.push_back(run.t[i]);
      largest.y.push_back(record);
    }
    so_far.series.push_back(largest);
  }
  whole.x = midpoint.t;
  whole.y = midpoint.error;
  const std::string label = "H \u2212 H(0) [energy]";
  SeriesPanel first;
  first.title = "midpoint rule, the beginning";
  first.x = {"t [time]", false, {}};
  first.y = {label, false, {}};
  first.series = {beginning};
  SeriesPanel second = first;
  second.title = "midpoint rule, the whole run";
  second.series = {whole};
  so_far.title = "largest so far";
  so_far.x = {"t [time]", true, {}};
  so_far.y = {"max |H \u2212 H(0)| [energy]", true, {}};
  page.panels = {first, second, so_far};
  return page;
}

}  // namespace

void add_cosine_energy(PaperWork& work, PaperPart& part) {
  std::vector<EnergyRun> runs;
  runs.reserve(kEnergyMethods.size());
  for (const std::string& method : kEnergyMethods) runs.push_back(energy_run(work, method));
  add_energy_rows(runs.front(), part);
  add_trapped(work, part);
  for (std::size_t i = 1; i < runs.size(); ++i) {
    const EnergyRun& run = runs[i];
    const bool bounded = run.growth <= kBounded && std::abs(run.correlation) < kUncorrelated;
    part.rows.push_back(
        {fmt::format("energy error, correlation, {}", run.method),
         run.symplectic ? "bounded" : "-",
         fmt::format("max {:.1e}, correlation {:.4f}", run.largest, run.correlation),
         holds(run.symplectic == bounded),
         run.symplectic ? "" : "not symplectic, for contrast: the energy drifts",
         run.correlation});
  }
  const SeriesPage page = energy_page(beginning_of(work, runs.front().method), runs);
  part.figures.push_back({"energy",
                          "energy error of the midpoint rule over 1e5 steps",
                          [page](const auto& file) { return plots::write_series(file, page); }});
}

}  // namespace carnot::apps
