// What a kernel asks of a system, as functions on plain numbers.
//
// All arrays belong to the caller. q, p and v have n entries and z = (q, p) has 2n; y has room for
// kMostAlgebraic n entries, of which a system reads and writes its own. Numbers side by side lie in
// rows: entry k of lane l of W lanes is number k W + l. Nothing here allocates or throws.
#pragma once

#include "carnot/system/rate_status.h"

namespace carnot {

// Algebraic variables, and multipliers, per coordinate, at most.
inline constexpr int kMostAlgebraic = 2;

// How many points are evaluated in one call.
inline constexpr int kErasedLanes = 8;

// One iteration on the eight stages of a step, see packed_sweep().
struct SweepData {
  const double* time;          // of the stages
  const double* mu;            // 8 x 8, column by column
  const double* weights;       // h omega of the stages
  const double* value;         // z at the start of the step,
  const double* compensation;  // and its rounding error
  double* stages;              // 2n rows
  double* algebraic;           // rows of y
  double* increments;          // 2n rows
  double* change;              // of each component, the largest over the stages; may be null
};

// What one iteration did.
struct Sweep {
  bool ok = false;    // else some lane fails: ask the rates one by one which and why
  double change = 0;  // the largest of an entry of the stages
};

struct SystemFunctions {
  int dof = 0;
  int algebraic = 0;
  int multipliers = 0;
  bool autonomous = true;
  bool packs = false;  // rates run side by side in registers

  // Solves H_y = 0 from y, which is the branch and the warm start, and sets y and z_dot.
  RateStatus (*rate)(const void* system, double t, const double* z, double* y, double* z_dot);
  // d(z_dot)/dz at the solution y, 2n x 2n, column by column.
  RateStatus (*jacobian)(
      const void* system, double t, const double* z, const double* y, double* jacobian);
  // The rates of kErasedLanes points side by side. False where one of them fails.
  bool (*rates)(const void* system, const double* t, const double* z, double* y, double* z_dot);
  // The Jacobians of as many points side by side: entry (r, c) is row 2n r + c, times the row
  // `weights`. False where that is not possible.
  bool (*jacobians)(const void* system,
                    const double* t,
                    const double* z,
                    const double* weights,
                    double* jacobian);
  Sweep (*sweep)(const void* system, const SweepData& data);

  double (*hamiltonian)(
      const void* system, double t, const double* q, const double* p, const double* y);
  // H_t at fixed q, p, y.
  double (*explicit_rate)(
      const void* system, double t, const double* q, const double* p, const double* y);
  // lambda at a solution y.
  RateStatus (*find_multipliers)(const void* system,
                                 double t,
                                 const double* q,
                                 const double* p,
                                 const double* y,
                                 double* lambda);
  double (*constraint_norm)(const void* system, const double* q, const double* v);
  double (*holonomic_error)(const void* system, const double* q, const double* v);
  double (*speed)(const void* system, const double* q, const double* v);
  // The y that a run begins with; zero leaves the choice to the system.
  void (*branch)(const void* system, double* y);
};

}  // namespace carnot
