// Limits in C++, differentiated by dual numbers:
//
//   problem.limits.push_back(make_limit(
//       Vehicle{}, "steering", [](const auto& q) { return q[3] - q[2]; }, -0.6, 0.6));
//
// Where the scene is given, and has velocity constraints, arcs along the limit are exact: the scene
// is compiled once more with one row more. Without it, as make_limit<4>("steering", ...), geodesics
// that keep to the limit are those of a grid.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "carnot/make_dynamics.h"
#include "carnot/numerics/gradient.h"
#include "carnot/numerics/jet.h"
#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/limit.h"
#include "carnot/scene/velocity_constrained_scene.h"

namespace carnot {

// A limit lower <= f(q) <= upper on a scene of n coordinates. f takes a vector of any scalar type.
template <int n, class F>
Limit make_limit(std::string name,
                 F f,
                 double lower,
                 double upper = std::numeric_limits<double>::infinity()) {
  Limit limit;
  limit.name = std::move(name);
  limit.lower = lower;
  limit.upper = upper;
  limit.value = [f = std::move(f)](const double* q, double* gradient, double* hessian) {
    using First = Jet<double, n>;
    using Second = Jet<First, n>;
    Vector<Second, n> x;
    for (int i = 0; i < n; ++i) x[i] = Second(First(q[i], i), i);
    const Second y = f(x);
    for (int i = 0; i < n && gradient != nullptr; ++i) gradient[i] = y.a.v[i];
    for (int i = 0; i < n * n && hessian != nullptr; ++i) hessian[i] = y.v[i / n].v[i % n];
    return y.a.a;
  };
  return limit;
}

// A scene whose velocities keep the value of f(q): besides its constraints df.q' = 0.
template <VelocityConstrainedScene Scene, class F>
struct HeldScene {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = Scene::kMultipliers + 1;

  Scene scene;
  F f;

  // That of the scene.
  template <class T>
  Matrix<T, kDof, kDof> mass(const Vector<T, kDof>& q) const {
    return scene.mass(q);
  }

  // Those of the scene, and below them the row df(q).
  template <class T>
  Matrix<T, kMultipliers, kDof> constraints(const Vector<T, kDof>& q) const {
    Matrix<T, kMultipliers, kDof> rows;
    rows.topRows(Scene::kMultipliers) = scene.constraints(q);
    rows.row(Scene::kMultipliers) = gradient(f, q).transpose();
    return rows;
  }

  // That of the scene.
  template <class T>
  T potential(const Vector<T, kDof>& q) const requires HasPotential<Scene> {
    return scene.potential(q);
  }
};

// The same on a scene, which is held on the limit where a geodesic keeps to it for a while.
template <VelocityConstrainedScene Scene, class F>
Limit make_limit(const Scene& scene,
                 std::string name,
                 F f,
                 double lower,
                 double upper = std::numeric_limits<double>::infinity()) {
  static_assert(Scene::kMultipliers + 1 < Scene::kDof,
                "nothing moves along the limit: the constraints leave one direction alone");
  Limit limit = make_limit<Scene::kDof>(std::move(name), f, lower, upper);
  limit.held = [scene, f] { return make_dynamics(HeldScene<Scene, F>{scene, f}); };
  return limit;
}

// A disc of the plane that a point of the body keeps out of. point(q) is {x, y}, of any scalar
// type:
//
//   problem.limits.push_back(make_disc(
//       Vehicle{}, "pillar, front", [](const auto& q) { return std::array{q[0], q[1]}; }, {1, 2},
//       0.3));
//
// What is limited is the square of the distance over twice the radius, which is smooth.
template <VelocityConstrainedScene Scene, class Point>
Limit make_disc(const Scene& scene,
                std::string name,
                Point point,
                const std::array<double, 2>& centre,
                double radius) {
  Limit limit = make_limit(
      scene,
      std::move(name),
      [point, centre, radius](const auto& q) {
        const auto at = point(q);
        const auto dx = at[0] - centre[0];
        const auto dy = at[1] - centre[1];
        return (dx * dx + dy * dy) * (0.5 / radius);
      },
      0.5 * radius);
  limit.outline = circle_outline(centre, radius);
  limit.radius = radius;
  return limit;
}

}  // namespace carnot
