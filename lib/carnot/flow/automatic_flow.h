// A flow with constant steps for a wanted error, chosen by one cheap trial: for Gauss methods.
//
// On a step the increments L_i = h b_i f(U_i) sample the derivative of the collocation polynomial.
// Let a_k be its Legendre coefficients. For analytic f they fall geometrically, and the error of
// the step is of the size of the first coefficient that the quadrature misses, a_p with p = 2s the
// order: from one pair of low and one of high coefficients
//
//   e = a_high (a_high / a_low)^((p - high) / (high - low)).
//
// e falls like h^p, so if the trial with steps h_i says e_i, a run with steps h has the error
// sum_i e_i (h / h_i)^p. The trial solves its stages so loosely that the coefficients just show,
// and shortens its steps where they do not fall: it costs a fraction of the run. The stage
// iteration of the run stops at a change tied to the tolerance: what it leaves undone is smaller
// still, by the contraction of one more iteration. h is constant in the run, so it stays symplectic
// to that accuracy.
//
// The sum says nothing of how errors grow along the trajectory. If the run ends further from the
// trial than the looseness of the trial explains, a second run with shorter steps tells the error.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "carnot/flow/flow.h"
#include "carnot/flow/winding.h"
#include "carnot/step/runge_kutta.h"

namespace carnot {

// Enough Legendre coefficients to see them fall.
inline constexpr int kLeastSampled = 4;

// Estimated error of the step just done, from the decay of its Legendre coefficients. At least
// kLeastSampled stages.
template <class Stepper>
typename Stepper::Scalar step_error(const Stepper& step) {
  using T = typename Stepper::Scalar;
  const auto& tableau = step.tableau();
  const int s = tableau.stages();
  std::array<T, Stepper::kMaxStages> size;
  if constexpr (Stepper::kRows) {
    packed_sizes<Stepper::kSize, Stepper::kMaxStages>(
        tableau.legendre.data(), step.increments().data(), size.data());
  } else {
    for (int i = 0; i < s; ++i) {
      size[i] = T(0);
      for (int k = 0; k < Stepper::kSize; ++k) {
        T sum(0);
        for (int j = 0; j < s; ++j) sum += tableau.legendre(i, j) * step.increments()(k, j);
        size[i] = std::max(size[i], std::abs(sum));
      }
    }
  }
  const int first = std::max(0, s - 6);
  const T low = std::max(size[first], size[first + 1]);
  const T high = std::max(size[s - 2], size[s - 1]);
  const T at = T(s) - T(1.5);
  const T exponent = (T(tableau.order) - at) / (at - T(first) - T(0.5));
  // Its size is all that counts, and a power of doubles takes half an iteration.
  return low > T(0) ? high * T(std::pow(float(high / low), float(exponent))) : T(0);
}

// The largest distance that a component goes in the step just done, there and back.
template <class Stepper>
typename Stepper::Scalar distance_moved(const Stepper& step) {
  using T = typename Stepper::Scalar;
  if constexpr (Stepper::kRows) {
    return packed_distance<Stepper::kSize, Stepper::kMaxStages>(step.increments().data());
  } else {
    T most(0);
    for (int k = 0; k < Stepper::kSize; ++k) {
      T sum(0);
      for (int j = 0; j < step.tableau().stages(); ++j) sum += std::abs(step.increments()(k, j));
      most = std::max(most, sum);
    }
    return most;
  }
}

namespace automatic {

// Found on the vehicles and on heisenberg over six decades of the tolerance.
inline constexpr double kPessimism = 1.5;    // estimated over true error: 1.5 to 25
inline constexpr double kStop = 25;          // change of the last iteration over the tolerance
inline constexpr double kMargin = 8;         // tolerance over the error that is aimed at
inline constexpr double kLoose = 0.1;        // the same in the trial, over the length of a step
inline constexpr double kUnresolved = 1e-2;  // error of a trial step over its length: too long
inline constexpr double kShrink = 0.64;      // of the trial's steps
inline constexpr double kExplained = 4;      // distance of run and trial over kLoose steps
inline constexpr int kTrialIterations = 9;
inline constexpr double kFirst = 8;  // steps of the trial, at least
inline constexpr double kMostSteps = 1 << 24;
inline constexpr double kRoundOff = 50;  // tolerances below this times eps are out of reach
inline constexpr int kRunIterations = 100;
inline constexpr double kLongest = 1.0;  // steps of the run over those of the trial, at least
inline constexpr double kFiner = 1.2;    // steps of a confirming run over the last, at least
inline constexpr double kSafety = 1.1;   // on the steps that a difference asks for
inline constexpr double kFailed = 100;   // growth of errors assumed where a run failed
inline constexpr int kMostRuns = 5;

// A stepper that begins where `fresh` does. (A copy would copy its scratch.)
template <class Stepper>
Stepper beginner(const Stepper& fresh, int most_iterations) {
  Stepper stepper(fresh.system(), fresh.tableau());
  stepper.start_on(fresh.branch());
  stepper.only_iterate(most_iterations);
  return stepper;
}

template <class Stepper>
struct Trial {
  bool done = false;
  double error = 0;  // of steps of length `step`, summed
  double step = 0;
  double loose = 0;  // change that the stages were left with
  long evaluations = 0;
  State<double, Stepper::kDof> z;
};

template <class Stepper>
Trial<Stepper> trial(const Stepper& fresh,
                     double start,
                     double duration,
                     const State<double, Stepper::kDof>& initial) {
  Trial<Stepper> trial;
  trial.z = initial;
  Stepper stepper = beginner(fresh, kTrialIterations);
  stepper.extrapolate_cautiously();
  const int order = stepper.tableau().order;
  // The speed of z, as of the last step; at first that of the start.
  Vector<double, Stepper::kSize> rate;
  auto y = stepper.branch();
  ++trial.evaluations;
  if (phase_rate(stepper.system(), start, initial.value, y, rate) != RateStatus::kOk) return trial;
  double speed = largest_entry(rate);
  double t = start;
  double left = std::abs(duration);
  double h = left / kFirst;
  const double sign = duration < 0 ? -1 : 1;
  while (left > 0) {
    const double length = std::min(h, left);
    auto z = trial.z;
    stepper.stop_at(kLoose * speed * length);
    const StepReport report = stepper.step(t, sign * length, z);
    trial.evaluations += report.evaluations;
    const double moved = distance_moved(stepper);
    if (report.status == StepStatus::kOk) speed = moved / length;
    const double error = report.status == StepStatus::kOk ? step_error(stepper) : INFINITY;
    if (!(error <= kUnresolved * moved)) {
      trial.error *= std::pow(kShrink, order);
      h *= kShrink;
      if (left / h > kMostSteps) return trial;
      continue;
    }
    trial.error += length < h ? error * std::pow(h / length, order) : error;
    trial.loose = std::max(trial.loose, kLoose * moved);
    trial.z = z;
    t += sign * length;
    left = length < h ? 0 : left - length;
  }
  trial.step = h;
  trial.done = true;
  return trial;
}

}  // namespace automatic

// Advances z by `duration` with an error of about `tolerance` (max-norm of q and p at the end).
// `winding` knows the periods of the angles, which are kept small in the runs.
template <class Stepper>
AutomaticFlow automatic_flow(const Stepper& fresh,
                             double start,
                             double duration,
                             double tolerance,
                             State<double, Stepper::kDof>& z,
                             const Winding<Stepper::kDof>& winding = {}) {
  using namespace automatic;
  AutomaticFlow result;
  const double order = fresh.tableau().order;
  const auto trial = automatic::trial(fresh, start, duration, z);
  result.evaluations = trial.evaluations;
  if (!trial.done) return result;
  const double size = std::max(1.0, largest_entry(trial.z.value));
  if (tolerance < kRoundOff * std::numeric_limits<double>::epsilon() * size) return result;

  const auto run = [&](double count, double stop, State<double, Stepper::kDof>& end) {
    result.plan = StepPlan::equal(start, duration, std::max(1L, std::lround(std::ceil(count))));
    result.plan.stop = stop;
    Stepper stepper = beginner(fresh, kRunIterations);
    end = z;
    auto turns = winding;
    result.report = flow(stepper, result.plan, end, [&](long, const Stepper&, auto& node) {
      turns.fold(node);
      return true;
    });
    end = turns.unfolded(end);
    result.evaluations += result.report.evaluations;
    return result.report.completed() && all_finite(end.value);
  };
  const auto distance = [](const auto& a, const auto& b) {
    Vector<double, Stepper::kSize> difference;
    for (int k = 0; k < Stepper::kSize; ++k) difference[k] = a.value[k] - b.value[k];
    return largest_entry(difference);
  };

  const double aim = tolerance / kMargin;
  const double trial_count = std::abs(duration) / trial.step;
  double count =
      trial_count * std::max(kLongest, std::pow(trial.error / (kPessimism * aim), 1 / order));
  double stop = kStop * aim;
  State<double, Stepper::kDof> end = z;
  if (!(count <= kMostSteps)) return result;
  bool ok = run(count, stop, end);
  for (int i = 0; i < kMostRuns && !ok; ++i) ok = run(count *= kFiner, stop, end);
  result.error = tolerance;
  const double away = ok ? distance(end, trial.z) : INFINITY;
  if (!(away <= kExplained * trial.loose)) {
    double growth = ok ? away / trial.loose : kFailed;
    result.error = INFINITY;
    for (int i = 0; i < kMostRuns && !(result.error <= tolerance); ++i) {
      const auto before = end;
      const bool before_ok = ok;
      const double ratio = std::clamp(kSafety * std::pow(growth, 1 / order), kFiner, 2.0);
      const double stricter = std::max(growth, kStop);
      count *= ratio;
      stop /= stricter;
      if (!(count <= kMostSteps)) return result;
      ok = run(count, stop, end);
      growth = kFailed;
      if (!before_ok || !ok) continue;
      // What is left of the difference in the finer of the two runs.
      result.error = distance(before, end) * std::max(std::pow(ratio, -order), 1 / stricter);
      growth = std::max(1.0, result.error / tolerance);
    }
    if (!(result.error <= tolerance)) return result;
  }
  z = end;
  result.reached = true;
  return result;
}

}  // namespace carnot
