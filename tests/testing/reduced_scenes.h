// Scenes with holonomic constraints beside the same physics in coordinates of their manifold, where
// no holonomic constraint is left: two independent routes to one motion.
#pragma once

#include <cmath>

#include "carnot/numerics/quaternion.h"
#include "carnot/scenes/plate_ball.h"
#include "carnot/scenes/plate_ball_quaternion.h"
#include "carnot/scenes/rod_skate.h"
#include "carnot/scenes/satellite.h"
#include "carnot/scenes/satellite_quaternion.h"
#include "carnot/scenes/skate_on_sphere.h"
#include "carnot/scenes/spherical_pendulum.h"
#include "carnot/system/holonomic.h"
#include "carnot/system/velocity_constraints.h"

namespace carnot::test {

// Middle of the rod and its heading: a unicycle of mass 2 and inertia 1/2 in V = 2 y.
struct ReducedRodSkate {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    Matrix<T, 3, 3> m = Matrix<T, 3, 3>::Constant(constant<T>(0));
    m(0, 0) = m(1, 1) = constant<T>(2);
    m(2, 2) = constant<T>(0.5);
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    using std::cos, std::sin;
    return {sin(q[2]), -cos(q[2]), constant<T>(0)};
  }
  template <class T>
  [[nodiscard]] T potential(const Vector<T, 3>& q) const {
    return constant<T>(2) * q[1];
  }
};

// Angle from the downward vertical and azimuth: M = length^2 diag(1, sin^2).
struct ReducedPendulum {
  static constexpr int kDof = 2;
  static constexpr int kMultipliers = 0;

  scenes::SphericalPendulum full;

  template <class T>
  [[nodiscard]] Matrix<T, 2, 2> mass(const Vector<T, 2>& q) const {
    using std::sin;
    const T square = constant<T>(full.length * full.length);
    Matrix<T, 2, 2> m = Matrix<T, 2, 2>::Constant(constant<T>(0));
    m(0, 0) = square;
    m(1, 1) = square * sin(q[0]) * sin(q[0]);
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 0, 2> constraints(const Vector<T, 2>& /*q*/) const {
    return {};
  }
  template <class T>
  [[nodiscard]] T potential(const Vector<T, 2>& q) const {
    using std::cos;
    return constant<T>(-full.gravity * full.length) * cos(q[0]);
  }
};

// Longitude phi, latitude theta, heading psi from the east:
//   x' = phi' cos(theta) east + theta' north,    e'.n = psi' + phi' sin(theta).
struct ReducedSkateOnSphere {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  double beta = 1;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& q) const {
    using std::cos, std::sin;
    const T square = constant<T>(beta * beta);
    const T drive = constant<T>(1 + beta * beta);
    const T s = sin(q[1]);
    Matrix<T, 3, 3> m = Matrix<T, 3, 3>::Constant(constant<T>(0));
    m(0, 0) = drive * cos(q[1]) * cos(q[1]) + square * s * s;
    m(0, 2) = m(2, 0) = square * s;
    m(1, 1) = drive;
    m(2, 2) = square;
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    using std::cos, std::sin;
    return {-sin(q[2]) * cos(q[1]), cos(q[2]), constant<T>(0)};
  }
};

// Rz(psi) Ry(theta) Rx(phi) as a unit quaternion.
template <class T>
Vector<T, 4> euler_quaternion(const T& psi, const T& theta, const T& phi) {
  using std::cos, std::sin;
  const T half = constant<T>(0.5);
  const T zero = constant<T>(0);
  const Vector<T, 4> yaw(cos(half * psi), zero, zero, sin(half * psi));
  const Vector<T, 4> pitch(cos(half * theta), zero, sin(half * theta), zero);
  const Vector<T, 4> roll(cos(half * phi), sin(half * phi), zero, zero);
  return quaternion_product(yaw, quaternion_product(pitch, roll));
}

// A pair: the full scene, the reduced one, and where a reduced configuration is in the full one.
struct RodSkatePair {
  static constexpr scenes::RodSkate kFull{};
  static constexpr ReducedRodSkate kReduced{};
  template <class T>
  static Vector<T, 4> embed(const Vector<T, 3>& r) {
    using std::cos, std::sin;
    const T x = constant<T>(0.5) * cos(r[2]);
    const T y = constant<T>(0.5) * sin(r[2]);
    return {r[0] - x, r[1] - y, r[0] + x, r[1] + y};
  }
};

struct PendulumPair {
  static constexpr scenes::SphericalPendulum kFull{1.3, 0.7};
  static constexpr ReducedPendulum kReduced{kFull};
  template <class T>
  static Vector<T, 3> embed(const Vector<T, 2>& r) {
    using std::cos, std::sin;
    const T length = constant<T>(kFull.length);
    const T across = length * sin(r[0]);
    return {across * cos(r[1]), across * sin(r[1]), -length * cos(r[0])};
  }
};

struct SkateOnSpherePair {
  static constexpr scenes::SkateOnSphere kFull{0.6};
  static constexpr ReducedSkateOnSphere kReduced{kFull.beta};
  template <class T>
  static Vector<T, 6> embed(const Vector<T, 3>& r) {
    using std::cos, std::sin;
    const Vector<T, 3> x(cos(r[1]) * cos(r[0]), cos(r[1]) * sin(r[0]), sin(r[1]));
    const Vector<T, 3> east(-sin(r[0]), cos(r[0]), constant<T>(0));
    const Vector<T, 3> north(-sin(r[1]) * cos(r[0]), -sin(r[1]) * sin(r[0]), cos(r[1]));
    Vector<T, 6> q;
    q << x, cos(r[2]) * east + sin(r[2]) * north;
    return q;
  }
};

struct SatellitePair {
  static constexpr scenes::SatelliteQuaternion kFull{0.7, 1.4};
  static constexpr scenes::Satellite kReduced{kFull.j1, kFull.j2};
  template <class T>
  static Vector<T, 4> embed(const Vector<T, 3>& r) {
    return euler_quaternion(r[0], r[1], r[2]);
  }
};

struct PlateBallPair {
  static constexpr scenes::PlateBallQuaternion kFull{};
  static constexpr scenes::PlateBall kReduced{};
  template <class T>
  static Vector<T, 6> embed(const Vector<T, 5>& r) {
    Vector<T, 6> q;
    q << r[0], r[1], euler_quaternion(r[2], r[3], r[4]);
    return q;
  }
};

template <class Pair>
using FullScene = std::decay_t<decltype(Pair::kFull)>;
template <class Pair>
using ReducedScene = std::decay_t<decltype(Pair::kReduced)>;

// The momentum p of the full scene with E'p = p_r, E the derivative of embed(), and Dh H_p = 0:
// E (E'E)^-1 p_r, brought to the hidden constraint. That changes nothing of E'p since Dh E = 0.
template <class Pair>
State<double, FullScene<Pair>::kDof> lift(const Vector<double, ReducedScene<Pair>::kDof>& r,
                                          const Vector<double, ReducedScene<Pair>::kDof>& p_r) {
  constexpr int n = FullScene<Pair>::kDof;
  constexpr int m = ReducedScene<Pair>::kDof;
  const auto x = Pair::embed(seeded(r));
  Vector<double, n> q;
  Matrix<double, n, m> e;
  for (int i = 0; i < n; ++i) {
    q[i] = x[i].a;
    for (int j = 0; j < m; ++j) e(i, j) = x[i].v[j];
  }
  const Matrix<double, m, m> gram = transposed_times(e, e);
  Vector<double, n> p = product(e, Cholesky<double, m>(gram).solve(p_r));
  const VelocityConstraints<FullScene<Pair>> system(Pair::kFull);
  EXPECT_EQ(project_momentum(system, 0.0, q, p), RateStatus::kOk);
  return make_state<double, n>(q, p);
}

}  // namespace carnot::test
