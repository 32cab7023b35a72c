#include "paper/paper_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "catalogue/scene_choice.h"

namespace carnot::apps {

Dynamics paper_dynamics(const std::string& scene, const std::string& method) {
  return find_scene(scene).make({}, method);
}

PaperWork::PaperWork(Progress progress, double total)
    : progress_(std::move(progress)), total_(total) {}

FlowSummary PaperWork::flow(const Dynamics& dynamics,
                            const StepPlan& plan,
                            std::vector<double>& z,
                            long samples) {
  const auto steps = static_cast<double>(plan.count);
  MonitorOptions options;
  options.samples = samples;
  options.progress = part(steps);
  FlowSummary summary = dynamics.monitored_flow(plan, z, options);
  finish(dynamics, summary.report, steps);
  return summary;
}

TangentMap PaperWork::tangent(const Dynamics& dynamics,
                              const StepPlan& plan,
                              const std::vector<double>& z) {
  const auto steps = static_cast<double>(plan.count);
  TangentMap map = tangent_along(dynamics, plan, z, part(steps));
  FlowReport report;
  report.status = map.status;
  finish(dynamics, report, steps);
  return map;
}

Progress PaperWork::part(double steps) const {
  if (!progress_) return {};
  return [this, steps](double fraction) { return progress_((steps_ + fraction * steps) / total_); };
}

void PaperWork::finish(const Dynamics& dynamics, const FlowReport& report, double steps) {
  steps_ += steps;
  const bool stopped = progress_ && !progress_(steps_ / total_);
  if (stopped) throw std::runtime_error("stopped");
  if (!report.completed()) {
    throw std::runtime_error(fmt::format("a run of {} by {} failed at t = {:g}: {}",
                                         dynamics.info.name,
                                         dynamics.method,
                                         report.time_reached,
                                         report.reason()));
  }
}

std::vector<double> phase_point(const Trajectory& trajectory, std::size_t row) {
  std::vector<double> z = trajectory.q[row];
  z.insert(z.end(), trajectory.p[row].begin(), trajectory.p[row].end());
  return z;
}

double max_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

LineFit fit_growth(const std::vector<double>& x,
                   const std::vector<double>& y,
                   double lower,
                   double upper) {
  std::vector<double> times;
  std::vector<double> logs;
  for (std::size_t i = 0; i < x.size() && !(y[i] > upper); ++i) {
    if (!(y[i] >= lower)) continue;
    times.push_back(x[i]);
    logs.push_back(std::log(y[i]));
  }
  return fit_line(times, logs);
}

}  // namespace carnot::apps
