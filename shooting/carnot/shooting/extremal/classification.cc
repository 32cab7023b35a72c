#include "carnot/shooting/extremal/classification.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "carnot/shooting/extremal/conjugate_times.h"
#include "carnot/shooting/extremal/legendre.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/survey.h"

namespace carnot::internal {
namespace {

// Samples that tell the largest value between them. With 3 of them the largest steering angle of
// sideways parking is 1.4e-5 too small, and with 9 it is right to 1e-10.
constexpr int kMostInterpolated = 9;

// How well the phases at T are known. p0 is as good as the end point error is relative to the
// distance.
double doubt_of(const BoundaryValueProblem& problem, const Geodesic& geodesic) {
  constexpr double kLeast = 1e-8;
  constexpr double kMargin = 100;
  if (geodesic.verification == Verification::kKnots) return kLeast;
  const double distance = distance_between_ends(problem);
  return distance > 0 ? std::max(kLeast, kMargin * geodesic.endpoint_error / distance) : kLeast;
}

void add_extremes(const BoundaryValueProblem& problem,
                  const Knots& knots,
                  long steps,
                  Geodesic& geodesic) {
  if (problem.dynamics.info.extremes.empty()) return;
  set_extremes(problem, samples_of(problem, knots, steps, 2 * steps + 1).q, geodesic);
}

// The polynomial through `count` values at 0, 1, 2, ..., at x: Neville's scheme.
double interpolated(const double* values, int count, double x) {
  std::array<double, kMostInterpolated> column{};
  std::copy_n(values, count, column.begin());
  for (int degree = 1; degree < count; ++degree) {
    for (int i = 0; i + degree < count; ++i) {
      column[i] = ((i + degree - x) * column[i] + (x - i) * column[i + 1]) / degree;
    }
  }
  return column[0];
}

// The largest |value| of a smooth function at and between equally spaced samples.
double largest_size(const std::vector<double>& values) {
  // Ternary search: (2/3)^30 of an interval is 5e-6 of it, and the value is off by the square.
  constexpr int kThirds = 30;
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const int samples = static_cast<int>(values.size());
  const auto largest = std::max_element(values.begin(), values.end(), smaller);
  const int top = static_cast<int>(largest - values.begin());
  const int count = std::min(kMostInterpolated, samples);
  const int first = std::clamp(top - count / 2, 0, samples - count);
  const auto size = [&](double x) {
    return std::abs(interpolated(values.data() + first, count, x - first));
  };
  double low = std::max(top - 1, 0);
  double high = std::min(top + 1, samples - 1);
  for (int i = 0; i < kThirds; ++i) {
    const double third = (high - low) / 3;
    if (size(low + third) < size(high - third)) {
      low += third;
    } else {
      high -= third;
    }
  }
  return std::max(std::abs(*largest), size(0.5 * (low + high)));
}

// Whether T is conjugate because the extremal is one of a continuum. Then a step along each
// direction that does not move the end leads, once corrected, to another extremal; at an isolated
// fold the correction leads back. Nothing where some directions do the one and some the other.
std::optional<int> family_dimension(const BoundaryValueProblem& problem,
                                    const Geodesic& geodesic,
                                    int conjugate,
                                    int corank) {
  constexpr double kStep = 1e-3;  // relative to p0
  constexpr double kTolerance = 1e-10;
  const long steps = geodesic.plan.count / 2;
  std::vector<double> z = geodesic.from;
  z.insert(z.end(), geodesic.p0.begin(), geodesic.p0.end());
  const std::vector<double> x = start_unknowns(problem, z.data());
  const auto tangent = end_point_tangent(problem, x, problem.time, steps, z);
  if (!tangent) return std::nullopt;
  const Units units(problem, x);
  const Eigen::MatrixXd kernel = kernel_of(units, *tangent, 1e-8);
  if (kernel.cols() != conjugate + corank) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(geodesic.p0.size());
  const Eigen::Map<const Eigen::VectorXd> p(x.data(), n);
  const double distance = distance_between_ends(problem);
  const double part = kTolerance * std::min(1.0, distance);
  int moved = 0;
  for (Eigen::Index j = 0; j < kernel.cols(); ++j) {
    const double step = kStep * units.size(p) / units.size(kernel.col(j));
    const Eigen::VectorXd aside = p + step * kernel.col(j);
    std::vector<double> trial(aside.data(), aside.data() + n);
    Eigen::MatrixXd there;
    const double error = correct(problem, steps, 1e-3 * part, trial, there);
    const Eigen::Map<const Eigen::VectorXd> reached(trial.data(), n);
    if (error <= part && units.size(reached - p) > 0.5 * kStep * units.size(p)) ++moved;
  }
  if (moved == kernel.cols()) return conjugate;
  return moved == 0 ? std::optional<int>(0) : std::nullopt;
}

// Whether the path passes a singularity of the coordinates. Some paths that move only one
// coordinate do. The tangent flow has a pole there, and the numbers beyond the pole do not show it.
bool passes_singularity(const BoundaryValueProblem& problem, const Extremal& extremal) {
  if (problem.dynamics.calls.chart == nullptr) return false;
  const long steps = extremal.geodesic.plan.count;
  const Trajectory path = samples_of(problem, extremal.knots, steps, steps + 1);
  const auto parted = [&](const std::vector<double>& a, const std::vector<double>& b) {
    return !same_chart(problem.dynamics, a.data(), b.data());
  };
  return std::adjacent_find(path.q.begin(), path.q.end(), parted) != path.q.end();
}

ConjugateTimes conjugate_times_along(const BoundaryValueProblem& problem,
                                     const Extremal& extremal,
                                     ConjugateTimesOptions options) {
  if (passes_singularity(problem, extremal)) return {};
  options.doubt = doubt_of(problem, extremal.geodesic);
  const long steps = extremal.geodesic.plan.count / 2;
  if (!satisfies_legendre(problem, extremal.knots, steps)) {
    ConjugateTimes none;
    none.legendre = false;
    return none;
  }
  return conjugate_times(problem, extremal.knots, steps, options);
}

// Morse index, label, abnormal and family dimension.
void set_label(const BoundaryValueProblem& problem,
               const ConjugateTimes& conjugate,
               Geodesic& geodesic) {
  if (conjugate.corank) geodesic.abnormal = *conjugate.corank > problem.dynamics.forced;
  if (!conjugate.legendre) geodesic.label = Label::kNotMinimal;
  if (!conjugate.known) return;
  // Where the target is free it is not T as a conjugate time that counts, but what moving the
  // target does to the action.
  const int degenerate = conjugate.target ? conjugate.target->nullity : conjugate.at_end;
  const auto inner = static_cast<int>(conjugate.times.size()) - conjugate.at_end;
  const int index = inner + (conjugate.target ? conjugate.target->index : 0);
  geodesic.morse_index = index;
  geodesic.family_dimension = 0;
  if (degenerate > 0) {
    geodesic.family_dimension.reset();
    if (geodesic.verification == Verification::kSingle) {
      geodesic.family_dimension =
          family_dimension(problem, geodesic, degenerate, *conjugate.corank);
    }
  }
  if (geodesic.family_dimension.value_or(0) > 0) {
    geodesic.label = Label::kSingular;
  } else if (index > 0) {
    // On an abnormal extremal the index depends on the multipliers: a minimum may be conjugate with
    // some of them (Agrachev & Sachkov, Control Theory from the Geometric Viewpoint, 2004, ch. 20).
    if (!geodesic.abnormal.value_or(false)) geodesic.label = Label::kConjugatePassed;
  } else if (degenerate == 0) {
    geodesic.label = Label::kLocallyMinimal;
  }
}

}  // namespace

void set_extremes(const BoundaryValueProblem& problem,
                  const std::vector<std::vector<double>>& nodes,
                  Geodesic& geodesic) {
  for (const Extreme& extreme : problem.dynamics.info.extremes) {
    std::vector<double> values;
    values.reserve(nodes.size());
    for (const auto& q : nodes) values.push_back(extreme.value(q.data()));
    geodesic.extremes.emplace_back(extreme.name, largest_size(values));
  }
}

const ConjugateTimes& conjugate_times_of(const BoundaryValueProblem& problem, Extremal& extremal) {
  if (!extremal.conjugate) extremal.conjugate = conjugate_times_along(problem, extremal, {});
  return *extremal.conjugate;
}

void label(const BoundaryValueProblem& problem, Extremal& extremal) {
  ConjugateTimesOptions options;
  options.precision = 1;
  add_extremes(problem, extremal.knots, extremal.geodesic.plan.count, extremal.geodesic);
  set_label(problem, conjugate_times_along(problem, extremal, options), extremal.geodesic);
}

void complete(const BoundaryValueProblem& problem, long samples, Extremal& extremal) {
  Geodesic& geodesic = extremal.geodesic;
  if (geodesic.label == Label::kAbnormal) return;
  const long steps = geodesic.plan.count;
  add_extremes(problem, extremal.knots, steps, geodesic);
  if (samples > 0) geodesic.trajectory = samples_of(problem, extremal.knots, steps, samples);
  const ConjugateTimes& conjugate = conjugate_times_of(problem, extremal);
  if (conjugate.known) geodesic.conjugate_times = conjugate.times;
  set_label(problem, conjugate, geodesic);
}

}  // namespace carnot::internal
