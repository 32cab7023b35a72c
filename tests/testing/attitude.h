// Rotations as matrices, for scenes whose attitude is R = Rz(psi) Ry(theta) Rx(phi).
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"
#include "carnot/scenes/satellite.h"

namespace carnot::test {

// Body to space.
template <class T>
Matrix<T, 3, 3> attitude(const T& psi, const T& theta, const T& phi) {
  using std::cos, std::sin;
  const T zero = constant<T>(0);
  const T one = constant<T>(1);
  Matrix<T, 3, 3> yaw;
  Matrix<T, 3, 3> pitch;
  Matrix<T, 3, 3> roll;
  // clang-format off
  yaw << cos(psi), -sin(psi), zero,
         sin(psi), cos(psi),  zero,
         zero,     zero,      one;
  pitch << cos(theta),  zero, sin(theta),
           zero,        one,  zero,
           -sin(theta), zero, cos(theta);
  roll << one,  zero,     zero,
          zero, cos(phi), -sin(phi),
          zero, sin(phi), cos(phi);
  // clang-format on
  return product(yaw, product(pitch, roll));
}

// The momenta m of the turns about the body axes: p = W'm for rates w = W (psi', theta', phi').
inline Vector<double, 3> body_momenta(const Vector<double, 3>& angles, const Vector<double, 3>& p) {
  return scenes::Satellite{}.body_rates(angles).transpose().inverse() * p;
}

// exp(hat(w)): the turn about w by the angle |w|.
inline Matrix<double, 3, 3> rotation(const Vector<double, 3>& w) {
  return Eigen::AngleAxisd(w.norm(), w.stableNormalized()).toRotationMatrix();
}

// w of hat(w) = (0, -w_z, w_y; w_z, 0, -w_x; -w_y, w_x, 0).
inline Vector<double, 3> axis_of(const Matrix<double, 3, 3>& hat) {
  return {hat(2, 1), hat(0, 2), hat(1, 0)};
}

}  // namespace carnot::test
