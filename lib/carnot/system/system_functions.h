// What a kernel asks of a system, as functions on plain numbers.
//
// All arrays belong to the caller. q, p and v have n entries and z = (q, p) has 2n; y has room for
// kMostAlgebraic n entries, of which a system reads and writes its own. Numbers side by side lie in
// rows: entry k of lane l of W lanes is number k W + l. Nothing here allocates or throws.
#pragma once

#include "carnot/system/rate_status.h"
#include "carnot/system/stage_iteration.h"

namespace carnot {

// Algebraic variables, and multipliers, per coordinate, at most.
inline constexpr int kMostAlgebraic = 2;

// How many points are evaluated in one call.
inline constexpr int kErasedLanes = 8;

// The stages of a step, side by side: the data of packed_iteration().
struct StageData {
  const double* time;          // of the stages
  const double* mu;            // 8 x 8, column by column
  const double* weights;       // h omega of the stages
  const double* value;         // z at the start of the step,
  const double* compensation;  // and its rounding error
  double* stages;              // 2n rows
  double* algebraic;           // rows of y
  double* increments;          // 2n rows
};

struct StageReport {
  IterationEnd end = IterationEnd::kGaveUp;
  int sweeps = 0;
};

// What is measured at a point of a motion, with velocity v.
struct PointMeasures {
  double lagrangian = 0;  // p.v - H
  double speed = 0;       // the integrand of the length; NaN where there is no metric
  double power = 0;       // H_t at fixed q, p, y
  double constraint = 0;  // |g(q, v)| / max(1, |v|)
};

// What is measured at a node, where v is the rate. H is NaN where that fails.
struct NodeMeasures {
  double hamiltonian = 0;
  double constraint = 0;
  double holonomic = 0;  // max of |h(q)| and |Dh v| / max(1, |v|)
};

struct SystemFunctions {
  int dof = 0;
  int algebraic = 0;
  int multipliers = 0;
  bool packs = false;  // rates run side by side in registers

  // Solves H_y = 0 from y, which is the branch and the warm start, and sets y and z_dot.
  RateStatus (*rate)(const void* system, double t, const double* z, double* y, double* z_dot) =
      nullptr;
  // d(z_dot)/dz at the solution y, 2n x 2n, column by column.
  RateStatus (*jacobian)(
      const void* system, double t, const double* z, const double* y, double* jacobian) = nullptr;
  // The rates of kErasedLanes points side by side. False where one of them fails.
  bool (*rates)(const void* system, const double* t, const double* z, double* y, double* z_dot) =
      nullptr;
  // The Jacobians of as many points side by side: entry (r, c) is row 2n r + c, times the row
  // `weights`. False where that is not possible.
  bool (*jacobians)(const void* system,
                    const double* t,
                    const double* z,
                    const double* weights,
                    double* jacobian) = nullptr;
  // The fixed-point iteration on the stages of a step.
  StageReport (*iterate)(const void* system,
                         const StageData& data,
                         const IterationLimits<double>& limits) = nullptr;

  double (*hamiltonian)(
      const void* system, double t, const double* q, const double* p, const double* y) = nullptr;
  // lambda at a solution y.
  RateStatus (*find_multipliers)(const void* system,
                                 double t,
                                 const double* q,
                                 const double* p,
                                 const double* y,
                                 double* lambda) = nullptr;
  // At the first `count` of kErasedLanes points side by side, with velocities dq / weights.
  void (*measure)(const void* system,
                  int count,
                  const double* t,
                  const double* weights,
                  const double* z,
                  const double* dq,
                  const double* y,
                  PointMeasures* out) = nullptr;
  // y is the branch and the warm start, and the solution afterwards.
  NodeMeasures (*measure_node)(const void* system, double t, const double* z, double* y) = nullptr;
  // The y that a run begins with; zero leaves the choice to the system.
  void (*branch)(const void* system, double* y) = nullptr;
};

}  // namespace carnot
