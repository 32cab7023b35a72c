#include "carnot/laws/laws.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "carnot/laws/tangent_map.h"
#include "carnot/numerics/linear_algebra.h"

namespace carnot {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

using Column = Eigen::VectorXd;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

double size(const std::vector<double>& z) {
  double largest = 1;
  for (const double x : z) largest = std::max(largest, std::abs(x));
  return largest;
}

// max |a - b| / max(1, |b|).
double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest / size(b);
}

bool finite(const std::vector<double>& z) {
  return std::all_of(z.begin(), z.end(), [](double x) { return std::isfinite(x); });
}

// The end of `count` equal steps; nothing where one fails.
std::optional<std::vector<double>> end_of(const Dynamics& dynamics,
                                          const PhaseStart& start,
                                          double duration,
                                          long count) {
  std::vector<double> z = start.z;
  const FlowReport report = dynamics.flow(StepPlan::equal(start.t, duration, count), z);
  if (!report.completed() || !finite(z)) return std::nullopt;
  return z;
}

// Where a run ended, and the Dynamics on the branch that it ended on.
struct Continuation {
  PhaseStart start;
  Dynamics dynamics;
};

std::optional<Continuation> follow(const Dynamics& dynamics,
                                   const PhaseStart& start,
                                   double duration,
                                   long count) {
  Continuation end{start, dynamics};
  MonitorOptions ends;
  ends.samples = 2;
  const StepPlan plan = StepPlan::equal(start.t, duration, count);
  const FlowSummary run = dynamics.monitored_flow(plan, end.start.z, ends);
  if (!run.completed() || !finite(end.start.z)) return std::nullopt;
  end.start.t = plan.end;
  if (dynamics.has_branches()) {
    const std::span<const double> z(end.start.z);
    const auto branch = dynamics.on_branch(
        end.start.t, z.first(dynamics.dof), z.subspan(dynamics.dof), run.trajectory.lambda.back());
    if (!branch) return std::nullopt;
    end.dynamics = *branch;
  }
  return end;
}

void flip(const Dynamics& dynamics, std::vector<double>& z) {
  for (int i = 0; i < dynamics.dof; ++i) z[dynamics.dof + i] = -z[dynamics.dof + i];
}

// Whether H(q, -p) = H(q, p) and q'(q, -p) = -q'(q, p), at this point.
bool even_in_momentum(const Dynamics& dynamics, PhaseStart at) {
  constexpr double kRoundOff = 1e-12;
  std::vector<double> forward(dynamics.dof);
  std::vector<double> backward(dynamics.dof);
  std::vector<double> lambda(dynamics.multipliers);
  const auto evaluate = [&](std::vector<double>& velocity) {
    const std::span<const double> z(at.z);
    return dynamics.evaluate(
        at.t, z.first(dynamics.dof), z.subspan(dynamics.dof), velocity, lambda);
  };
  const PointValues there = evaluate(forward);
  flip(dynamics, at.z);
  const PointValues back = evaluate(backward);
  if (there.status != RateStatus::kOk || back.status != RateStatus::kOk) return false;
  for (double& v : backward) v = -v;
  const double change = std::abs(there.hamiltonian - back.hamiltonian);
  return change <= kRoundOff * std::max(1.0, std::abs(there.hamiltonian)) &&
         relative_distance(backward, forward) <= kRoundOff;
}

double largest(const std::vector<double>& values, std::size_t count) {
  double result = 0;
  for (std::size_t i = 0; i < count; ++i) result = std::max(result, std::abs(values[i]));
  return result;
}

double ratio(double all, double early) {
  if (early > 0) return all / early;
  return all > 0 ? std::numeric_limits<double>::infinity() : 1;
}

}  // namespace

ReferenceRun reference_run(const Dynamics& accurate,
                           const PhaseStart& start,
                           double duration,
                           long most_steps) {
  constexpr double kGoal = 4 * kEps;
  constexpr long kFewestSteps = 32;
  ReferenceRun best;
  best.start = start;
  best.duration = duration;
  std::optional<std::vector<double>> coarse;
  for (long count = kFewestSteps; count <= most_steps; count *= 2) {
    const auto fine = end_of(accurate, start, duration, count);
    if (coarse && fine) {
      const double change = relative_distance(*coarse, *fine);
      if (change < best.error) {
        best.end = *fine;
        best.error = change;
      }
      if (change <= kGoal) break;
    }
    coarse = fine;
  }
  return best;
}

OrderLaw measure_order(const Dynamics& dynamics, const ReferenceRun& reference) {
  constexpr double kCeiling = 1e-3;  // errors above are not ruled by the leading term
  constexpr double kLeastPlateau = 500 * kEps;
  constexpr std::size_t kFitted = 5;  // over four or five decades of the error
  constexpr long kMostSteps = 4096;
  OrderLaw law;
  if (reference.end.empty()) return law;
  const double plateau = std::max(kLeastPlateau, 20 * reference.error);
  const double rung = std::min(2.0, std::pow(10.0, 1.0 / dynamics.order));
  for (long count = 1; count <= kMostSteps;
       count = std::max(count + 1, std::lround(rung * static_cast<double>(count)))) {
    const auto end = end_of(dynamics, reference.start, reference.duration, count);
    if (!end) continue;
    const double error = relative_distance(*end, reference.end);
    if (error <= plateau) break;
    if (error >= kCeiling) continue;
    law.steps.push_back(reference.duration / static_cast<double>(count));
    law.errors.push_back(error);
  }
  if (law.steps.size() > kFitted) {
    law.steps.erase(law.steps.begin(), law.steps.end() - kFitted);
    law.errors.erase(law.errors.begin(), law.errors.end() - kFitted);
  }
  std::vector<double> x;
  std::vector<double> y;
  for (const double step : law.steps) x.push_back(std::log(step));
  for (const double error : law.errors) y.push_back(std::log(error));
  law.fit = fit_line(x, y);
  return law;
}

double measure_symplecticity(const Dynamics& dynamics,
                             const PhaseStart& start,
                             double step,
                             long steps) {
  const int n = dynamics.dof;
  const StepPlan plan = StepPlan::equal(start.t, step * static_cast<double>(steps), steps);
  const TangentMap map = tangent_along(dynamics, plan, start.z, Progress());
  if (map.status != FlowStatus::kCompleted) return kNotMeasured;
  if (dynamics.forced == 0) return map.relative_defect;
  Square p(2 * n, 2 * n);  // symmetric
  if (!dynamics.tangent_projector(start.t, start.z, span_of(p))) return kNotMeasured;
  const auto form = [n](const Square& a) {  // a'J a
    const Square product = a.bottomRows(n).transpose().lazyProduct(a.topRows(n));
    return Square(product - product.transpose());
  };
  const Eigen::Map<const Square> m(map.m.data(), 2 * n, 2 * n);
  const double defect = (form(m.lazyProduct(p)) - form(p)).cwiseAbs().maxCoeff();
  return defect / std::max(1.0, m.squaredNorm());
}

ReversalLaw measure_reversal(const Dynamics& dynamics,
                             const PhaseStart& start,
                             double step,
                             long steps) {
  ReversalLaw law;
  const double duration = step * static_cast<double>(steps);
  const auto there = follow(dynamics, start, duration, steps);
  const TangentMap map =
      tangent_along(dynamics, StepPlan::equal(start.t, duration, steps), start.z, Progress());
  if (!there || map.status != FlowStatus::kCompleted) return law;
  const Eigen::Map<const Column> m(map.m.data(), static_cast<Eigen::Index>(map.m.size()));
  const double enlarged = std::max(1.0, m.norm());
  if (const auto back = end_of(there->dynamics, there->start, -duration, steps)) {
    law.adjoint = relative_distance(*back, start.z) / enlarged;
  }
  if (!dynamics.autonomous || !even_in_momentum(dynamics, start) ||
      !even_in_momentum(there->dynamics, there->start)) {
    return law;
  }
  PhaseStart mirrored = there->start;
  flip(dynamics, mirrored.z);
  if (auto back = end_of(there->dynamics, mirrored, duration, steps)) {
    flip(dynamics, *back);
    law.mirrored = relative_distance(*back, start.z) / enlarged;
  }
  return law;
}

EnergyLaw measure_energy(const Dynamics& dynamics,
                         const PhaseStart& start,
                         double step,
                         long steps,
                         const Progress& progress) {
  constexpr long kMostSamples = 10000;
  constexpr long kEarly = 10;  // the first tenth
  EnergyLaw law;
  law.steps = steps;
  const double duration = step * static_cast<double>(steps);
  std::vector<double> z = start.z;
  MonitorOptions options;
  options.samples = std::min(steps, kMostSamples) + 1;
  options.progress = progress;
  const FlowSummary run =
      dynamics.monitored_flow(StepPlan::equal(start.t, duration, steps), z, options);
  law.report = run.report;
  law.constraint_error = run.constraint_error;
  law.holonomic_error = run.holonomic_error;
  if (!run.completed()) return law;
  const std::vector<double>& h = run.trajectory.hamiltonian;
  // Where H depends on time, the rounding of t shows too, times H_t of order one.
  law.round_off =
      kEps * (std::sqrt(static_cast<double>(steps)) * std::max(1.0, std::abs(h.front())) +
              (dynamics.autonomous ? 0 : std::abs(start.t + duration)));
  law.largest = run.energy_balance;
  if (!dynamics.autonomous) {
    std::vector<double> early = start.z;
    const StepPlan tenth = StepPlan::equal(start.t, duration / kEarly, steps / kEarly);
    const FlowSummary first = dynamics.monitored_flow(tenth, early, MonitorOptions());
    law.growth = ratio(run.energy_balance, first.energy_balance);
    return law;
  }
  std::vector<double> errors;
  errors.reserve(h.size());
  for (const double value : h) errors.push_back(value - h.front());
  const double all = largest(errors, errors.size());
  law.growth = ratio(all, largest(errors, errors.size() / kEarly));
  const LineFit fit = fit_line(run.trajectory.t, errors);
  law.correlation = all > 0 ? fit.correlation : 0;
  law.drift = all > 0 ? fit.slope * duration / all : 0;
  return law;
}

double measure_midpoint_constraint(const Dynamics& dynamics,
                                   const PhaseStart& start,
                                   double step,
                                   long steps) {
  if (!dynamics.has_transcription()) return kNotMeasured;
  const int n = dynamics.dof;
  const int k = dynamics.transcribed;
  std::vector<double> z = start.z;
  const StepPlan plan = StepPlan::equal(start.t, step * static_cast<double>(steps), steps);
  MonitorOptions nodes;
  nodes.samples = steps + 1;
  const FlowSummary run = dynamics.monitored_flow(plan, z, nodes);
  if (!run.completed()) return kNotMeasured;
  double worst = 0;
  std::vector<double> gradient(2 * n + k);
  for (long i = 0; i < steps; ++i) {
    // F_d is linear in lambda: its derivative is -h g(q_mid).(q1 - q0)/h.
    const std::vector<double>& q0 = run.trajectory.q[i];
    const std::vector<double>& q1 = run.trajectory.q[i + 1];
    std::vector<double> x = q0;
    x.insert(x.end(), q1.begin(), q1.end());
    x.resize(2 * n + k, 0.0);
    dynamics.discrete_lagrangian(step, x, gradient);
    double speed = 1;
    for (int j = 0; j < n; ++j) speed = std::max(speed, std::abs((q1[j] - q0[j]) / step));
    for (int j = 0; j < k; ++j) {
      worst = std::max(worst, std::abs(gradient[2 * n + j] / step) / speed);
    }
  }
  return worst;
}

}  // namespace carnot
