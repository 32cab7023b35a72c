// A scene from text as the rest of the library sees it: tapes behind the function pointers of
// system_functions.h, transcription_functions.h and dynamics.h.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/language/formulation.h"
#include "carnot/language/tape.h"
#include "carnot/system/system_functions.h"
#include "carnot/transcription/transcription_functions.h"

namespace carnot::language {

// All tapes read the groups (t, q, p, y, v, lambda), as far as they depend on them.
struct TextSystem {
  explicit TextSystem(const Formulation& formulation, Graph& graph);
  TextSystem(const TextSystem&) = delete;
  TextSystem& operator=(const TextSystem&) = delete;

  Formulation::Kind kind;
  int dof;
  int algebraic;
  int multipliers;
  int transcribed;  // constraints of the transcription
  bool linear;
  bool autonomous;

  Tape rate;      // z', y, and values that must be positive; not linear: z' from y
  Tape jacobian;  // dz'/dz row by row, and the same; not linear: H_yz, H_zz, m x 2n and 2n x 2n
  std::vector<RateStatus> rate_checks;
  Tape equations;  // H_y, not linear only
  Tape guess;      // of y, not linear only
  Tape hessian;    // H_y, and H_yy row by row; of all kinds but velocity constraints
  Tape point;      // H, H_t, the square of the speed, g
  Tape lambda;
  std::vector<RateStatus> lambda_checks;
  Tape masses;      // L_vv on the diagonal
  Tape constraint;  // g, and its derivatives by v, row by row
  Tape momentum;
  Tape controls;  // velocities of linear controls column by column, drift, R, linear part of the
                  // cost
  Tape dynamics;  // f and f_u column by column, cost and its gradient; not linear
  Tape legendre;  // of H - p.v: derivatives by x = (p, y), first and second
  Tape held;      // the same where y in H is lambda, with |y - lambda|^2/2
  Tape chart;
  Tape holonomic;         // h, and Dh row by row
  Tape forces;            // mu
  Tape slopes_of_forces;  // its derivatives by z row by row
  Tape entries;           // of the transcription
  Tape slopes;
  Tape lagrangian_hessian;
  int controls_count = 0;
  int constraint_count = 0;
  int holonomic_count = 0;
  bool metric = false;  // there is a speed
  bool has_transcription = false;
  bool has_chart = false;
  bool has_guess = false;

  SystemFunctions functions;
  TranscriptionFunctions transcription;
  Dynamics::Calls calls{};
};

// What the pointers point to: a system, and the y that its runs begin with.
struct TextBound {
  std::shared_ptr<const TextSystem> system;
  std::vector<double> branch;
};

}  // namespace carnot::language
