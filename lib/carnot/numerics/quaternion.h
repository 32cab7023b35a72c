// Quaternions as vectors (w, x, y, z), and the rates of the rotations they stand for.
//
// A unit quaternion rotates body to space by v -> q v conj(q). For q(t) on the unit sphere
// 2 conj(q) q' = (0, omega) holds the body rates, 2 q' conj(q) = (0, Omega) the rates in space.
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// a b.
template <class T>
Vector<T, 4> quaternion_product(const Vector<T, 4>& a, const Vector<T, 4>& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
          a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1]};
}

// The matrix of q' -> 2 conj(q) q' = (2 q.q', omega): rows 2 q, 2 q i, 2 q j, 2 q k.
template <class T>
Matrix<T, 4, 4> body_rates(const Vector<T, 4>& q) {
  const T two = constant<T>(2);
  const T w = two * q[0];
  const T x = two * q[1];
  const T y = two * q[2];
  const T z = two * q[3];
  Matrix<T, 4, 4> m;
  // clang-format off
  m <<  w,  x,  y,  z,
       -x,  w,  z, -y,
       -y, -z,  w,  x,
       -z,  y, -x,  w;
  // clang-format on
  return m;
}

// The matrix of q' -> 2 q' conj(q) = (2 q.q', Omega): rows 2 q, 2 i q, 2 j q, 2 k q.
template <class T>
Matrix<T, 4, 4> space_rates(const Vector<T, 4>& q) {
  const T two = constant<T>(2);
  const T w = two * q[0];
  const T x = two * q[1];
  const T y = two * q[2];
  const T z = two * q[3];
  Matrix<T, 4, 4> m;
  // clang-format off
  m <<  w,  x,  y,  z,
       -x,  w, -z,  y,
       -y,  z,  w, -x,
       -z, -y,  x,  w;
  // clang-format on
  return m;
}

}  // namespace carnot
