#include "carnot/shooting/extremal/conjugate_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "carnot/shooting/extremal/step_maps.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/lagrangian_plane.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/units.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kFarScale = 100;  // of scales along a path: phases of 1e-4 still keep their digits

// For a plane (X / c, P c): what c is to be multiplied by for X and P to be of one size. Where one
// of them vanishes, so much as loses no digits.
double even_factor(const MatrixXd& plane) {
  constexpr double kMost = 1e8;
  const auto n = plane.cols();
  const double ratio = plane.topRows(n).norm() / plane.bottomRows(n).norm();
  return std::sqrt(std::clamp(ratio, 1 / kMost, kMost));
}

void scale_plane(double by, MatrixXd& plane) {
  const auto n = plane.cols();
  plane.topRows(n) /= by;
  plane.bottomRows(n) *= by;
}

// A phase point and the plane over it, in the units of a short extremal and balanced coordinates
// (S^-1 X / c; S'P c). The scale c is another one where X and P are no longer of one size.
struct Frame {
  double t = 0;
  std::vector<double> z;
  MatrixXd plane;
  VectorXd phases;
  double phi = 0;    // their sum, by multiples of 2 pi a continuous argument of det W
  double scale = 1;  // c
};

class Planes {
 public:
  Planes(
      const Dynamics& dynamics, const Units& units, const MatrixXd& s, int corank, double precision)
      : dynamics_(dynamics),
        units_(units),
        balance_{s, lu_inverse(s)},
        corank_(corank),
        precision_(precision),
        doubt_(kPlaneRoundOff * balance_.s.norm() * balance_.inverse.norm()) {}

  // The frame at time t, in as many steps of the method as det W needs to be followed. False when
  // a step fails or W turns too fast.
  [[nodiscard]] bool advance(const Frame& from,
                             double t,
                             Frame& to,
                             int halvings = kMostHalvings) const {
    StepMap step{from.z, {}};
    return take_step(dynamics_, units_, from.t, t - from.t, step) &&
           carry(from, t, std::move(step), to) &&
           (follows(from, to) || advance_by_halves(from, t, to, halvings));
  }
  // The same from the beginning of step i to its end.
  [[nodiscard]] bool advance(const Frame& from, const JoinedSteps& steps, long i, Frame& to) const {
    return take(from, steps, i, to) &&
           (follows(from, to) || advance_by_halves(from, steps.end(i), to, kMostHalvings));
  }

  // N at a frame, as a real number that is near an integer; phases nearer to zero than `tolerance`
  // have not passed it.
  [[nodiscard]] double count(const Frame& frame, double tolerance = 0) const {
    double sum = 0;
    for (Eigen::Index j = corank_; j < frame.phases.size(); ++j) {
      const double theta = frame.phases[j];
      sum += theta < tolerance ? theta + kTurn : theta;
    }
    return (frame.phi - sum) / kTurn;
  }
  // How many phases, but for those of the corank, are nearer to zero than `tolerance`.
  [[nodiscard]] int near_zero(const Frame& frame, double tolerance) const {
    int number = 0;
    for (Eigen::Index j = corank_; j < frame.phases.size(); ++j) {
      if (std::abs(frame.phases[j]) < tolerance) ++number;
    }
    return number;
  }
  // Gives a frame another scale. That changes the phases, but none of them passes zero on the way
  // from one scale to another, so N stays.
  void set_scale(double scale, Frame& frame) const {
    const double passed = std::round(count(frame));
    scale_plane(scale / frame.scale, frame.plane);
    frame.plane = orthonormal(frame.plane);
    frame.scale = scale;
    frame.phases = phases_of(frame.plane);
    frame.phi = kTurn * passed;
    for (Eigen::Index j = corank_; j < frame.phases.size(); ++j) {
      const double theta = frame.phases[j];
      frame.phi += theta < 0 ? theta + kTurn : theta;
    }
  }

  // The scales at `steps` equal steps for which X and P are of one size, but for times where one of
  // them vanishes and soon does no more: medians over a part of the path. Nothing where a step
  // fails.
  [[nodiscard]] std::vector<double> typical_scales(Frame frame, const JoinedSteps& steps) const;

  // Whether a phase is so near to zero that round-off may have put it on the wrong side.
  [[nodiscard]] bool ambiguous(const Frame& frame) const { return near_zero(frame, doubt_) > 0; }
  [[nodiscard]] double doubt() const { return doubt_; }
  // Of the plane of a frame, with rows in the units of the scene; see conjugate_times.h.
  [[nodiscard]] TargetForm form_at(const Frame& frame,
                                   const BoundaryValueProblem& problem,
                                   double tolerance) const;

  // The time in (a.t, t] at which the count first exceeds `target`, by bisection.
  [[nodiscard]] double locate(const Frame& a, double t, double target) const {
    double low = a.t;
    double high = t;
    Frame middle;
    constexpr int kBisections = 60;
    for (int i = 0; i < kBisections && high - low > precision_ * high; ++i) {
      const double centre = 0.5 * (low + high);
      if (!advance(a, centre, middle)) break;
      (count(middle) > target + 0.5 ? high : low) = centre;
    }
    return 0.5 * (low + high);
  }

 private:
  // Carries a frame by a step to time t, or by step i of some.
  [[nodiscard]] bool carry(const Frame& from, double t, StepMap step, Frame& to) const {
    to.t = t;
    to.z = std::move(step.z);
    to.scale = from.scale;
    to.plane = image_of(step.map, balance_, to.scale, from.plane);
    if (!to.plane.allFinite()) return false;
    to.phases = phases_of(to.plane);
    to.phi = from.phi + std::remainder(to.phases.sum() - from.phases.sum(), kTurn);
    return true;
  }
  [[nodiscard]] bool take(const Frame& from, const JoinedSteps& steps, long i, Frame& to) const {
    StepMap step;
    return steps.read(i, step) && carry(from, steps.end(i), std::move(step), to);
  }
  // Whether det W turned so little from one frame to the next that its argument is continuous.
  [[nodiscard]] static bool follows(const Frame& from, const Frame& to) {
    return std::abs(to.phi - from.phi) < kLargestTurn;
  }
  [[nodiscard]] bool advance_by_halves(const Frame& from, double t, Frame& to, int halvings) const {
    Frame middle;
    return halvings > 0 && advance(from, 0.5 * (from.t + t), middle, halvings - 1) &&
           advance(middle, t, to, halvings - 1);
  }

  static constexpr int kMostHalvings = 30;
  static constexpr double kLargestTurn = 0.8;  // of det W in one step; 2 pi more would go unseen

  const Dynamics& dynamics_;
  const Units& units_;
  Balance balance_;
  int corank_;
  double precision_;
  double doubt_;
};

std::vector<double> Planes::typical_scales(Frame frame, const JoinedSteps& joined) const {
  constexpr long kParts = 16;
  const long steps = joined.count();
  std::vector<double> scales;
  for (long i = 0; i < steps; ++i) {
    Frame next;
    if (!take(frame, joined, i, next)) return {};
    set_scale(next.scale * even_factor(next.plane), next);
    scales.push_back(next.scale);
    frame = std::move(next);
  }
  std::vector<double> medians;
  for (long i = 0; i < steps; ++i) {
    const long first = std::max(0L, i - steps / (2 * kParts));
    const long last = std::min(steps, i + steps / (2 * kParts) + 1);
    std::vector<double> part(scales.begin() + first, scales.begin() + last);
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(part.begin(), middle, part.end());
    medians.push_back(*middle);
  }
  return medians;
}

TargetForm Planes::form_at(const Frame& frame,
                           const BoundaryValueProblem& problem,
                           double tolerance) const {
  const int n = dynamics_.dof;
  MatrixXd x = product(balance_.s, frame.plane.topRows(n));
  MatrixXd p = product(balance_.inverse, frame.plane.bottomRows(n));
  // The scales, not the norms of x and p: at a conjugate time all of x may vanish, and its sign is
  // then that of a rounding error.
  x /= balance_.s.norm();
  p /= balance_.inverse.norm();
  MatrixXd conditions(n, n);
  MatrixXd fixed = MatrixXd::Zero(n, n);  // a row of zeros for each free coordinate
  std::vector<int> free;
  for (int j = 0; j < n; ++j) {
    conditions.row(j) = problem.is_free_to(j) ? p.row(j) : x.row(j);
    if (problem.is_free_to(j)) free.push_back(j);
    if (!problem.is_free_to(j)) fixed.row(j) = x.row(j);
  }
  const auto vanish = [&](const VectorXd& values) {
    return static_cast<int>((values.array() <= tolerance).count());
  };
  TargetForm form;
  form.nullity = vanish(right_singular(conditions).values);
  const RightSingular still = right_singular(fixed);
  const MatrixXd kept = still.vectors.rightCols(vanish(still.values));
  MatrixXd moves(static_cast<int>(free.size()), kept.cols());
  MatrixXd pulls = moves;
  for (std::size_t j = 0; j < free.size(); ++j) {
    moves.row(static_cast<int>(j)) = x.row(free[j]) * kept;
    pulls.row(static_cast<int>(j)) = p.row(free[j]) * kept;
  }
  const MatrixXd q = transposed_product(moves, pulls);
  const VectorXd values = symmetric_eigen(0.5 * (q + q.transpose())).values;
  form.index = static_cast<int>((values.array() < -tolerance).count());
  const auto reached = right_singular(moves.transpose()).values;
  form.index += vanish(reached);
  return form;
}

// The plane of the start: vertical, but for what is free there.
Frame first_frame(const BoundaryValueProblem& problem, const Knots& knots) {
  const int n = knots.dof;
  Frame frame;
  frame.z = {knots.at(0), knots.at(0) + 2 * n};
  frame.plane = MatrixXd::Zero(2 * n, n);
  for (int j = 0; j < n; ++j) frame.plane(start_index(problem, j), j) = 1;
  frame.phases = phases_of(frame.plane);
  for (const double angle : frame.phases) frame.phi += angle < 0 ? angle + kTurn : angle;
  return frame;
}

// A typical graph from `begin` T to `end` T. Of the graphs with the smallest kernel it is the
// middle one by regularity: near a time where X or P is singular, the balance would make a phase
// turn too fast to be seen.
std::optional<Graph> typical_graph(double begin,
                                   double end,
                                   bool scaled,
                                   const BoundaryValueProblem& problem,
                                   const Knots& knots,
                                   const JoinedSteps& steps) {
  MatrixXd plane = first_frame(problem, knots).plane;
  double scale = 1;
  std::vector<Graph> graphs;
  StepMap step;
  for (long i = 0; i < steps.count() && (i == 0 || steps.end(i) <= end * problem.time); ++i) {
    if (!steps.read(i, step)) return std::nullopt;
    scale_plane(1 / scale, plane);
    plane = product(step.map, plane);
    scale_plane(scale, plane);
    if (scaled) {
      const double by = even_factor(plane);
      scale_plane(by, plane);
      scale *= by;
    }
    plane = orthonormal(plane);
    if (steps.end(i) < begin * problem.time) continue;
    Graph next = graph_of(plane);
    if (next.balance.allFinite()) graphs.push_back(std::move(next));
  }
  if (graphs.empty()) return std::nullopt;
  // A conjugate time that is met by chance shows a kernel at this time only.
  std::sort(graphs.begin(), graphs.end(), [](const Graph& one, const Graph& other) {
    return std::pair(one.kernel, one.regularity) < std::pair(other.kernel, other.regularity);
  });
  const auto typical = std::count_if(graphs.begin(), graphs.end(), [&](const Graph& graph) {
    return graph.kernel == graphs.front().kernel;
  });
  return graphs[typical / 2];
}

// The balance is taken before T/2, a time that is special to symmetric extremals. A path may leave
// an abnormal one later than that, exponentially for example. So where there is a kernel, a late
// time is tried, too.
std::optional<Graph> balance_of(double fraction,
                                bool scaled,
                                const BoundaryValueProblem& problem,
                                const Knots& knots,
                                const JoinedSteps& steps) {
  constexpr double kLate = 0.9;
  auto graph = typical_graph(0.5 * fraction, fraction, scaled, problem, knots, steps);
  if (!graph || graph->kernel == 0) return graph;
  auto late = typical_graph(kLate, 1, scaled, problem, knots, steps);
  return late && late->kernel < graph->kernel ? late : graph;
}

// Whether a kernel along the path can be told from small numbers. On a path of extent d, directions
// that take s brackets move by d^(2s - 2) only. Five brackets and d = 0.05 are still above
// round-off.
bool tells_kernels(const Knots& knots) {
  constexpr double kLeastExtent = 0.05;
  double extent = 0;
  for (int i = 1; i <= knots.segments; ++i) {
    for (int k = 0; k < knots.dof; ++k) {
      extent = std::max(extent, std::abs(knots.at(i)[k] - knots.at(0)[k]));
    }
  }
  return extent >= kLeastExtent;
}

// One pass, balanced by what is before `fraction` T; where `scaled`, with scales that change along
// the path.
ConjugateTimes follow(double fraction,
                      bool scaled,
                      const BoundaryValueProblem& problem,
                      const Units& units,
                      const Knots& knots,
                      const JoinedSteps& steps,
                      const ConjugateTimesOptions& options) {
  const int n = problem.dynamics.dof;
  ConjugateTimes result;
  const std::optional<Graph> graph = balance_of(fraction, scaled, problem, knots, steps);
  const int known = problem.dynamics.forced;  // momenta along Dh move nothing
  if (!graph || (graph->kernel > known && !units.scaled() && !tells_kernels(knots))) return result;
  result.corank = graph->kernel;
  if (graph->kernel == n) return result;
  const Planes planes(problem.dynamics, units, graph->balance, graph->kernel, options.precision);
  Frame frame = first_frame(problem, knots);
  std::vector<double> scales;
  if (scaled) {
    scales = planes.typical_scales(frame, steps);
    if (scales.empty()) return result;
    frame.scale = scales.front();  // the directions of q and of p at the start have the same phases
  }
  Frame clear = frame;  // the last frame whose count is beyond doubt
  int counted = 0;
  const auto count_to = [&](int count, const Frame& until) {
    for (; counted < count && result.times.size() < options.most; ++counted) {
      result.times.push_back(planes.locate(clear, until.t, counted));
    }
    return count == counted || result.times.size() == options.most;
  };
  for (long i = 0; i < steps.count(); ++i) {
    Frame next;
    if (!planes.advance(frame, steps, i, next)) return result;
    frame = std::move(next);
    if (scaled && !planes.ambiguous(frame)) {
      const double change = scales[i] / frame.scale;
      if (change > kFarScale || change < 1 / kFarScale) planes.set_scale(scales[i], frame);
    }
    if (i + 1 == steps.count() || planes.ambiguous(frame)) continue;
    if (!count_to(static_cast<int>(std::lround(planes.count(frame))), frame)) return result;
    clear = frame;
    if (result.times.size() == options.most) {
      result.known = true;
      return result;
    }
  }
  if (planes.doubt() > options.doubt) return result;
  result.at_end = planes.near_zero(frame, options.doubt);
  const double tolerance = result.at_end > 0 ? options.doubt : 0;
  if (!count_to(static_cast<int>(std::lround(planes.count(frame, tolerance))), frame))
    return result;
  const auto at_end = std::min<std::size_t>(result.at_end, options.most - result.times.size());
  result.times.insert(result.times.end(), at_end, problem.time);
  if (problem.has_free_target()) {
    if (graph->kernel > 0) return result;  // not all movements of the target are possible then
    result.target = planes.form_at(frame, problem, std::max(options.doubt, planes.doubt()));
  }
  result.known = true;
  return result;
}

// A phase that makes a whole turn within one step goes unseen: two passes, of other steps and
// another balance, must agree. Each joins two steps of the next one, so that the first two are made
// of the same flow.
ConjugateTimes agreed(bool scaled,
                      const BoundaryValueProblem& problem,
                      const Units& units,
                      const Knots& knots,
                      long steps,
                      const ConjugateTimesOptions& options) {
  constexpr int kDoublings = 4;
  constexpr std::array kFractions{0.43, 0.31};
  const long per_segment = std::max(1L, (steps + knots.segments - 1) / knots.segments);
  ConjugateTimes coarse;
  for (int i = 1; i <= kDoublings; ++i) {
    StepMaps maps(problem, units, knots, per_segment << i);
    const auto pass = [&](int number, int together) {
      const JoinedSteps joined(maps, together);
      return follow(kFractions[number % 2], scaled, problem, units, knots, joined, options);
    };
    if (i == 1) coarse = pass(0, 2);
    ConjugateTimes fine = pass(i, 1);
    if (coarse.known && fine.known && coarse.times.size() == fine.times.size() &&
        coarse.corank == fine.corank) {
      return fine;
    }
    coarse = std::move(fine);
  }
  coarse.known = false;
  coarse.times.clear();
  return coarse;
}

}  // namespace

ConjugateTimes conjugate_times(const BoundaryValueProblem& problem,
                               const Knots& knots,
                               long steps,
                               const ConjugateTimesOptions& options) {
  const Units units(problem, start_unknowns(problem, knots.at(0)));
  ConjugateTimes found = agreed(false, problem, units, knots, steps, options);
  if (!found.known) found = agreed(true, problem, units, knots, steps, options);
  return found;
}

}  // namespace carnot::internal
