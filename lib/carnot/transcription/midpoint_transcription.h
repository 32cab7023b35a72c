// The direct midpoint transcription of a boundary-value problem, interval by interval.
//
// With qm = (q0 + q1)/2, v = (q1 - q0)/h and F_d = h [L - lambda.G v](qm, v), a path that makes
// sum F_d stationary subject to G(qm) v = 0 satisfies exactly the midpoint rule on the index-1
// Hamiltonian system (Marsden & West, Acta Numerica 2001, discrete Legendre transform):
//
//   p0 = -D1 F_d = F_v - h F_q / 2,      p1 = D2 F_d = F_v + h F_q / 2,
//
// so a relaxation of the path needs no guess of p0 and yields a discrete costate. Rows of G that
// are dependent leave lambda undetermined: then G is a projector, with P = I - G the term
// -lambda'P lambda/2 is added to L, and that makes P lambda = 0.
//
// The scene gives M, G and V with their derivatives; what is made of them is compiled once.
#pragma once

#include "carnot/transcription/transcription_functions.h"

namespace carnot {

// The least-squares form of one interval at (qm, v): r = U v (n), c = G v (k) and V, stacked in
// `terms`. U is the upper triangle with v'U'U v = v'M v + gamma |G v|^2, where gamma makes both
// terms of equal size, so that singular M is allowed, too. The Jacobian, unless null, is by (qm,
// v), row-major (n + k + 1) x 2n. False where M is not positive definite on the kernel of G.
[[nodiscard]] bool midpoint_terms(const TranscriptionFunctions& functions,
                                  const void* system,
                                  const double* qm,
                                  const double* v,
                                  double* terms,
                                  double* jacobian);

// Gradient and, unless null, Hessian of the discrete Lagrangian F_d(q0, q1, lambda) = h l(qm, v)
// with respect to x = (q0, q1, lambda), which has m = 2n + k entries; the Hessian is m x m.
void discrete_lagrangian(const TranscriptionFunctions& functions,
                         const void* system,
                         double h,
                         const double* x,
                         double* gradient,
                         double* hessian);

// The same two for kTranscriptionLanes intervals side by side: number i of interval l is at
// i * kTranscriptionLanes + l of each array. The numbers of an interval do not depend on what
// stands beside it. False where one fails; its terms are NaN then. Four to six times as fast as one
// by one.
[[nodiscard]] bool packed_midpoint_terms(const TranscriptionFunctions& functions,
                                         const void* system,
                                         const double* qm,
                                         const double* v,
                                         double* terms,
                                         double* jacobian);
void packed_discrete_lagrangian(const TranscriptionFunctions& functions,
                                const void* system,
                                double h,
                                const double* x,
                                double* gradient,
                                double* hessian);

// With a gauge: the multipliers at (q, p), for which C lambda = -C p, C = G the projector.
void gauged_multipliers(const TranscriptionFunctions& functions,
                        const void* system,
                        const double* q,
                        const double* p,
                        double* lambda);

}  // namespace carnot
