// Scenes written with controls: constrained ones in the form q' = F(q) u, and wrappers that make
// the core take another route to the same answer.
#pragma once

#include "carnot/scenes/heisenberg.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/system/optimal_control.h"

namespace carnot::test {

// A scene with velocity constraints and a frame B: f = B u, l = u'B'M B u/2.
template <class Scene>
struct ControlForm {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kControls = Scene::kDof - Scene::kMultipliers;

  Scene scene;

  template <class T>
  [[nodiscard]] Matrix<T, kDof, kControls> frame(const Vector<T, kDof>& q) const {
    return scene.frame(q);
  }
  template <class T>
  [[nodiscard]] Matrix<T, kControls, kControls> control_weight(const Vector<T, kDof>& q) const {
    const Matrix<T, kDof, kControls> b = scene.frame(q);
    const Matrix<T, kDof, kControls> mb = product(scene.mass(q), b);
    return product(b.transpose(), mb);
  }
};

// A linear scene as f and l only: the general route.
template <class Scene>
struct ByNewton {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kControls = Scene::kControls;

  Scene scene;

  template <class T>
  [[nodiscard]] Vector<T, kDof> dynamics(const T& t,
                                         const Vector<T, kDof>& q,
                                         const Vector<T, kControls>& u) const {
    return OptimalControl<Scene>(scene).dynamics(t, q, u);
  }
  template <class T>
  [[nodiscard]] T running_cost(const T& t,
                               const Vector<T, kDof>& q,
                               const Vector<T, kControls>& u) const {
    return OptimalControl<Scene>(scene).running_cost(t, q, u);
  }
};

// The frame, and what belongs to it, but no derivative by hand. What a scene does not have stays
// away here too.
template <class Scene>
struct WithoutControlGradient {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kControls = Scene::kControls;

  Scene scene;

  template <class T>
  [[nodiscard]] Matrix<T, kDof, kControls> frame(const Vector<T, kDof>& q) const {
    return scene.frame(q);
  }
  template <class T, HasDrift Inner = Scene>
  [[nodiscard]] Vector<T, kDof> drift(const Vector<T, kDof>& q) const {
    return scene.drift(q);
  }
  template <class T, HasStateCost Inner = Scene>
  [[nodiscard]] T state_cost(const Vector<T, kDof>& q) const {
    return scene.state_cost(q);
  }
};

}  // namespace carnot::test
