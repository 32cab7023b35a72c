#include "carnot/shooting/continue/curve_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/survey.h"

namespace carnot::internal {
namespace {

using Eigen::VectorXd;

constexpr double kMaxGrowth = 30;  // of a tangent flow between two knots: more makes steps short
constexpr int kMaxSegments = 32;
constexpr double kSameMomentum = 1e-6;  // relative; verification only polishes

// det (F'; tangent') over that of a point nearby.
double determinant(const CurvePoint& point, const CurvePoint& reference) {
  return point.orientation * std::exp(point.log_determinant - reference.log_determinant);
}

// (p(0), s).
VectorXd head_of(const Place& place) {
  const int n = place.knots.dof;
  VectorXd head(n + 1);
  head << Eigen::Map<const VectorXd>(place.knots.at(0) + n, n), place.s;
  return head;
}

// Twice as many knots, the new ones by the flow.
std::optional<Knots> split(const BoundaryValueProblem& problem, const Knots& knots, long steps) {
  const int size = 2 * knots.dof;
  Knots finer{2 * knots.segments, knots.dof, {}};
  for (int i = 0; i < knots.segments; ++i) {
    std::vector<double> z(knots.at(i), knots.at(i) + size);
    finer.z.insert(finer.z.end(), z.begin(), z.end());
    const StepPlan plan = knot_plan(problem, finer.segments, 2 * i, steps);
    if (!problem.dynamics.flow(plan, z).completed()) return std::nullopt;
    finer.z.insert(finer.z.end(), z.begin(), z.end());
  }
  finer.z.insert(finer.z.end(), knots.at(knots.segments), knots.at(knots.segments) + size);
  return finer;
}

}  // namespace

Place CurveTracer::place_of(const VectorXd& x) const {
  const double s = x[x.size() - 1];
  return {equations_->knots(x), s < kArclengthRoundOff ? 0.0 : std::min(s, 1.0)};
}

bool CurveTracer::set_up(Place place, const VectorXd& along) {
  while (true) {
    equations_ = std::make_unique<LineEquations>(line_, place.knots, place.s, steps_);
    curve_ = std::make_unique<SolutionCurve>(*equations_);
    const auto point =
        curve_->start(equations_->unknowns(place.knots, place.s), equations_->from_head(along));
    if (!point) return false;
    here_ = *point;
    last_.reset();
    curvature_.setZero(here_.x.size());
    if (equations_->growth() <= kMaxGrowth || equations_->segments() >= kMaxSegments) return true;
    place = place_of(here_.x);
    const auto finer = split(line_.at(place.s), place.knots, steps_);
    if (!finer) return false;
    place.knots = *finer;
  }
}

bool CurveTracer::renew() {
  const bool dense = equations_->growth() > kMaxGrowth && equations_->segments() < kMaxSegments;
  if (!dense && equations_->in_scale(here_.x) && equations_->steps() == steps_) return true;
  return set_up(place_of(here_.x), equations_->head(here_.tangent));
}

bool CurveTracer::add(const CurvePoint& point) {
  const Place place = place_of(point.x);
  const BoundaryValueProblem problem = line_.at(place.s);
  auto extremal = verify(problem, place.knots, steps_, options_.tolerance).extremal;
  if (!extremal) return false;
  const std::vector<double> p0 = place.knots.p0();
  const int n = place.knots.dof;
  const double size = Eigen::Map<const VectorXd>(p0.data(), n).norm();
  const double moved = largest_difference(p0.data(), extremal->geodesic.p0.data(), n);
  // p(0) may pass zero, where nothing is small relative to it.
  largest_momentum_ = std::max(largest_momentum_, size);
  if (!(moved <= kSameMomentum * largest_momentum_)) return false;
  steps_ = std::max(steps_, extremal->geodesic.plan.count / 2);
  if (options_.labels) label(problem, *extremal);
  report_.points.push_back({place.s, branch_, std::move(extremal->geodesic)});
  return true;
}

std::optional<CurveTracer::Step> CurveTracer::finish(const VectorXd& x,
                                                     const VectorXd& row,
                                                     double length,
                                                     std::optional<ContinuationStatus> end) {
  constexpr double kLargestAngle = 0.3;
  constexpr double kLargestDistance = 0.5;  // of the step
  auto point = curve_->correct(x, row, here_.tangent);
  if (!point || !(point->distance <= kLargestDistance * length)) return std::nullopt;
  const double angle = std::acos(std::min(1.0, point->tangent.dot(here_.tangent)));
  if (!(angle <= kLargestAngle)) return std::nullopt;
  return Step{std::move(*point), angle, end};
}

std::optional<CurveTracer::Step> CurveTracer::close(double length) {
  constexpr int kFewest = 4;  // steps of a closed curve
  constexpr double kSame = 1e-6;
  if (taken_ < kFewest) return std::nullopt;
  const VectorXd first = equations_->from_head(first_);
  const VectorXd row = equations_->from_head(first_rate_);
  const VectorXd away = first - equations_->from_head(equations_->head(here_.x));
  const double share = row.dot(away) / row.dot(here_.tangent);
  if (!(share > 0 && share <= length && away.norm() <= 2 * length)) return std::nullopt;
  auto step =
      finish(here_.x + share * here_.tangent, row.normalized(), share, ContinuationStatus::kClosed);
  if (!step) return std::nullopt;
  const VectorXd missed = first - equations_->from_head(equations_->head(step->point.x));
  return missed.norm() <= kSame ? step : std::nullopt;
}

VectorXd CurveTracer::predicted(double length) const {
  return here_.x + length * here_.tangent + 0.5 * length * length * curvature_;
}

std::optional<CurveTracer::Step> CurveTracer::attempt(double length) {
  constexpr double kReach = 1.1;  // a slightly longer step avoids a tiny one at the end
  if (auto closed = close(length)) return closed;
  const double slope = here_.slope();
  const double bound = slope > 0 ? 1 : 0;
  const double to_bound = (bound - here_.s()) / slope;
  if (to_bound > 0 && to_bound <= kReach * length) {
    VectorXd x = predicted(to_bound);
    x[x.size() - 1] = bound;
    return finish(x,
                  VectorXd::Unit(x.size(), x.size() - 1),
                  to_bound,
                  slope > 0 ? ContinuationStatus::kReached : ContinuationStatus::kReturned);
  }
  return finish(predicted(length), here_.tangent, length, std::nullopt);
}

// Sizes of the next step as in Allgower & Georg, 6.1: from contraction, distance and angle.
bool CurveTracer::advance(std::optional<ContinuationStatus>& end) {
  constexpr double kContraction = 0.4;
  constexpr double kDistance = 0.05;  // of the step
  constexpr double kAngle = 0.1;
  for (; step_ >= options_.smallest_step; step_ *= 0.5) {
    auto step = attempt(step_);
    if (!step || !add(step->point)) continue;
    note_special_points(here_, step->point);
    note_touch(step->point);
    const double worst = std::max({std::sqrt(step->point.contraction / kContraction),
                                   std::sqrt(step->point.distance / (kDistance * step_)),
                                   step->angle / kAngle});
    step_ = std::min(step_ / std::clamp(worst, 0.5, 2.0), options_.largest_step);
    curvature_ = (step->point.tangent - here_.tangent) / (step->point.x - here_.x).norm();
    last_ = std::exchange(here_, std::move(step->point));
    end = step->end;
    ++taken_;
    return true;
  }
  return false;
}

ContinuationStatus CurveTracer::trace(const Place& start, const Place* origin) {
  origin_ = origin;
  VectorXd along = VectorXd::Unit(start.knots.dof + 1, start.knots.dof);
  if (origin != nullptr) along = head_of(start) - head_of(*origin);
  if (!verify(line_.at(start.s), start.knots, steps_, options_.tolerance).extremal) {
    return ContinuationStatus::kNotConverged;
  }
  if (!set_up(start, along)) return ContinuationStatus::kSingular;
  if (!add(here_)) return ContinuationStatus::kNotConverged;
  first_ = equations_->head(here_.x);
  first_rate_ = equations_->head(here_.tangent);
  step_ = options_.first_step;
  std::optional<ContinuationStatus> end;
  while (!end) {
    const int points = static_cast<int>(report_.points.size());
    if (points >= options_.max_points) return ContinuationStatus::kMaxPoints;
    const double share = std::max(here_.s(), double(points) / options_.max_points);
    if (options_.progress && !options_.progress(std::min(1.0, share))) {
      return ContinuationStatus::kInterrupted;
    }
    if (!renew() || !advance(end)) return ContinuationStatus::kStepTooSmall;
  }
  return *end;
}

SpecialPoint CurveTracer::describe(const VectorXd& x) const {
  const Place place = place_of(x);
  const FlowSummary measured = survey(line_.at(place.s), place.knots, steps_, 0);
  return {place.s, branch_, place.knots.p0(), measured.action};
}

void CurveTracer::note_special_points(const CurvePoint& before, const CurvePoint& after) {
  constexpr double kSame = 1e-5;
  constexpr double kStands = 1e-9;  // s does not change along a continuum of extremals
  std::optional<VectorXd> crossing;
  if (before.orientation != after.orientation) {
    crossing = curve_->locate(
        before, after, [&](const CurvePoint& point) { return determinant(point, before); });
    note_crossing(before, *crossing);
  }
  const bool turns = (before.slope() > 0) != (after.slope() > 0);
  const bool moves = std::max(std::abs(before.slope()), std::abs(after.slope())) > kStands;
  if (!turns || !moves) return;
  const VectorXd fold =
      curve_->locate(before, after, [](const CurvePoint& point) { return point.slope(); });
  // Where a curve of mirror partners turns at the branch point it is no fold.
  if (crossing && (fold - *crossing).norm() <= kSame) return;
  report_.folds.push_back(describe(fold));
}

void CurveTracer::note_touch(const CurvePoint& after) {
  if (!last_ || last_->orientation != here_.orientation) return;
  if (after.orientation != here_.orientation) return;
  const double dip = here_.log_determinant;
  if (!(dip < last_->log_determinant && dip <= after.log_determinant)) return;
  const auto touch = curve_->locate_touch(*last_, after);
  if (touch) report_.branch_points.push_back(describe(*touch));
}

void CurveTracer::note_crossing(const CurvePoint& before, const VectorXd& x) {
  constexpr double kSame = 1e-4;
  constexpr std::array kAside{1.0, 0.25, 0.06};  // of the first step
  if (origin_ != nullptr) {
    const VectorXd known = equations_->from_head(head_of(*origin_));
    const VectorXd found = equations_->from_head(equations_->head(x));
    if ((known - found).norm() <= kSame) return;
  }
  report_.branch_points.push_back(describe(x));
  if (!options_.branches || branch_ > 0) return;
  Crossing crossing{place_of(x), {}};
  const auto direction = curve_->other_direction(x, before.tangent);
  for (const double sign : {1.0, -1.0}) {
    for (const double share : kAside) {
      if (!direction) break;
      const VectorXd aside = sign * *direction;
      const auto point = curve_->correct(x + share * options_.first_step * aside, aside, aside);
      if (!point) continue;
      crossing.arms.push_back(place_of(point->x));
      break;
    }
  }
  crossings_.push_back(std::move(crossing));
}

}  // namespace carnot::internal
