// What may be asked of a continuation, and what it answers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "carnot/shooting/geodesic.h"

namespace carnot {

struct ContinuationOptions {
  double first_step = 0.02;  // of arclength, in units of s and of the sizes of p and q
  double largest_step = 0.1;
  double smallest_step = 1e-7;
  int max_points = 1000;  // in all
  bool branches = false;  // follow those that start at branch points of the first curve, too
  bool labels = true;     // Morse index and label of every point; conjugate times are not located
  // Largest endpoint error of a verified point, in the natural scales of the problem at the start;
  // and the same in the units of the coordinates, which takes its place where it is given.
  double tolerance = 1e-10;
  std::optional<double> absolute_tolerance;
  Progress progress;  // fraction done; returns false to stop

  // Throws std::invalid_argument naming the option and what is accepted.
  void validate() const;
};

struct ContinuationPoint {
  double s = 0;
  int branch = 0;     // 0: the first curve; 1, 2, ...: those that start at branch points
  Geodesic geodesic;  // without samples
};

// A fold or a branch point, between two points of the list.
struct SpecialPoint {
  double s = 0;
  int branch = 0;  // the curve it is on
  std::vector<double> p0;
  double action = 0;
};

// Where an extremal begins or ceases to keep to a limit.
struct ContactChange {
  double s = 0;
  double error = 0;                 // of s
  std::vector<std::string> before;  // the limits that it keeps to, arc by arc in the order of time
  std::vector<std::string> after;
  double action = 0;
};

enum class ContinuationStatus {
  kReached,   // s = 1
  kReturned,  // back at s = 0, after a fold
  kClosed,    // back at the first point
  kMaxPoints,
  kStepTooSmall,  // no step, however small, leads to another verified point
  kSingular,      // the start is not on a curve: a member of a family, or abnormal
  kNotConverged,  // the start is not near a solution at s = 0
  kInterrupted
};

struct ContinuationReport {
  ContinuationStatus status = ContinuationStatus::kNotConverged;  // of the first curve
  std::string message;                                            // what happened, what to try
  std::vector<ContinuationPoint> points;  // curve by curve, each in its order
  std::vector<SpecialPoint> folds;
  std::vector<SpecialPoint> branch_points;
  std::vector<ContactChange> contact_changes;   // with limits
  std::vector<ContinuationStatus> branch_ends;  // how curve 1, 2, ... ended
  double elapsed_seconds = 0;

  // The curve was followed to an end of the line, or until it closed.
  [[nodiscard]] bool complete() const {
    return status == ContinuationStatus::kReached || status == ContinuationStatus::kReturned ||
           status == ContinuationStatus::kClosed;
  }
};

}  // namespace carnot
