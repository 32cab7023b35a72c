// Short cuts for tests that run a method on a scene from a random start.
#pragma once

#include "carnot/flow/flow.h"
#include "carnot/system/velocity_constraints.h"
#include "testing/distance.h"
#include "testing/random_points.h"
#include "testing/scene_list.h"

namespace carnot::test {

// A start of moderate size: q in [-1, 1]^n, p in [-1.5, 1.5]^n.
template <int n>
State<double, n> random_state(Generator& generator) {
  const Vector<double, n> q = random_vector<n>(generator);
  const Vector<double, n> p = random_vector<n>(generator, 1.5);
  return make_state<double, n>(q, p);
}

template <class T, int n>
State<T, n> cast_state(const State<double, n>& z) {
  return {z.value.template cast<T>(), z.compensation.template cast<T>()};
}

// (q, -p): time runs backwards.
template <class T, int n>
State<T, n> flipped(State<T, n> z) {
  z.value.template tail<n>() *= T(-1);
  z.compensation.template tail<n>() *= T(-1);
  return z;
}

// max-norm of the difference over max(1, size).
template <class V>
auto relative_distance(const V& a, const V& b) {
  using T = typename V::Scalar;
  return largest_change(a, b) / maximum<T>(T(1), largest_entry(b));
}

// The paper's start on the vehicles: p = M q', lambda = 0, from q0 = (1, 0.5, 0.3, 0.8).
template <class Scene>
State<double, 4> vehicle_start(const VelocityConstraints<Scene>& system) {
  const Vector<double, 4> q(1, 0.5, 0.3, 0.8);
  const Vector<double, 4> v = system.scene().frame(q) * Vector<double, 2>(1, 0.2);
  return make_state<double, 4>(q, system.momentum(q, v, Vector<double, 2>(0, 0)));
}

}  // namespace carnot::test
