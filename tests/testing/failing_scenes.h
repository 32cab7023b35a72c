// Scenes that break an assumption of the core somewhere, for tests of the failure codes.
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot::test {

// Number by number: the way of scenes that do not run on packs, and quick to compile.
template <class Scene>
struct OneByOne : Scene {
  static constexpr bool kScalarOnly = true;
};

// Rows (1, 0, 0) and (1, q2, 0): dependent where q2 = 0.
struct DependentRows {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 2;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    Matrix<T, 3, 3> m = Matrix<T, 3, 3>::Constant(constant<T>(0));
    m(0, 0) = m(1, 1) = m(2, 2) = constant<T>(1);
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 2, 3> constraints(const Vector<T, 3>& q) const {
    const T zero = constant<T>(0);
    Matrix<T, 2, 3> g;
    g << constant<T>(1), zero, zero, constant<T>(1), q[1], zero;
    return g;
  }
};

// M = diag(1, q1, 0), g = (0, 0, 1): positive definite on ker G where q1 > 0 only.
struct FadingMass {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& q) const {
    Matrix<T, 3, 3> m = Matrix<T, 3, 3>::Constant(constant<T>(0));
    m(0, 0) = constant<T>(1);
    m(1, 1) = q[0];
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& /*q*/) const {
    return {constant<T>(0), constant<T>(0), constant<T>(1)};
  }
  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& /*q*/) const {
    const T zero = constant<T>(0);
    const T one = constant<T>(1);
    Matrix<T, 3, 2> b;
    b << one, zero, zero, one, zero, zero;
    return b;
  }
};

// The same, told by an orthogonal frame.
struct FadingMasses : FadingMass {
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, 3>& q) const {
    return {constant<T>(1), q[0]};
  }
};

// A particle on a line in V = -q^4: from q = 0, p = 1 it reaches infinity in finite time. No
// constraints at all.
struct RunAway {
  static constexpr int kDof = 1;
  static constexpr int kMultipliers = 0;

  template <class T>
  [[nodiscard]] Matrix<T, 1, 1> mass(const Vector<T, 1>& /*q*/) const {
    return Matrix<T, 1, 1>(constant<T>(1));
  }
  template <class T>
  [[nodiscard]] Matrix<T, 0, 1> constraints(const Vector<T, 1>& /*q*/) const {
    return {};
  }
  template <class T>
  [[nodiscard]] T potential(const Vector<T, 1>& q) const {
    return -q[0] * q[0] * q[0] * q[0];
  }
};

}  // namespace carnot::test
