#include "carnot/laws/step_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

namespace carnot {
namespace {

constexpr long kFewest = 4;
constexpr long kMost = 1L << 24;  // of the confirming run
constexpr double kSafety = 1.1;   // on the predicted number of steps
constexpr double kGrowth = 1.25;  // of the number of steps, at least
constexpr double kStalled = 0.9;  // an error that falls less than this is round-off
constexpr double kSmall = 1e-2;   // relative differences below this are taken as asymptotic

double max_norm(const std::vector<double>& z) {
  double norm = 0;
  for (const double x : z) norm = std::max(norm, std::abs(x));
  return norm;
}

double max_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double norm = 0;
  for (std::size_t i = 0; i < a.size(); ++i) norm = std::max(norm, std::abs(a[i] - b[i]));
  return norm;
}

// Trial runs of one initial value problem.
struct Trials {
  const Dynamics& dynamics;
  double start;
  double duration;
  const std::vector<double>& initial;
  const Progress& progress;
  StepChoice& choice;

  // The end point; empty when a step failed or the run was stopped.
  [[nodiscard]] std::optional<std::vector<double>> run(long count) const {
    std::vector<double> z = initial;
    const StepPlan plan = StepPlan::equal(start, duration, count);
    MonitorOptions audit;
    audit.progress = progress;
    const FlowReport report =
        progress ? dynamics.monitored_flow(plan, z, audit).report : dynamics.flow(plan, z);
    choice.evaluations += report.evaluations;
    if (report.status == FlowStatus::kStopped) choice.status = StepChoiceStatus::kStopped;
    if (!report.completed()) choice.message = report.reason();
    if (!report.completed() || !std::isfinite(max_norm(z))) return std::nullopt;
    return z;
  }

  // Estimated error of `count` steps; infinite when a run failed. `size` becomes |z| at the end.
  [[nodiscard]] double error(long count, double& size) const {
    const auto coarse = run(count);
    if (!coarse) return INFINITY;
    const auto fine = run(2 * count);
    if (!fine) return INFINITY;
    size = std::max(1.0, max_norm(*fine));
    return max_difference(*coarse, *fine) / (1 - std::pow(2.0, -dynamics.order));
  }
};

long next_count(long count, double error, double size, double tolerance, int order) {
  if (!(error < kSmall * size)) return 2 * count;
  const double factor = kSafety * std::pow(error / tolerance, 1.0 / order);
  return static_cast<long>(
      std::ceil(static_cast<double>(count) * std::clamp(factor, kGrowth, double{kMost})));
}

std::string rounded(double x) {
  std::ostringstream text;
  text.precision(2);
  text << x;
  return text.str();
}

std::string below_round_off(double tolerance, const StepChoice& choice, int order) {
  std::ostringstream text;
  text << "tolerance " << tolerance << " is below the round-off of this trajectory: with "
       << choice.count << " steps of order " << order << " the error is about "
       << rounded(choice.error) << "; ask for a larger tolerance or a shorter time";
  return text.str();
}

std::string too_many_steps(double tolerance, const StepChoice& choice, int order, long next) {
  std::ostringstream text;
  text << "tolerance " << tolerance << " would take about " << next << " steps of order " << order
       << ": with " << choice.count << " the error is about " << rounded(choice.error)
       << (choice.message.empty() ? "" : ", ") << choice.message
       << "; ask for a method of higher order, a larger tolerance or a shorter time";
  return text.str();
}

}  // namespace

StepChoice choose_steps(const Dynamics& dynamics,
                        double start,
                        double duration,
                        const std::vector<double>& z,
                        double tolerance,
                        const Progress& progress) {
  StepChoice choice;
  // Of lower or higher orders the trial's runs are up to twice as fine as needed.
  constexpr int kOrderOfTrials = 16;
  if (dynamics.has_automatic_flow() && dynamics.order == kOrderOfTrials) {
    std::vector<double> end = z;
    const AutomaticFlow run = dynamics.automatic_flow(start, duration, tolerance, end);
    choice.evaluations += run.evaluations;
    if (run.reached) {
      choice.count = run.plan.count;
      choice.stop = run.plan.stop;
      choice.error = run.error;
      return choice;
    }
  }
  const Trials trials{dynamics, start, duration, z, progress, choice};
  double previous = INFINITY;
  double size = 1;  // |z| at the end, as far as known
  for (long count = kFewest;;) {
    choice.count = count;
    choice.message.clear();
    choice.error = trials.error(count, size);
    if (choice.status == StepChoiceStatus::kStopped || choice.error <= tolerance) return choice;
    const long next = next_count(count, choice.error, size, tolerance, dynamics.order);
    if (previous < kSmall * size && choice.error > kStalled * previous) {
      choice.message = below_round_off(tolerance, choice, dynamics.order);
    } else if (next > kMost / 2) {
      choice.message = too_many_steps(tolerance, choice, dynamics.order, next);
    } else {
      previous = choice.error;
      count = next;
      continue;
    }
    choice.status = StepChoiceStatus::kNotReached;
    return choice;
  }
}

}  // namespace carnot
