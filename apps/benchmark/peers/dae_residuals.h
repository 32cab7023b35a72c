// The trajectories of `carnot benchmark` as differential-algebraic equations of index 1, by hand.
//
// With H = p.v - v.v/2 + V + lambda.G v the unknowns are u = (q, p, v, lambda) and
//
//   q' - v = 0,   p' + grad V + grad_q (lambda.G v) = 0,   p - v + G'lambda = 0,   G v = 0.
#pragma once

#include <array>
#include <cmath>

#include "benchmark/benchmark_rates.h"

namespace carnot::apps {

// n coordinates, k constraints; the multiplier of the start is known on paper.
template <int n, int k>
struct DaeSizes {
  static constexpr int kDof = n;
  static constexpr int kSize = 3 * n + k;

  // q' - v, and where the rest is.
  static void kinematics(const double* u, const double* u_dot, double* r) {
    for (int i = 0; i < n; ++i) r[i] = u_dot[i] - u[2 * n + i];
  }
};

struct VehicleDae : DaeSizes<4, 2> {
  using Rate = VehicleRate;
  static constexpr std::array<double, 2> kStartMultipliers{0, 0};

  void operator()(const double* u, const double* u_dot, double* r) const {
    residual(u, u_dot, sine_cosine(u[2]), sine_cosine(u[3]), r);
  }

  static void residual(const double* u,
                       const double* u_dot,
                       SineCosine<double> theta,
                       SineCosine<double> phi,
                       double* r) {
    const double* const p = u + 4;
    const double* const v = u + 8;
    const double front = u[12];
    const double rear = u[13];
    kinematics(u, u_dot, r);
    r[4] = u_dot[4];
    r[5] = u_dot[5];
    r[6] = u_dot[6] + rear * (v[0] * theta.cosine + v[1] * theta.sine);
    r[7] = u_dot[7] + front * (v[0] * phi.cosine + v[1] * phi.sine);
    r[8] = p[0] - v[0] + front * phi.sine + rear * theta.sine;
    r[9] = p[1] - v[1] - front * phi.cosine - rear * theta.cosine;
    r[10] = p[2] - v[2] + rear;
    r[11] = p[3] - v[3];
    r[12] = v[0] * phi.sine - v[1] * phi.cosine;
    r[13] = v[0] * theta.sine - v[1] * theta.cosine + v[2];
  }
};

struct VehicleCosineDae : DaeSizes<4, 2> {
  using Rate = VehicleCosineRate;
  static constexpr std::array<double, 2> kStartMultipliers{0, 0};

  void operator()(const double* u, const double* u_dot, double* r) const {
    const SineCosine<double> theta = sine_cosine(u[2]);
    VehicleDae::residual(u, u_dot, theta, sine_cosine(u[3]), r);
    const PotentialSlope<double> slope = vehicle_cosine_slope(u, theta);
    r[4] += slope.x;
    r[5] += slope.y;
    r[6] += slope.theta;
  }
};

struct HeisenbergDae : DaeSizes<3, 1> {
  using Rate = HeisenbergRate;
  static constexpr std::array<double, 1> kStartMultipliers{-1};  // at q = 0 it is -p_z

  void operator()(const double* u, const double* u_dot, double* r) const {
    const double* const p = u + 3;
    const double* const v = u + 6;
    const double lambda = u[9];
    kinematics(u, u_dot, r);
    r[3] = u_dot[3] + lambda * v[1];
    r[4] = u_dot[4] - lambda * v[0];
    r[5] = u_dot[5];
    r[6] = p[0] - v[0] - lambda * u[1];
    r[7] = p[1] - v[1] + lambda * u[0];
    r[8] = p[2] - v[2] + lambda;
    r[9] = v[2] - u[1] * v[0] + u[0] * v[1];
  }
};

}  // namespace carnot::apps
