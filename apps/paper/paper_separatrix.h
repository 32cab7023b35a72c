// The circle of the free vehicle and the motions that leave it, by quadrature.
//
// p_x = p_y = 0 stays so. Then, with delta = phi - theta, P = p_theta + p_phi constant, and
// w = p_theta, H is that of one degree of freedom, (delta, p_phi):
//
//   H = w^2 f + p_phi^2/(2 beta),   w = P - p_phi,   f = s/(2 (l^2 + alpha s)),  s = sin^2 delta.
//
// The circle theta = a t, p = (0, 0, a (l^2 + alpha), beta a) is its saddle delta = pi/2: P = a S,
// H = a^2 S/2, S = l^2 + alpha + beta. There H - a^2 S/2 = -(a l x)^2/2 + kappa eta^2/2 + ... with
// x = delta - pi/2, eta = p_phi - beta a, kappa = 1/beta + 1/(l^2 + alpha), so the growth rate is
// mu = a l sqrt(kappa). On any level H = E
//
//   delta'^2 = (2/beta) (E - f (P^2 - 2 beta E)),
//
// and on that of the saddle delta'^2 = a^2 S l^2 cos^2 delta / (beta (l^2 + alpha s)): heteroclinic
// from delta = pi/2 to 3 pi/2, where the vehicle drives backwards on a circle of the same radius,
// as fast and in the same sense. Its centre, the rear wheel, has moved.
#pragma once

namespace carnot::apps {

struct CircleMotion {
  double alpha = 1;
  double beta = 1;
  double length = 1;
  double turn = 1;  // a, the rate of theta

  [[nodiscard]] double total() const { return length * length + alpha + beta; }  // S
  [[nodiscard]] double kappa() const { return 1 / beta + 1 / (length * length + alpha); }
  [[nodiscard]] double growth_rate() const;  // mu
};

// Time on the separatrix from x = delta - pi/2 = `from` to `to`, 0 < from, to < pi.
double separatrix_time(const CircleMotion& motion, double from, double to);

// Time from x = `perturbation`, the momenta those of the circle, to the middle x = pi/2 of the way
// to the next circle. 0 < perturbation < pi/2. The way back and forth takes four times as long.
double halfway_time(const CircleMotion& motion, double perturbation);

// The distance between the centres of the circles that the separatrix joins.
double centre_shift(const CircleMotion& motion);

}  // namespace carnot::apps
