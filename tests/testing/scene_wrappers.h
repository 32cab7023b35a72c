// A scene with part of it hidden, so that the core takes another route to the same answer.
#pragma once

#include <utility>

#include "carnot/system/velocity_constraints.h"

namespace carnot::test {

// Only M, G and V: the multiplier route.
template <class Scene>
struct WithoutFrame {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = Scene::kMultipliers;

  Scene scene;

  template <class T>
  [[nodiscard]] Matrix<T, kDof, kDof> mass(const Vector<T, kDof>& q) const {
    return scene.mass(q);
  }
  template <class T>
  [[nodiscard]] Matrix<T, kMultipliers, kDof> constraints(const Vector<T, kDof>& q) const {
    return scene.constraints(q);
  }
  // Exists where the scene has one.
  template <class T, class Inner = Scene>
  [[nodiscard]] auto potential(const Vector<T, kDof>& q) const
      -> decltype(std::declval<const Inner&>().potential(q)) {
    return scene.potential(q);
  }
};

// M, G, V and the frame, but no derivative or product by hand.
template <class Scene>
struct WithoutHandDerivatives : WithoutFrame<Scene> {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kFrame = Scene::kDof - Scene::kMultipliers;

  template <class T>
  [[nodiscard]] Matrix<T, kDof, kFrame> frame(const Vector<T, kDof>& q) const {
    return this->scene.frame(q);
  }
};

}  // namespace carnot::test
