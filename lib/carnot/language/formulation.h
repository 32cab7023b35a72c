// The function H(t, q, p, y) of a scene from text, and all that is derived from it: formulas in the
// variables of variables.h, to be made into tapes.
//
// What the text has decides the kind:
//
//   hamiltonian               generalized Hamiltonian: z = (q, p, y) by a linear map
//   lagrangian                Lagrangian: y = (v, lambda)
//   controls                  optimal control: y = u
//   kinetic, mass             velocity constraints: y = u of a frame, or (v, lambda)
//
// Where H is of second order in y, the equations H_y = 0 are linear: y is a formula in (t, q, p),
// straight-line, without pivots:
//
//   frame     -H_yy = B'M B, Cholesky.
//   controls  -H_uu = R, Cholesky.
//   saddle    y = (v, lambda), -H_yy = (M, -G'; -G, 0). With A = M + gamma G'G, which is positive
//             definite where M is on ker G, (M x - G'mu, -G x) = (a, b) is solved by
//             S mu = -b - G A^-1 r,  x = A^-1 (r + G'mu),  r = a - gamma G'b,  S = G A^-1 G'.
//
// A holonomic constraint h(q) = 0 is kept as the velocity constraint Dh q' = 0 that follows from
// it, with multipliers mu: with h = 0 at the start the paths are the same, and H does not see
// momenta along the rows of Dh. Of those that mean the same, the one with mu = 0 is taken: p +
// Dh'mu.
//
// The derivative of y by z follows from H_yz + H_yy y_z = 0 with the same factors, so that
//
//   z' = (H_p, -H_q),    d z'/dz = (0 I; -I 0) (H_zz - H_zy H_yy^-1 H_yz).
//
// Else y is found by Newton's method (text_newton.h) from formulas for H_y and H_yy.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "carnot/language/scene_source.h"
#include "carnot/language/symbolic_matrix.h"
#include "carnot/numerics/darboux.h"

namespace carnot::language {

// What the midpoint transcription needs: transcription_functions.h.
struct TranscriptionFormulas {
  SymbolicMatrix mass;
  SymbolicMatrix constraints;
  Expression potential;
  bool gauge = false;
  Expression lagrangian;  // of (q, v, lambda), with the multipliers' part
};

struct Formulation {
  enum class Kind { kVelocityConstraints, kLagrangian, kOptimalControl, kGeneralizedHamiltonian };
  Kind kind = Kind::kVelocityConstraints;
  int dof = 0;          // n
  int algebraic = 0;    // m
  int multipliers = 0;  // k, without those of holonomic constraints
  bool autonomous = true;
  bool linear = true;              // y is a formula
  bool may_be_indefinite = false;  // a quadratic Lagrangian: its mass is to be looked at
  Expression hamiltonian;          // of t, q, p, y
  SymbolicVector solution;         // y of t, q, p; where linear
  std::vector<Check> checks;       // of the solution
  // x with -H_yy x = b: the factors of the solution again; where linear.
  std::function<SymbolicVector(const SymbolicVector& b)> solve;
  SymbolicVector guess;   // of y, of t, q, p: where Newton's method begins; empty: at zero
  SymbolicVector lambda;  // of t, q, p, y
  std::vector<Check> lambda_checks;
  SymbolicVector constraint;               // g of t, q, v; empty: none
  std::optional<Expression> square_speed;  // v'M v of q, v
  SymbolicVector masses;    // of t, q, v: L_vv on the diagonal, which measures velocities
  SymbolicVector momentum;  // p of t, q, v, lambda at an admissible velocity
  SymbolicVector drift;     // with linear controls: the velocity without them
  std::optional<TranscriptionFormulas> transcription;
  std::optional<Expression> chart;  // of q
  SymbolicVector holonomic;         // h of q; empty: none
  SymbolicVector holonomic_forces;  // mu of t, q, p
  std::optional<DarbouxForm> darboux;
};

// The word for the kind in reports.
std::string_view kind_text(const Formulation& formulation);

// How y is found for a Lagrangian that is quadratic in the velocities.
enum class QuadraticBy {
  kFormulas,  // where the mass is positive definite on the admissible velocities
  kNewton     // where it may be indefinite: factors have pivots then
};

// Throws TextError for scenes that are none of the kinds.
Formulation formulate(const SceneSource& scene,
                      std::string_view text,
                      const std::string& file,
                      QuadraticBy quadratic = QuadraticBy::kFormulas);

}  // namespace carnot::language
