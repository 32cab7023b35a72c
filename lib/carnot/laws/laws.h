// What integration must keep, measured on Dynamics: order, symplectic form, time reversal, energy,
// constraints.
//
// Pure functions of a Dynamics and a start; they print nothing and decide nothing (method_audit.h
// does). Defects are relative, so that one tolerance serves all scenes; |z| is the max-norm. What
// could not be measured, because a step failed, is NaN.
#pragma once

#include <limits>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/numerics/line_fit.h"

namespace carnot {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// z = (q, p) at time t, on the manifold where there are holonomic constraints.
struct PhaseStart {
  double t = 0;
  std::vector<double> z;
};

// A run to compare with.
struct ReferenceRun {
  PhaseStart start;
  double duration = 0;
  std::vector<double> end;                                 // empty where no run completed
  double error = std::numeric_limits<double>::infinity();  // estimate, relative to max(1, |end|)
};

// By `accurate`, a Dynamics of high order: steps are halved until that changes no more than
// round-off, or until `most_steps` are reached.
ReferenceRun reference_run(const Dynamics& accurate,
                           const PhaseStart& start,
                           double duration,
                           long most_steps);

// The slope of log(error) over log(step).
struct OrderLaw {
  LineFit fit;
  // Points of the fit, coarse to fine.
  std::vector<double> steps;
  std::vector<double> errors;
};

// The error at the end, relative to max(1, |z|). The ladder of steps begins where it falls below a
// ceiling and ends above the plateau of round-off and of the reference's own error, each rung about
// a factor 10 in the error and at most 2 in the step. The line is that of the finest points.
OrderLaw measure_order(const Dynamics& dynamics, const ReferenceRun& reference);

// max-norm of M'JM - J over max(1, |M|^2), |M| the Frobenius norm. With holonomic constraints on
// the tangent space of {h = 0, Dh q' = 0} at the start alone: of P'(M'JM - J)P, P its projector.
double measure_symplecticity(const Dynamics& dynamics,
                             const PhaseStart& start,
                             double step,
                             long steps);

struct ReversalLaw {
  // Steps of h, then of -h: |z - z0| over max(1, |z|) max(1, |M|), |M| how much the run enlarges.
  double adjoint = kNotMeasured;
  // The same for h, flip p, h, flip p. NaN where (q, p) -> (q, -p) is no reversal of the scene.
  double mirrored = kNotMeasured;
};

ReversalLaw measure_reversal(const Dynamics& dynamics,
                             const PhaseStart& start,
                             double step,
                             long steps);

// The error H - H0, or H - H0 - integral of H_t where H depends on time, over a long run. A
// symplectic method keeps it bounded: its largest value comes early and it forgets the time.
struct EnergyLaw {
  FlowReport report;
  long steps = 0;
  double round_off = kNotMeasured;    // what a random walk of rounding errors makes of H
  double largest = kNotMeasured;      // max |error| over the nodes
  double growth = kNotMeasured;       // the same over that of the first tenth
  double correlation = kNotMeasured;  // of the error with time; NaN where H depends on time
  double drift = kNotMeasured;        // change of the fitted line over the run / largest; or NaN
  double constraint_error = kNotMeasured;  // max |g(q, q')| / max(1, |q'|), stages and nodes
  double holonomic_error = kNotMeasured;   // max of |h| and |Dh q'| / max(1, |q'|), nodes
};

EnergyLaw measure_energy(const Dynamics& dynamics,
                         const PhaseStart& start,
                         double step,
                         long steps,
                         const Progress& progress);

// max |g(q_mid).(q1 - q0)/h| / max(1, |v|), q_mid the middle of two nodes, v their difference
// quotient: holds for the midpoint rule, and not by construction. NaN without a transcription.
double measure_midpoint_constraint(const Dynamics& dynamics,
                                   const PhaseStart& start,
                                   double step,
                                   long steps);

}  // namespace carnot
