// What a rate() may answer, and how regular its equations are.
#pragma once

#include <string_view>

namespace carnot {

enum class RateStatus {
  kOk,
  kConstraintRank,   // the rows of G(q), or of Dh(q), are linearly dependent
  kMassNotPositive,  // M(q) is not positive definite on ker G(q)
  kChart,            // the coordinates are singular
  kNotIndexOne,      // H_yy is singular
  kNoSolution,       // Newton's method for H_y = 0 did not converge
  kNotFinite,        // a value is infinite or not a number
  kFarAngle,         // the derivative of a rate at an angle beyond 1e6
};

// One line for a person: what failed and what it means.
constexpr std::string_view describe(RateStatus status) {
  switch (status) {
    case RateStatus::kOk:
      return "";
    case RateStatus::kConstraintRank:
      return "the constraints are linearly dependent here: rows of G(q), or of Dh(q) where h(q) = "
             "0";
    case RateStatus::kMassNotPositive:
      return "the mass matrix is not positive definite on the admissible velocities (ker G) here";
    case RateStatus::kChart:
      return "the coordinates are singular here: use other coordinates, such as a unit quaternion";
    case RateStatus::kNotIndexOne:
      return "H_yy is singular: the system is not of index 1 here";
    case RateStatus::kNoSolution:
      return "no solution of H_y = 0 was found: start nearer to a branch, or try a smaller step";
    case RateStatus::kNotFinite:
      return "a value is infinite or not a number";
    case RateStatus::kFarAngle:
      return "an angle is beyond 1e6 rad, where derivatives end: give its coordinate a period";
  }
  return "";
}

// Why H_y = 0 is hard to solve: of H_yy at one point.
struct Regularity {
  double determinant = 0;
  double condition = 0;
};

}  // namespace carnot
