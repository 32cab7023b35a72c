// Short cuts for tests that run a method on a scene from a random start.
#pragma once

#include <algorithm>

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
  State<T, n> copy;
  std::copy_n(z.value.data(), 2 * n, copy.value.data());
  std::copy_n(z.compensation.data(), 2 * n, copy.compensation.data());
  return copy;
}

// (q, -p): time runs backwards.
template <class T, int n>
State<T, n> flipped(State<T, n> z) {
  for (int i = n; i < 2 * n; ++i) {
    z.value[i] *= T(-1);
    z.compensation[i] *= T(-1);
  }
  return z;
}

// The paper's start on the vehicles: p = M q', lambda = 0, from q0 = (1, 0.5, 0.3, 0.8).
template <class Scene>
State<double, 4> vehicle_start(const VelocityConstraints<Scene>& system) {
  const Vector<double, 4> q(1, 0.5, 0.3, 0.8);
  const Vector<double, 4> v = product(system.scene().frame(q), Vector<double, 2>(1, 0.2));
  return make_state<double, 4>(q, system.momentum(q, v, Vector<double, 2>(0, 0)));
}

}  // namespace carnot::test
