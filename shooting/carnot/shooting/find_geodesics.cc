#include "carnot/shooting/find_geodesics.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/extremal/ranking.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/problem/origin.h"
#include "carnot/shooting/problem/rescaled.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/problem/turn_rates.h"
#include "carnot/shooting/problem/windings.h"
#include "carnot/shooting/search/abnormal_search.h"
#include "carnot/shooting/search/failure.h"
#include "carnot/shooting/search/limited_search.h"
#include "carnot/shooting/search/search.h"
#include "carnot/shooting/shoot/multiple_shooting.h"

namespace carnot {

using namespace internal;

namespace {

constexpr long kFewSteps = 32;  // of the path that does not move

// Moves the answer back to where `origin` is.
void move_to(const std::vector<double>& origin, Geodesic& geodesic) {
  for (std::size_t j = 0; j < origin.size(); ++j) {
    for (std::vector<double>& q : geodesic.trajectory.q) q[j] += origin[j];
    geodesic.from[j] += origin[j];
    geodesic.to[j] += origin[j];
  }
}

// from = to: the path that does not move.
Extremal constant_path(const BoundaryValueProblem& problem) {
  Extremal extremal;
  extremal.knots.segments = 1;
  extremal.knots.dof = problem.dynamics.dof;
  for (int i = 0; i <= extremal.knots.segments; ++i) {
    std::vector<double>& z = extremal.knots.z;
    z.insert(z.end(), problem.from.begin(), problem.from.end());
    z.resize(z.size() + problem.from.size(), 0.0);
  }
  extremal.geodesic.from = problem.from;
  extremal.geodesic.to = problem.from;
  extremal.geodesic.p0.assign(problem.dynamics.dof, 0.0);
  extremal.geodesic.lambda0.assign(problem.dynamics.multipliers, 0.0);
  extremal.geodesic.length = 0;
  extremal.geodesic.plan = StepPlan::equal(0, problem.time, kFewSteps);
  return extremal;
}

// The problem with a start that is its target, too, where free coordinates allow that.
BoundaryValueProblem at_rest(const BoundaryValueProblem& problem) {
  BoundaryValueProblem resting = problem;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (problem.is_free_from(j) && !problem.is_free_to(j)) resting.from[j] = problem.to[j];
  }
  return resting;
}

// Whether from = to needs no search: with velocity constraints the path that does not move is
// returned; elsewhere drift or a force may forbid it.
bool stays(const BoundaryValueProblem& problem) {
  if (distance_between_ends(problem) > 0) return false;
  if (problem.dynamics.has_transcription()) return true;
  if (problem.has_free_ends()) return false;
  std::vector<double> z = problem.from;
  z.resize(2 * problem.from.size(), 0.0);
  const StepPlan plan = StepPlan::equal(0, problem.time, kFewSteps);
  const bool completed = problem.dynamics.flow(plan, z).completed();
  for (std::size_t j = 0; j < problem.from.size(); ++j) {
    if (!(std::abs(z[j] - problem.from[j]) <= kRestRoundOff * (1 + std::abs(z[j])))) return false;
  }
  return completed;
}

// What the words of an answer are where the search was ended by its time limit.
std::string time_is_up(double seconds, const std::string& message) {
  std::ostringstream text;
  text << "the time limit of " << seconds << " s was up";
  return message.empty() ? text.str() : text.str() + "; " + message;
}

// What every report ends with.
void close(bool finished, std::chrono::steady_clock::time_point began, GeodesicReport& report) {
  if (!finished) {
    report.status = GeodesicStatus::kInterrupted;
    report.reason = Reason::kInterrupted;
    report.message = "interrupted";
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
  report.elapsed_seconds = elapsed.count();
}

// The last digit of the target, in natural scales.
double last_digit(const NaturalScales& scales, const BoundaryValueProblem& problem) {
  double farthest = 0;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (!problem.is_free_to(j)) {
      farthest = std::max(farthest, std::abs(problem.to[j]) / scales.q[j]);
    }
  }
  return kEpsilon * farthest;
}

// Options in natural scales, for a problem moved by `origin`.
GeodesicOptions in_scales(const NaturalScales& scales,
                          const BoundaryValueProblem& problem,
                          const std::vector<double>& origin,
                          GeodesicOptions options) {
  if (options.absolute_tolerance) {
    const double largest = *std::max_element(scales.q.begin(), scales.q.end());
    options.tolerance = *options.absolute_tolerance / largest;
  } else if (options.tolerance == GeodesicOptions{}.tolerance) {
    options.tolerance = std::max(options.tolerance, last_digit(scales, problem));
  }
  options.max_length /= scales.length();
  for (std::size_t j = 0; j < options.guess.size(); ++j) {
    double& x = options.guess[j];
    const int coordinate = static_cast<int>(j);
    x = problem.is_free_from(coordinate) ? (x - origin[j]) / scales.q[j]
                                         : x / scales.momentum(coordinate);
  }
  return options;
}

// From the natural scales of `problem` to its own units, where errors are measured again.
void finish(const BoundaryValueProblem& problem, const NaturalScales& scales, Extremal& extremal) {
  Geodesic& geodesic = extremal.geodesic;
  put_in_own_units(problem, scales, geodesic);
  Knots& knots = extremal.knots;
  const bool abnormal = geodesic.label == Label::kAbnormal;
  for (int i = 0; i <= knots.segments && !abnormal; ++i) {
    for (int j = 0; j < knots.dof; ++j) {
      knots.at(i)[j] *= scales.q[j];
      knots.at(i)[knots.dof + j] *= scales.momentum(j);
    }
  }
  // What was asked for is answered to the last digit.
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (problem.is_free_from(j)) continue;
    if (!abnormal) knots.at(0)[j] = problem.from[j];
    if (!geodesic.trajectory.q.empty()) geodesic.trajectory.q.front()[j] = problem.from[j];
  }
  if (abnormal) {
    std::vector<double> end = extremal.path.back();
    for (std::size_t j = 0; j < end.size(); ++j) end[j] *= scales.q[j];
    geodesic.endpoint_error = endpoint_error(problem, end.data());
  } else {
    measure_errors(problem, extremal);
  }
}

// What the searches for all images of the target gave.
struct Found {
  std::vector<BoundaryValueProblem> problems;  // one for each image, in natural scales
  std::vector<Extremal> list;
  std::vector<int> hits;
  int starts = 0;
  int converged = 0;
  int blocked = 0;
  bool finished = true;
  bool timed_out = false;
  bool counted = true;  // hits tell how many were missed
  Failure failure;      // why there is none, of the first image
};

void search_image(const NaturalScales& scales, const GeodesicOptions& options, Found& found) {
  const BoundaryValueProblem& problem = found.problems.back();
  const int image = static_cast<int>(found.problems.size()) - 1;
  if (stays(problem)) {
    found.list.push_back(constant_path(at_rest(problem)));
    found.list.back().image = image;
    return;
  }
  Search search(problem, options);
  if (options.guess.empty()) {
    found.finished = search.run();
  } else {
    search.polish_guess();
  }
  for (Extremal& extremal : search.extremals()) {
    found.list.push_back(std::move(extremal));
    found.list.back().image = image;
  }
  const std::vector<int> hits = search.hits();
  found.hits.insert(found.hits.end(), hits.begin(), hits.end());
  found.counted = found.counted && search.counts();
  found.starts += search.starts();
  found.converged += search.converged();
  found.blocked += search.blocked();
  found.timed_out = search.timed_out();
  std::optional<double> only;  // the length of a strictly abnormal curve that is not listed
  if (options.guess.empty() && found.finished) {
    if (auto abnormal = abnormal_extremal(problem, options, search)) {
      const bool strictly = abnormal->geodesic.label == Label::kAbnormal;
      if (strictly && !options.abnormal) {
        only = scales.length() * *abnormal->geodesic.length;
      } else {
        found.list.push_back(std::move(*abnormal));
        found.list.back().image = image;
        found.counted = false;
      }
    }
  }
  if (found.list.empty() && found.failure.reason == Reason::kNone) {
    found.failure = only ? only_abnormal(*only) : explain_failure(problem, scales, search, options);
  }
}

// The length beyond which an extremal is none of those that are wanted.
double longest_wanted(const std::vector<Extremal>& list, const GeodesicOptions& options) {
  const auto count = static_cast<std::size_t>(options.count);
  if (options.all || list.size() < count) return options.max_length;
  std::vector<double> lengths;
  lengths.reserve(list.size());
  for (const Extremal& extremal : list) {
    lengths.push_back(extremal.geodesic.length.value_or(std::numeric_limits<double>::infinity()));
  }
  std::nth_element(lengths.begin(), lengths.begin() + options.count - 1, lengths.end());
  return std::min(options.max_length, lengths[count - 1]);
}

// Of what is verified from knot to knot, `joined_samples` are recorded.
GeodesicReport find_without_limits(const BoundaryValueProblem& asked,
                                   const GeodesicOptions& options,
                                   long joined_samples) {
  const auto began = std::chrono::steady_clock::now();
  const Stop stop(options.time_limit);
  GeodesicReport report;
  const BoundaryValueProblem own = at_origin(asked);
  const NaturalScales scales = natural_scales(own);
  const BoundaryValueProblem problem = scales.trivial() ? own : rescaled(own, scales);
  const GeodesicOptions search = in_scales(scales, own, origin_of(asked), options);
  std::vector<Image> images{{problem.to, {}}};
  if (search.mod_angles) images = images_of_target(problem, search.max_length);
  Found found;
  found.problems.reserve(images.size());  // extremals refer to them
  // One guess is soon tried for all images.
  const bool prunes = images.size() > 1 && options.guess.empty();
  const std::vector<double> rates = prunes ? turn_rates(problem) : std::vector<double>{};
  for (const Image& image : images) {
    found.problems.push_back(problem);
    found.problems.back().to = image.to;
    if (least_length(found.problems.back(), rates) > longest_wanted(found.list, search)) continue;
    GeodesicOptions of_image = search;
    of_image.time_limit = stop.left();
    search_image(scales, of_image, found);
    const bool stayed = !found.list.empty() && found.list.back().geodesic.action == 0;
    if (!found.finished || found.timed_out || (stayed && !options.all && options.count == 1)) break;
  }
  rank(found.list);
  std::vector<Extremal>& list = found.list;
  if (!options.all && list.size() > static_cast<std::size_t>(options.count)) {
    list.resize(options.count);
  }
  parallel_for(static_cast<int>(list.size()), thread_count(options.threads), [&](int i) {
    const Image& image = images[list[i].image];
    list[i].geodesic.windings = image.windings;
    const bool joined = list[i].geodesic.verification == Verification::kKnots;
    complete(found.problems[list[i].image], joined ? joined_samples : options.samples, list[i]);
    if (!scales.trivial()) {
      BoundaryValueProblem of_image = own;
      for (std::size_t j = 0; j < image.windings.size(); ++j) {
        of_image.to[j] += image.windings[j] * own.dynamics.info.configuration[j].period;
      }
      finish(of_image, scales, list[i]);
    }
    move_to(origin_of(asked), list[i].geodesic);
  });
  for (Extremal& extremal : list) report.geodesics.push_back(std::move(extremal.geodesic));
  report.starts = found.starts;
  report.converged_starts = found.converged;
  report.distinct_hit = static_cast<int>(found.hits.size());
  if (found.counted && options.guess.empty()) {
    report.missed_estimate = list.empty() ? missed_estimate(found.hits)
                                          : missed_estimate(found.hits, report.geodesics.front());
  }
  report.status = list.empty() ? GeodesicStatus::kNotConverged : GeodesicStatus::kConverged;
  if (found.blocked > 0) report.message = blocked_starts(found.blocked, found.starts);
  if (!list.empty() && report.geodesics.front().label == Label::kAbnormal) {
    report.message = least_is_abnormal();
  }
  if (list.empty()) {
    report.reason = found.failure.reason;
    report.message = found.failure.message;
  }
  if (found.timed_out) report.message = time_is_up(options.time_limit, report.message);
  close(found.finished, began, report);
  return report;
}

// Every so many-th sample, such that about two thousand are looked at.
long dense_stride(long samples) {
  constexpr long kDense = 2048;
  return std::max(1L, (kDense + std::max(1L, samples - 1) - 1) / std::max(1L, samples - 1));
}

// So many samples of a trajectory that has `stride` times as many intervals.
Trajectory every(const Trajectory& dense, long stride, long samples) {
  Trajectory some;
  for (long i = 0; i < samples; ++i) {
    const std::size_t at = samples == 1 ? dense.t.size() - 1 : static_cast<std::size_t>(i * stride);
    some.t.push_back(dense.t[at]);
    some.q.push_back(dense.q[at]);
    some.p.push_back(dense.p[at]);
    some.lambda.push_back(dense.lambda[at]);
    some.hamiltonian.push_back(dense.hamiltonian[at]);
    if (!dense.work.empty()) some.work.push_back(dense.work[at]);
  }
  return some;
}

// Searches in natural scales. `free` and what is found are in the units of the problem.
LimitedAnswer search_in_scales(const BoundaryValueProblem& problem,
                               const NaturalScales& scales,
                               const GeodesicOptions& options,
                               const std::vector<Geodesic>& free) {
  if (scales.trivial()) return search_with_limits(problem, options, free);
  std::vector<Geodesic> scaled = free;
  for (Geodesic& geodesic : scaled) put_in_own_units(scales.inverse(), geodesic);
  LimitedAnswer answer = search_with_limits(rescaled(problem, scales), options, scaled);
  for (Geodesic& geodesic : answer.geodesics) {
    // An extremal without limits that keeps to them is left as it was, to the last digit.
    const auto same = std::find_if(scaled.begin(), scaled.end(), [&](const Geodesic& known) {
      return known.p0 == geodesic.p0;
    });
    if (same != scaled.end()) {
      Geodesic known = free[same - scaled.begin()];
      known.limits = geodesic.limits;
      known.limit_violation = geodesic.limit_violation;
      geodesic = std::move(known);
      continue;
    }
    put_in_own_units(problem, scales, geodesic);
  }
  return answer;
}

// The least of what each image of the target gives, where limits are kept to.
GeodesicReport find_with_limits(const BoundaryValueProblem& asked, const GeodesicOptions& options) {
  constexpr std::size_t kImages = 4;
  constexpr int kFewStarts = 12;
  const Stop stop(options.time_limit);
  const auto began = std::chrono::steady_clock::now();
  GeodesicReport report;
  std::vector<Image> images{{asked.to, {}}};
  if (options.mod_angles) images = images_of_target(asked, options.max_length);
  BoundaryValueProblem problem = asked;
  std::erase_if(images, [&](const Image& image) {
    problem.to = image.to;
    return !beyond_limit_at_end(problem).empty();
  });
  if (images.empty()) {
    report.message = beyond_limit_at_end(asked);
    report.reason = Reason::kLimitAtEnd;
    return report;
  }
  problem = asked;
  problem.limits.clear();
  // A few starts tell whether the least action is beyond a limit. Only where it is not must it be
  // known for sure: then it is the answer.
  GeodesicOptions all_starts = options;
  all_starts.abnormal = false;  // those are not followed along limits
  // What joins knots is judged by many samples, for p(0) alone does not tell where it goes.
  const long stride = dense_stride(options.samples);
  const long dense = stride * std::max(1L, options.samples - 1) + 1;
  GeodesicOptions few = all_starts;
  if (options.starts == 0 && options.guess.empty()) few.starts = kFewStarts;
  report = find_without_limits(problem, few, dense);
  const bool keeps = !report.geodesics.empty() && is_within_limits(asked, report.geodesics.front());
  if (few.starts != options.starts && report.status != GeodesicStatus::kInterrupted && keeps) {
    all_starts.time_limit = stop.left() > 0 ? stop.left() : few.time_limit;
    if (stop.left() > 0) report = find_without_limits(problem, all_starts, dense);
  }
  if (report.status == GeodesicStatus::kInterrupted) return report;
  // The nearest images, and all that an extremal without limits was found for.
  const auto is_known = [&](const Image& image) {
    return std::any_of(report.geodesics.begin(), report.geodesics.end(), [&](const Geodesic& g) {
      return g.windings == image.windings;
    });
  };
  std::stable_partition(images.begin(), images.end(), is_known);
  const auto known_images = std::count_if(images.begin(), images.end(), is_known);
  const std::size_t most = std::max(kImages, static_cast<std::size_t>(known_images));
  if (images.size() > most) images.resize(most);
  const std::vector<Geodesic> known = std::exchange(report.geodesics, {});
  report.missed_estimate.reset();  // it counts extremals without limits
  report.reason = Reason::kNone;
  const NaturalScales scales = natural_scales(problem);
  problem.limits = asked.limits;
  GeodesicOptions rest =
      in_scales(scales, problem, std::vector<double>(problem.from.size(), 0.0), options);
  bool finished = true;
  bool timed_out = stop.left() == 0;
  for (const Image& image : images) {
    problem.to = image.to;
    std::vector<Geodesic> of_image;
    for (const Geodesic& geodesic : known) {
      if (geodesic.windings == image.windings) of_image.push_back(geodesic);
    }
    rest.time_limit = stop.left();
    LimitedAnswer answer = search_in_scales(problem, scales, rest, of_image);
    finished = answer.finished;
    timed_out = timed_out || answer.timed_out;
    report.starts += answer.starts;
    report.converged_starts += answer.converged;
    for (Geodesic& geodesic : answer.geodesics) {
      geodesic.windings = image.windings;
      if (geodesic.trajectory.t.size() == static_cast<std::size_t>(dense)) {
        geodesic.trajectory = every(geodesic.trajectory, stride, options.samples);
      }
      report.geodesics.push_back(std::move(geodesic));
    }
    if (report.reason == Reason::kNone) {
      report.reason = answer.reason;
      report.message = answer.message;
    }
    if (!finished || timed_out) break;
  }
  rank(report.geodesics);
  if (!options.all && report.geodesics.size() > static_cast<std::size_t>(options.count)) {
    report.geodesics.resize(options.count);
  }
  const bool found = !report.geodesics.empty();
  report.distinct_hit = static_cast<int>(report.geodesics.size());
  report.status = found ? GeodesicStatus::kConverged : GeodesicStatus::kNotConverged;
  if (found) {
    report.reason = Reason::kNone;
    report.message.clear();
  }
  if (timed_out) report.message = time_is_up(options.time_limit, report.message);
  close(finished, began, report);
  return report;
}

}  // namespace

std::vector<std::string> minimisers() { return names_of_minimisers(); }

void GeodesicOptions::validate(const BoundaryValueProblem& problem) const {
  const auto require = [](bool ok, const std::string& what) {
    if (!ok) throw std::invalid_argument(what);
  };
  require(count >= 1, "count is " + std::to_string(count) + ", must be >= 1");
  require(starts >= 0, "starts is " + std::to_string(starts) + ", must be >= 0");
  require(threads >= 0, "threads is " + std::to_string(threads) + ", must be >= 0");
  require(samples >= 0, "samples is " + std::to_string(samples) + ", must be >= 0");
  for (const double given : {tolerance, absolute_tolerance.value_or(tolerance)}) {
    require(given > 0 && std::isfinite(given),
            "tolerance is " + std::to_string(given) + ", must be > 0");
  }
  require(time_limit > 0, "time_limit is " + std::to_string(time_limit) + ", must be > 0");
  require(max_length > 0, "max_length is " + std::to_string(max_length) + ", must be > 0");
  const std::vector<std::string> known = minimisers();
  require(std::find(known.begin(), known.end(), minimiser) != known.end(),
          "minimiser " + minimiser + " is unknown");
  require(guess.empty() || static_cast<int>(guess.size()) == problem.dynamics.dof,
          "guess has " + std::to_string(guess.size()) + " components, the scene has " +
              std::to_string(problem.dynamics.dof));
}

GeodesicReport find_geodesics(const BoundaryValueProblem& problem, const GeodesicOptions& options) {
  problem.validate();
  options.validate(problem);
  return problem.limits.empty() ? find_without_limits(problem, options, options.samples)
                                : find_with_limits(problem, options);
}

}  // namespace carnot
