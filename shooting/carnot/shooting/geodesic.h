// An extremal that joins two configurations, with what was measured of it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot {

// kSingle: one integration from p0. kKnots: piece by piece. kGrid: no integration keeps to a limit
// there; the path is that of the grid.
enum class Verification { kSingle, kKnots, kGrid };
// kAbnormal: strictly abnormal, an extremal by the constraints alone. No momentum leads along it:
// p0, lambda0, energy_drift and those of the trajectory are NaN. kNotMinimal: Legendre's condition
// fails, so that quick wiggles lower the action.
enum class Label { kLocallyMinimal, kConjugatePassed, kSingular, kUnknown, kAbnormal, kNotMinimal };

// How a path keeps to a limit.
struct LimitReport {
  std::string name;
  double lowest_slack = 0;                        // the closest approach; negative beyond the limit
  std::vector<std::pair<double, double>> active;  // when the path keeps to it
  double largest_multiplier = 0;                  // action per time and unit of the limited value
};

// An extremal that joins the two configurations, checked.
struct Geodesic {
  std::vector<double> from;  // q(0) and q(T): the ends of the problem, and what was found where
  std::vector<double> to;    // they are free
  std::vector<double> p0;
  std::vector<double> lambda0;
  double action = 0;
  std::optional<double> length;  // where the scene has a mass matrix
  Verification verification = Verification::kSingle;
  double endpoint_error = 0;        // max-norm of q(T) - to; of an independent integration
  double transversality_error = 0;  // max |p_j(T)| of free coordinates, of the same
  double knot_defect = 0;           // max-norm of flow(z_i) - z_{i+1}, for kKnots
  double constraint_error = 0;
  double energy_drift = 0;
  std::optional<std::vector<double>> conjugate_times;  // in (0, T], by multiplicity; if known
  Label label = Label::kUnknown;
  std::optional<bool> abnormal;  // if known
  std::optional<int> morse_index;
  std::optional<int> family_dimension;
  std::vector<LimitReport> limits;  // in the order of the problem
  double limit_violation = 0;       // how far it is beyond one of them
  double grid_error = 0;            // for kGrid: by how much the action may be wrong
  std::vector<std::pair<std::string, double>> extremes;  // e.g. largest_steering_angle
  StepPlan plan;                                         // steps of the verified integration
  int hits = 0;               // starts that led here or to a mirror partner
  std::vector<int> windings;  // whole periods added to the target, with mod_angles
  Trajectory trajectory;
};

}  // namespace carnot
