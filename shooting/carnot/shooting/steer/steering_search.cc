#include "carnot/shooting/steer/steering_search.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "carnot/shooting/extremal/ranking.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/problem/turn_rates.h"
#include "carnot/shooting/problem/windings.h"

namespace carnot::internal {
namespace {

SteeringAnswer answer_of(Geodesic geodesic) {
  SteeringAnswer answer;
  answer.target = geodesic.to;
  for (std::size_t i = 0; i < geodesic.trajectory.t.size(); ++i) {
    for (const auto* x : {&geodesic.trajectory.q[i], &geodesic.trajectory.p[i]}) {
      answer.points.insert(answer.points.end(), x->begin(), x->end());
    }
  }
  constexpr long kIntervals = kSteeringSamples - 1;
  answer.steps = std::max(1L, (geodesic.plan.count + kIntervals - 1) / kIntervals);
  geodesic.trajectory = {};
  answer.geodesic = std::move(geodesic);
  return answer;
}

}  // namespace

SteeringSearch::SteeringSearch(Dynamics dynamics, SteeringOptions options)
    : dynamics_(std::move(dynamics)), options_(std::move(options)) {
  const std::vector<double> zero(dynamics_.dof, 0.0);
  options_of_search(1).validate({dynamics_, zero, zero});
  if (!(options_.time > 0) || !std::isfinite(options_.time)) {
    throw std::invalid_argument("time is " + std::to_string(options_.time) + ", must be > 0");
  }
  if (!(options_.resolution >= 0) || !std::isfinite(options_.resolution)) {
    throw std::invalid_argument("resolution is " + std::to_string(options_.resolution) +
                                ", must be >= 0");
  }
  if (!dynamics_.info.limits.empty()) {
    throw std::invalid_argument(
        "steering does not keep to limits: take them out of the scene, or ask find_geodesics");
  }
  const std::size_t free = options_.free_target.size();
  if (free > 0 && free != zero.size()) {
    throw std::invalid_argument("free_target has " + std::to_string(free) +
                                " components, the scene has " + std::to_string(zero.size()));
  }
  rates_ = turn_rates({dynamics_, zero, zero, options_.time});
  measure_sizes();
}

GeodesicOptions SteeringSearch::options_of_search(int count) const {
  GeodesicOptions search;
  search.count = count;
  search.starts = options_.starts;
  search.tolerance = options_.tolerance;
  search.seed = options_.seed;
  search.threads = options_.threads;
  search.samples = kSteeringSamples;
  search.abnormal = false;  // momenta lead to the neighbours
  if (options_.goes_on) {
    search.progress = [this](double /*fraction*/) { return options_.goes_on(); };
  }
  return search;
}

// Those of the scene, without a target. A scene whose scales are those of its questions keeps its
// own units: where there is no metric, or where the metric says nothing at the origin.
void SteeringSearch::measure_sizes() {
  const std::vector<double> zero(dynamics_.dof, 0.0);
  sizes_.assign(dynamics_.dof, 1.0);
  if (!dynamics_.has_transcription() || dynamics_.has_holonomic()) return;
  const NaturalScales scales = natural_scales({dynamics_, zero, zero, options_.time});
  const auto is_size = [](double u) { return u > 0 && std::isfinite(u); };
  if (std::all_of(scales.q.begin(), scales.q.end(), is_size)) sizes_ = scales.q;
}

std::string SteeringSearch::refusal(std::span<const double> from,
                                    std::span<const double> to) const {
  for (const auto& q : {from, to}) {
    if (static_cast<int>(q.size()) != dynamics_.dof) {
      return "a configuration has " + std::to_string(q.size()) + " components, the scene has " +
             std::to_string(dynamics_.dof);
    }
    for (const double x : q) {
      if (!std::isfinite(x)) {
        return "a configuration holds " + std::to_string(x) + ", not a finite number";
      }
    }
  }
  return "";
}

std::vector<Geodesic> SteeringSearch::solve(const BoundaryValueProblem& problem,
                                            const GeodesicOptions& options,
                                            SteeringAnswer& failure) {
  try {
    GeodesicReport report = find_geodesics(problem, options);
    if (report.status == GeodesicStatus::kInterrupted) {
      failure.reason = report.reason;
      failure.message = report.message;
      return {};
    }
    if (failure.reason == Reason::kNone) {
      failure.reason = report.reason;
      failure.message = report.message;
    }
    return std::move(report.geodesics);
  } catch (const std::invalid_argument& error) {  // e.g. constraints that are dependent there
    failure.reason = Reason::kIrregularEnd;
    failure.message = error.what();
    return {};
  }
}

std::vector<std::shared_ptr<const SteeringAnswer>> SteeringSearch::answers(
    const SteeringQuestion& question, int count) const {
  const auto middle = question.ends.begin() + dynamics_.dof;
  BoundaryValueProblem problem(
      dynamics_, {question.ends.begin(), middle}, {middle, question.ends.end()}, options_.time);
  problem.free_to = options_.free_target;
  std::vector<Image> images{{problem.to, {}}};
  const bool near = question.sense.contraction < 1;
  if (options_.mod_angles && !near) {
    images = images_of_target(problem, std::numeric_limits<double>::infinity());
  }
  std::vector<SteeringAnswer> list;
  SteeringAnswer failure;
  for (const Image& image : images) {
    problem.to = image.to;
    const bool full = static_cast<int>(list.size()) >= count;
    const double length = least_length(problem, rates_);
    const double action = 0.5 * length * length / problem.time;
    if (full && action >= list.back().geodesic->action) continue;
    GeodesicOptions options = options_of_search(count);
    std::vector<Geodesic> found = solve(problem, options, failure);
    // Only the nearest image makes the distance small where the target is near.
    if (found.empty() && options.starts > 0 && &image == &images.front()) {
      options.starts = 0;
      found = solve(problem, options, failure);
    }
    if (failure.reason == Reason::kInterrupted) {  // what was found before may not be the least
      list.clear();
      break;
    }
    for (Geodesic& geodesic : found) {
      list.push_back(answer_of(std::move(geodesic)));
    }
    // Equal ones stay in the order of the images.
    std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
      const double slack = kSameAction * std::abs(a.geodesic->action);
      return a.geodesic->action < b.geodesic->action - slack;
    });
    if (static_cast<int>(list.size()) > count) list.resize(count);
  }
  if (list.empty()) list.push_back(std::move(failure));
  std::vector<std::shared_ptr<const SteeringAnswer>> shared;
  shared.reserve(list.size());
  for (SteeringAnswer& answer : list) {
    shared.push_back(std::make_shared<const SteeringAnswer>(std::move(answer)));
  }
  return shared;
}

// q and p of the answer at s T, in the frame, with q contracted.
bool SteeringSearch::follow(const SteeringAnswer& answer,
                            const SteeringSense& sense,
                            double s,
                            std::vector<double>& z) const {
  const int size = 2 * dynamics_.dof;
  const double place = s * (kSteeringSamples - 1);
  const auto sample = std::min(kSteeringSamples - 2, static_cast<long>(place));
  const double* const begin = answer.points.data() + sample * size;
  z.assign(begin, begin + size);
  const double unit = options_.time / (kSteeringSamples - 1);
  const double since = place - static_cast<double>(sample);
  if (since > 0) {
    const double start = static_cast<double>(sample) * unit;
    const StepPlan plan = StepPlan::equal(start, since * unit, answer.steps);
    if (!dynamics_.flow(plan, z).completed()) return false;
  }
  contract(answer, sense, z.data());
  return true;
}

void SteeringSearch::contract(const SteeringAnswer& answer,
                              const SteeringSense& sense,
                              double* q) const {
  if (sense.contraction == 1) return;
  for (int j = 0; j < dynamics_.dof; ++j) {
    const double start = answer.points[j];
    q[j] = start + sense.contraction * (q[j] - start);
  }
}

bool SteeringSearch::point(const SteeringAnswer& answer,
                           const SteeringSense& sense,
                           std::span<const double> from,
                           std::span<const double> to,
                           double t,
                           std::span<double> q) const {
  const int n = dynamics_.dof;
  if (!answer.geodesic || static_cast<int>(q.size()) != n || !(t >= 0 && t <= 1)) return false;
  if (t == 0) {
    std::copy(from.begin(), from.end(), q.begin());
    return true;
  }
  thread_local std::vector<double> z;
  thread_local std::vector<double> turns;  // by which the image that is reached differs
  const std::span<const double> origin = sense.reversed ? to : from;
  const std::span<const double> other = sense.reversed ? from : to;
  z.assign(answer.target.begin(), answer.target.end());
  contract(answer, sense, z.data());
  leave_frame(dynamics_.info, origin.data(), z.data());
  turns.assign(n, 0.0);
  for (int j = 0; j < n; ++j) {
    if (period_of(j) > 0 && !rules().is_free(j))
      turns[j] = period_of(j) * std::round((z[j] - other[j]) / period_of(j));
    if (sense.reversed) turns[j] = -turns[j];
  }
  if (t == 1) {
    for (int j = 0; j < n; ++j) q[j] = rules().is_free(j) ? z[j] : to[j] + turns[j];
    return true;
  }
  if (!follow(answer, sense, sense.reversed ? 1 - t : t, z)) return false;
  leave_frame(dynamics_.info, origin.data(), z.data());
  for (int j = 0; j < n; ++j) q[j] = z[j] + (sense.reversed ? turns[j] : 0);
  return true;
}

}  // namespace carnot::internal
