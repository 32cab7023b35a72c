#include "carnot/shooting/continuation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "carnot/shooting/continue/curve_tracer.h"
#include "carnot/shooting/continue/limited_tracer.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/problem/origin.h"
#include "carnot/shooting/problem/rescaled.h"

namespace carnot {

using namespace internal;

namespace {

constexpr int kFirstSegments = 8;  // where the start was verified at knots
constexpr long kLeastSteps = 32;

std::string message_of(const ContinuationReport& report) {
  const double s = report.points.empty() ? 0 : report.points.back().s;
  switch (report.status) {
    case ContinuationStatus::kReached:
      return "";
    case ContinuationStatus::kReturned:
      return "the curve turned and came back to s = 0";
    case ContinuationStatus::kClosed:
      return "the curve closed without reaching s = 1";
    case ContinuationStatus::kMaxPoints:
      return "the largest number of points is used up at s = " + std::to_string(s) +
             ": allow more of them";
    case ContinuationStatus::kStepTooSmall:
      return "no step from s = " + std::to_string(s) +
             " leads to another verified extremal, however small: the curve may end there, at a "
             "singular extremal or where the flow does; try another line, or a larger tolerance";
    case ContinuationStatus::kSingular:
      return "the extremal at the start is not on one curve (abnormal, or a member of a continuum, "
             "or just at a branch point): start from another extremal or from a target nearby";
    case ContinuationStatus::kNotConverged:
      return "the extremal at the start could not be verified: try another one, or a larger "
             "tolerance";
    case ContinuationStatus::kInterrupted:
      return "interrupted";
  }
  return "";
}

// The start, its knots relative to the origin of `problem` where they were recorded elsewhere.
Place starting_place(const BoundaryValueProblem& asked,
                     const BoundaryValueProblem& problem,
                     const Geodesic& start,
                     long steps) {
  const std::vector<double> origin = origin_of(asked);
  if (start.verification == Verification::kSingle) {
    // An extremal that is known by its momentum alone starts where the problem does.
    std::vector<double> z = start.from.empty() ? asked.from : start.from;
    for (std::size_t j = 0; j < origin.size(); ++j) z[j] -= origin[j];
    z.insert(z.end(), start.p0.begin(), start.p0.end());
    return {knots_of(problem, start_unknowns(problem, z.data()), 1, steps), 0};
  }
  Place place{knots_of(start.trajectory, kFirstSegments), 0};
  for (int i = 0; i <= place.knots.segments; ++i) {
    for (int j = 0; j < place.knots.dof; ++j) place.knots.at(i)[j] -= origin[j];
  }
  return place;
}

// The curves through the branch points of the first one, both arms of each.
bool follow_branches(const ProblemLine& line,
                     const ContinuationOptions& options,
                     long steps,
                     const std::vector<Crossing>& crossings,
                     ContinuationReport& report) {
  for (const Crossing& crossing : crossings) {
    for (const Place& arm : crossing.arms) {
      const int branch = static_cast<int>(report.branch_ends.size()) + 1;
      CurveTracer tracer(line, options, steps, branch, report);
      report.branch_ends.push_back(tracer.trace(arm, &crossing.point));
      if (report.branch_ends.back() == ContinuationStatus::kInterrupted) return false;
      // The other arm is the other way round the same curve.
      if (report.branch_ends.back() == ContinuationStatus::kClosed) break;
    }
  }
  return true;
}

void check_start(const BoundaryValueProblem& problem, const Geodesic& start) {
  if (static_cast<int>(start.p0.size()) != problem.dynamics.dof) {
    throw std::invalid_argument("the momentum at the start has " + std::to_string(start.p0.size()) +
                                " components, the scene has " +
                                std::to_string(problem.dynamics.dof));
  }
  const std::size_t samples = start.trajectory.t.size();
  const bool sampled = start.verification != Verification::kSingle || !problem.limits.empty();
  if (sampled && (samples < 2 || (samples - 1) % 64 != 0)) {
    throw std::invalid_argument("the extremal at the start has " + std::to_string(samples) +
                                " samples, must have 64 k + 1");
  }
  if (problem.dynamics.forced > 0) {
    throw std::invalid_argument(
        "continuation is not offered with holonomic constraints that need RATTLE");
  }
}

void follow_with_limits(const ProblemLine& line,
                        const Geodesic& start,
                        const ContinuationOptions& options,
                        ContinuationReport& report) {
  LimitedTracer tracer(line, options, report);
  report.status = tracer.trace(start);
  report.message = message_of(report);
  if (report.status == ContinuationStatus::kNotConverged) {
    report.message =
        "the extremal at the start could not be solved for again: where it keeps to limits it must "
        "be a minimum; try another one, or a larger tolerance";
  } else if (report.status == ContinuationStatus::kStepTooSmall) {
    report.message = "no step from s = " + std::to_string(report.points.back().s) +
                     ", however small, leads to an extremal near the last one" +
                     (tracer.trouble().empty() ? ": its branch may end there, or the limits close "
                                                 "the way; search anew beyond it"
                                               : ": " + tracer.trouble());
  }
}

void follow_curves(const ProblemLine& asked,
                   const Geodesic& start,
                   const ContinuationOptions& options,
                   ContinuationReport& report) {
  const ProblemLine line{[&](double s) { return at_origin(asked.at(s)); }, asked.only_target};
  const long steps = std::max(kLeastSteps, start.plan.count / 2);
  CurveTracer tracer(line, options, steps, 0, report);
  report.status = tracer.trace(starting_place(asked.at(0), line.at(0), start, steps));
  report.message = message_of(report);
  if (report.status != ContinuationStatus::kInterrupted &&
      !follow_branches(line, options, steps, tracer.crossings(), report)) {
    report.status = ContinuationStatus::kInterrupted;
    report.message = message_of(report);
  }
}

void put_in_own_units(const ProblemLine& asked,
                      const NaturalScales& scales,
                      ContinuationReport& report) {
  for (ContinuationPoint& point : report.points) {
    internal::put_in_own_units(asked.at(point.s), scales, point.geodesic);
  }
  for (auto* points : {&report.folds, &report.branch_points}) {
    for (SpecialPoint& point : *points) {
      point.action *= scales.action;
      for (std::size_t j = 0; j < point.p0.size(); ++j) {
        point.p0[j] *= scales.momentum(static_cast<int>(j));
      }
    }
  }
  for (ContactChange& change : report.contact_changes) change.action *= scales.action;
}

}  // namespace

void ContinuationOptions::validate() const {
  const auto require = [](bool ok, const std::string& name, double value, const std::string& what) {
    if (!ok)
      throw std::invalid_argument(name + " is " + std::to_string(value) + ", must be " + what);
  };
  require(smallest_step > 0, "smallest_step", smallest_step, "> 0");
  require(first_step >= smallest_step, "first_step", first_step, ">= smallest_step");
  require(largest_step >= first_step && std::isfinite(largest_step),
          "largest_step",
          largest_step,
          ">= first_step");
  require(max_points >= 1, "max_points", max_points, ">= 1");
  for (const double each : {tolerance, absolute_tolerance.value_or(tolerance)}) {
    require(each > 0 && std::isfinite(each), "tolerance", each, "> 0");
  }
}

ContinuationReport continue_geodesic(const ProblemLine& asked,
                                     const Geodesic& start,
                                     const ContinuationOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  options.validate();
  const BoundaryValueProblem original = asked.at(0);
  original.validate();
  asked.at(1).validate();
  check_start(original, start);
  if (start.label == Label::kAbnormal) {
    ContinuationReport report;
    report.status = ContinuationStatus::kSingular;
    report.message = message_of(report);
    return report;
  }
  const auto follow = original.limits.empty() ? follow_curves : follow_with_limits;
  BoundaryValueProblem unlimited = original;
  unlimited.limits.clear();
  const NaturalScales scales = natural_scales(unlimited);
  ContinuationOptions scaled = options;
  if (options.absolute_tolerance) {
    scaled.tolerance =
        *options.absolute_tolerance / *std::max_element(scales.q.begin(), scales.q.end());
  }
  ContinuationReport report;
  if (scales.trivial()) {
    follow(asked, start, scaled, report);
  } else {
    const ProblemLine line{[&](double s) { return rescaled(asked.at(s), scales); },
                           asked.only_target};
    Geodesic first = start;
    // An extremal that is known by its momentum alone starts where the problem does.
    if (first.from.empty()) first.from = original.from;
    if (first.to.empty()) first.to = original.to;
    internal::put_in_own_units(scales.inverse(), first);
    follow(line, first, scaled, report);
    put_in_own_units(asked, scales, report);
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
  report.elapsed_seconds = elapsed.count();
  return report;
}

}  // namespace carnot
