// Fixed-size vectors and matrices over any scalar: double, long double, a quad type, a ceres::Jet.
//
// carnot::core sets EIGEN_MAX_ALIGN_BYTES=16 for everyone who includes it, so that a program built
// with default flags and a library built for the machine's own instruction set agree on layouts.
#pragma once

#include <Eigen/Core>

namespace carnot {

template <class T, int n>
using Vector = Eigen::Matrix<T, n, 1>;

template <class T, int rows, int cols>
using Matrix = Eigen::Matrix<T, rows, cols>;

// A vector on somebody else's numbers.
template <int n>
Eigen::Map<const Vector<double, n>> view(const double* x) {
  return Eigen::Map<const Vector<double, n>>(x, n);
}
template <int n>
Eigen::Map<Vector<double, n>> view(double* x) {
  return Eigen::Map<Vector<double, n>>(x, n);
}

}  // namespace carnot
