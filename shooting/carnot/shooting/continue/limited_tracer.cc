#include "carnot/shooting/continue/limited_tracer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/shooting/search/limited_finish.h"
#include "carnot/shooting/search/limited_problem.h"
#include "carnot/shooting/search/limited_search.h"

namespace carnot::internal {
namespace {

// The names of the limits that a path keeps to, in the order of time.
std::vector<std::string> contacts_of(const Geodesic& geodesic) {
  std::vector<std::pair<double, std::string>> contacts;
  for (const LimitReport& limit : geodesic.limits) {
    for (const auto& [begin, end] : limit.active) contacts.emplace_back(begin, limit.name);
  }
  std::sort(contacts.begin(), contacts.end());
  std::vector<std::string> names;
  names.reserve(contacts.size());
  for (auto& [begin, name] : contacts) names.push_back(std::move(name));
  return names;
}

// Of the extent of the path: how far from the secant a step may lead. Steps of 0.1 depart by 0.02
// or less where a vehicle's wheel, a trailer's hinge and a bicycle's wheel are limited more and
// more. Other branches that were reached by mistake were away by 0.065 and more.
constexpr double kFar = 0.02;

// The largest distance between the q of two paths, over the extent of the second one. q(i) are
// those at the i-th of the same times.
template <class First, class Second>
double departure(int intervals, int n, const First& first, const Second& second) {
  double apart = 0;
  double extent = 0;
  for (int i = 0; i <= intervals; ++i) {
    for (int j = 0; j < n; ++j) {
      apart = std::max(apart, std::abs(first(i)[j] - second(i)[j]));
      extent = std::max(extent, std::abs(second(i)[j] - second(0)[j]));
    }
  }
  return apart / extent;
}

double departure(const Knots& a, const Knots& b) {
  return departure(
      b.segments, b.dof, [&](int i) { return a.at(i); }, [&](int i) { return b.at(i); });
}

double departure(const Knots& a, const Path& b) {
  return departure(
      b.intervals,
      b.dof,
      [&](int i) { return a.at(i); },
      [&](int i) { return b.configuration(i); });
}

void go_on(const std::vector<double>& before, double ratio, std::vector<double>& x) {
  for (std::size_t j = 0; j < x.size(); ++j) x[j] += ratio * (x[j] - before[j]);
}

bool same_pieces(const std::optional<BoundExtremal>& a, const std::optional<BoundExtremal>& b) {
  const auto same = [](const Piece& one, const Piece& other) {
    return one.wall == other.wall && one.touches == other.touches && one.segments == other.segments;
  };
  return a && b &&
         std::equal(a->pieces.begin(), a->pieces.end(), b->pieces.begin(), b->pieces.end(), same);
}

// Every so many-th of the knots.
Knots thinned(const Knots& knots, int segments) {
  Knots thin{segments, knots.dof, {}};
  const int every = knots.segments / segments;
  for (int i = 0; i <= segments; ++i) {
    thin.z.insert(thin.z.end(), knots.at(i * every), knots.at(i * every) + 2 * knots.dof);
  }
  return thin;
}

// Moves a path along straight lines so that its fixed ends are those of the problem.
void move_ends(const BoundaryValueProblem& problem, Path& path) {
  const int n = path.dof;
  for (int j = 0; j < n; ++j) {
    const double first = problem.is_free_from(j) ? 0 : problem.from[j] - path.q[j];
    const double last =
        problem.is_free_to(j) ? 0 : problem.to[j] - path.configuration(path.intervals)[j];
    for (int i = 0; i <= path.intervals; ++i) {
      const double share = static_cast<double>(i) / path.intervals;
      path.configuration(i)[j] += (1 - share) * first + share * last;
    }
  }
}

}  // namespace

LimitedTracer::LimitedTracer(const ProblemLine& line,
                             const ContinuationOptions& options,
                             ContinuationReport& report)
    : line_(line), options_(options), report_(report) {
  finishing_.tolerance = options.tolerance;
  finishing_.samples = kIntervals + 1;
}

bool LimitedTracer::is_minimum(const LimitedProblem& shared, const Knots& knots) {
  constexpr double kMu = 1e-4;  // as where a search tells it, on a grid of the same size
  LimitedPath limited;
  limited.path = shared.path_through(knots);
  InteriorPointOptions interior = shared.interior;
  interior.first_mu = interior.last_mu = kMu;
  const InteriorPoint solved = interior_point(shared.problem, shared.walls, interior, limited);
  // A minimum that is elsewhere tells nothing of this one.
  return solved.converged && solved.minimum && departure(knots, limited.path) <= kFar;
}

std::optional<LimitedExtremal> LimitedTracer::solve_on(const LimitedProblem& shared,
                                                       const Knots& near,
                                                       int intervals) const {
  Candidate candidate;
  candidate.limited.path = shared.path_through(thinned(near, intervals));
  move_ends(shared.problem, candidate.limited.path);
  InteriorPointOptions interior = shared.interior;
  interior.first_mu = interior.last_mu = kFirstGridMu;
  if (!interior_point(shared.problem, shared.walls, interior, candidate.limited).converged) {
    return std::nullopt;
  }
  std::optional<LimitedExtremal> found =
      LimitedFinish(shared, finishing_).finish(std::move(candidate));
  // A path that is known on the grid alone counts where it is a minimum and meets a limit. Without
  // a limit to meet, an extremal would have been found beside it.
  const bool followed =
      found &&
      (found->geodesic.verification != Verification::kGrid ||
       (found->geodesic.label == Label::kLocallyMinimal && !contacts_of(found->geodesic).empty()));
  return followed ? std::move(found) : std::nullopt;
}

std::optional<LimitedTracer::Point> LimitedTracer::solve(double s, const Point& near) {
  constexpr double kSame = 1e-6;  // of the action
  constexpr int kSegments = 8;    // of shooting, where no limit is met
  const BoundaryValueProblem problem = line_.at(s);
  trouble_ = beyond_limit_at_end(problem);
  if (!trouble_.empty()) return std::nullopt;
  const LimitedProblem shared(problem, {near.geodesic});
  const LimitedFinish finish(shared, finishing_);
  Point point;
  const auto leads_to = [&](std::optional<LimitedExtremal> found) {
    if (!found) return false;
    const Knots knots = knots_of(found->geodesic.trajectory, kIntervals);
    found->geodesic.trajectory = {};
    point = {s, knots, std::move(found->pieces), std::move(found->geodesic)};
    return departure(near.knots, thinned(knots, near.knots.segments)) <= kFar;
  };
  if (near.pieces && leads_to(finish.with_contacts_of(*near.pieces))) {
    if (is_minimum(shared, point.knots)) point.geodesic.label = Label::kLocallyMinimal;
    return point;
  }
  if (contacts_of(near.geodesic).empty() &&
      leads_to(finish.without_contact(thinned(near.knots, kSegments)))) {
    return point;
  }
  // On coarse grids walls pin paths to nodes, and a shallow minimum may be lost there.
  std::optional<double> action;
  for (const int intervals : {kIntervals / 4, kIntervals / 2, kIntervals}) {
    if (near.knots.segments % intervals != 0) break;  // a start of few samples
    std::optional<LimitedExtremal> found = solve_on(shared, near.knots, intervals);
    if (!found) continue;
    if (leads_to(std::move(found))) return point;
    // The step is too long where two grids lead to the same place.
    const double here = point.geodesic.action;
    if (action && std::abs(here - *action) <= kSame * std::abs(here)) break;
    action = here;
  }
  return std::nullopt;
}

LimitedTracer::Point LimitedTracer::on_secant(const Point& a, const Point& b, double s) {
  Point point = b;
  const double ratio = (s - b.s) / (b.s - a.s);
  go_on(a.knots.z, ratio, point.knots.z);
  if (!same_pieces(a.pieces, b.pieces)) return point;
  for (std::size_t k = 0; k < point.pieces->pieces.size(); ++k) {
    const Piece& before = a.pieces->pieces[k];
    Piece& piece = point.pieces->pieces[k];
    go_on(before.z, ratio, piece.z);
    piece.end += ratio * (piece.end - before.end);
    piece.release += ratio * (piece.release - before.release);
  }
  return point;
}

void LimitedTracer::note_changes(Point before, const Point& after) {
  constexpr double kLocated = 1e-6;  // of the line
  while (contacts_of(before.geodesic) != contacts_of(after.geodesic)) {
    Point low = before;
    Point high = after;
    const std::vector<std::string> contacts = contacts_of(low.geodesic);
    while (high.s - low.s > kLocated) {
      const double s = 0.5 * (low.s + high.s);
      std::optional<Point> middle = solve(s, on_secant(high, low, s));
      if (!middle) break;
      (contacts_of(middle->geodesic) == contacts ? low : high) = std::move(*middle);
    }
    ContactChange change;
    change.s = 0.5 * (low.s + high.s);
    change.error = 0.5 * (high.s - low.s);
    change.before = contacts;
    change.after = contacts_of(high.geodesic);
    change.action = low.geodesic.action;
    report_.contact_changes.push_back(std::move(change));
    before = std::move(high);
  }
}

ContinuationStatus LimitedTracer::trace(const Geodesic& start) {
  constexpr double kSameAction = 1e-6;  // relative; of two answers of a grid
  constexpr double kGrow = 1.5;
  constexpr double kShrink = 0.4;
  // Arcs grow as roots of s where they begin: with longer steps a picture of them is made of gaps.
  constexpr double kLongest = 0.025;
  const double longest = std::min(options_.largest_step, kLongest);
  constexpr int kFewest = 64;  // intervals of samples that a start has
  const bool fine = (start.trajectory.t.size() - 1) % kIntervals == 0;
  here_.knots = knots_of(start.trajectory, fine ? kIntervals : kFewest);
  here_.geodesic = start;
  std::optional<Point> next = solve(0, here_);
  if (!next ||
      !(std::abs(next->geodesic.action - start.action) <= kSameAction * std::abs(start.action))) {
    return ContinuationStatus::kNotConverged;
  }
  here_ = std::move(*next);
  report_.points.push_back({0, 0, here_.geodesic});
  std::optional<Point> last;
  double step = std::min(options_.first_step, longest);
  while (here_.s < 1) {
    if (options_.progress && !options_.progress(here_.s)) return ContinuationStatus::kInterrupted;
    if (static_cast<int>(report_.points.size()) >= options_.max_points) {
      return ContinuationStatus::kMaxPoints;
    }
    const double s = here_.s + step >= 1 ? 1 : here_.s + step;
    next = solve(s, last ? on_secant(*last, here_, s) : here_);
    if (!next) {
      step = kShrink * (s - here_.s);
      if (step < options_.smallest_step) return ContinuationStatus::kStepTooSmall;
      continue;
    }
    note_changes(here_, *next);
    report_.points.push_back({s, 0, next->geodesic});
    last = std::exchange(here_, std::move(*next));
    step = std::min(kGrow * step, longest);
  }
  return ContinuationStatus::kReached;
}

}  // namespace carnot::internal
