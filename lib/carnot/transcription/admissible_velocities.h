// A control problem q' = F(q) u of cost u'R u/2 seen as one with velocity constraints, for the
// midpoint transcription, which knows paths and not controls.
//
// With W = (F'F)^-1 F' the velocity v = F u has the controls u = W v and costs v'(W'R W)v/2, and v
// is admissible where C v = 0, C = I - F W. C is a projector: of its n rows only n - c are
// independent, so lambda is determined up to the range of P = kappa F W. The term lambda'P lambda/2
// of the discrete Lagrangian (midpoint_transcription.h) picks P lambda = 0 and changes nothing
// else. Where F loses rank, F'F + epsilon trace(F'F) I stands for F'F = N.
//
// What the inverse W is, and so what the Lagrangian says of velocities that are not admissible,
// depends on the units of the coordinates. They may be chosen: with units D the velocity D^-1 v and
// the frame D^-1 F take the places of v and F.
//
// The Lagrangian itself needs no n x n products: with b = F'lambda, w = N^-1 F'v and w_l = N^-1 b,
//
//   l = w'R w/2 + b.w - kappa b.w_l/2 - lambda.v.
#pragma once

#include "carnot/numerics/cholesky.h"
#include "carnot/numerics/gradient.h"
#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"
#include "carnot/scene/optimal_control_scene.h"

namespace carnot {

template <HasLinearControls Scene>
struct AdmissibleVelocities {
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = kDof;
  static constexpr int kControls = Scene::kControls;

  Scene scene;
  Vector<double, kDof> per_unit = Vector<double, kDof>::Ones();  // of D^-1
  double weight = 1;                                             // kappa

  // W'R W.
  template <class T>
  [[nodiscard]] Matrix<T, kDof, kDof> mass(const Vector<T, kDof>& q) const {
    const Matrix<T, kControls, kDof> w = controls(frame(q));
    if constexpr (HasControlWeight<Scene>) {
      const Matrix<T, kControls, kDof> rw = product(scene.control_weight(q), w);
      return transposed_times(w, rw);
    } else {
      return transposed_times(w, w);
    }
  }

  // C.
  template <class T>
  [[nodiscard]] Matrix<T, kDof, kDof> constraints(const Vector<T, kDof>& q) const {
    Matrix<T, kDof, kDof> c = gauge(q);
    for (int i = 0; i < kDof; ++i) {
      for (int j = 0; j < kDof; ++j) c(i, j) = -c(i, j);
      c(i, i) += constant<T>(1);
    }
    return c;
  }

  // P / kappa.
  template <class T>
  [[nodiscard]] Matrix<T, kDof, kDof> gauge(const Vector<T, kDof>& q) const {
    const Matrix<T, kDof, kControls> f = frame(q);
    return product(f, controls(f));
  }

  // l = v'M v/2 - lambda'C v - lambda'P lambda/2.
  template <class T>
  [[nodiscard]] T gauged_lagrangian(const Vector<T, kDof>& q,
                                    const Vector<T, kDof>& v,
                                    const Vector<T, kDof>& lambda) const {
    using Controls = Vector<T, kControls>;
    const Matrix<T, kDof, kControls> f = frame(q);
    const Cholesky<T, kControls> square(regular_square(f));
    const Controls b = transposed_times(f, lambda);
    const Controls w = square.solve(transposed_times(f, v));
    const Controls w_l = square.solve(b);
    const T energy = square_of_controls(q, w) - constant<T>(weight) * dot(b, w_l);
    return constant<T>(0.5) * energy + dot(b, w) - dot(lambda, v);
  }

 private:
  // w'R w.
  template <class T>
  [[nodiscard]] T square_of_controls(const Vector<T, kDof>& q,
                                     const Vector<T, kControls>& w) const {
    if constexpr (HasControlWeight<Scene>) {
      const Vector<T, kControls> rw = product(scene.control_weight(q), w);
      return dot(w, rw);
    } else {
      return dot(w, w);
    }
  }

  // D^-1 F.
  template <class T>
  [[nodiscard]] Matrix<T, kDof, kControls> frame(const Vector<T, kDof>& q) const {
    Matrix<T, kDof, kControls> f = scene.frame(q);
    for (int i = 0; i < kDof; ++i) {
      for (int j = 0; j < kControls; ++j) f(i, j) *= constant<T>(per_unit[i]);
    }
    return f;
  }

  // F'F, made regular.
  template <class T>
  static Matrix<T, kControls, kControls> regular_square(const Matrix<T, kDof, kControls>& f) {
    constexpr double kRegular = 1e-14;
    Matrix<T, kControls, kControls> square = transposed_times(f, f);
    T trace = square(0, 0);
    for (int i = 1; i < kControls; ++i) trace += square(i, i);
    for (int i = 0; i < kControls; ++i) square(i, i) += constant<T>(kRegular) * trace;
    return square;
  }

  // W.
  template <class T>
  [[nodiscard]] Matrix<T, kControls, kDof> controls(const Matrix<T, kDof, kControls>& f) const {
    const Cholesky<T, kControls> factor(regular_square(f));
    Matrix<T, kControls, kDof> w;
    for (int j = 0; j < kDof; ++j) {
      Vector<T, kControls> row;
      for (int i = 0; i < kControls; ++i) row[i] = f(j, i);
      row = factor.solve(row);
      for (int i = 0; i < kControls; ++i) w(i, j) = row[i];
    }
    return w;
  }
};

}  // namespace carnot
