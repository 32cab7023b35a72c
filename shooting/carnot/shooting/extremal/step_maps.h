// The steps of the method along an extremal, with the derivative of each.
//
// Derivatives are in the units of a short extremal (units.h). Whoever follows planes along an
// extremal asks for the same steps several times over, so those of a block are kept.
//
// RATTLE maps (0, Dh') to zero and all else into the tangent space of the manifold. There planes of
// half its dimension are Lagrangian for the form of the manifold, and with (0, Dh') at the same
// point they are Lagrangian in R^2n, for Dh dq = 0. So (0, Dh') before a step is mapped to (0, Dh')
// after it, by which as many phases as there are forces stay at 0.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/problem/units.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// z after a step, which of the last one of a segment is the next knot, and the 2n x 2n matrix that
// maps planes before it to planes after it.
struct StepMap {
  std::vector<double> z;
  Eigen::MatrixXd map;
};

// One step of length h from z at time t on. False where it fails.
bool take_step(const Dynamics& dynamics, const Units& units, double t, double h, StepMap& step);

class StepMaps {
 public:
  // `per_segment` steps from each knot to the next. Keeps references to all of its arguments.
  StepMaps(const BoundaryValueProblem& problem,
           const Units& units,
           const Knots& knots,
           long per_segment);

  // All steps.
  [[nodiscard]] long count() const { return per_segment_ * knots_.segments; }
  // The time after step i, from 0.
  [[nodiscard]] double end(long i) const {
    return problem_.time * static_cast<double>(i + 1) / static_cast<double>(count());
  }
  // Step i. False where it fails, or one before it. In order they cost least.
  [[nodiscard]] bool read(long i, StepMap& step);

 private:
  // Evaluates the block that begins at step `first`, after the block before it.
  void fill(long first);
  // Where step i of the block begins.
  [[nodiscard]] const double* before(long i) const;
  [[nodiscard]] const double* after(long i) const;

  const BoundaryValueProblem& problem_;
  const Units& units_;
  const Knots& knots_;
  long per_segment_;
  long first_ = -1;            // of the block; -1: there is none yet
  long done_ = 0;              // steps of the block, without those from the first that failed on
  std::vector<double> nodes_;  // that before the block, and those after its steps
  std::vector<double> tangents_;
};

// Steps of which so many are joined into one.
class JoinedSteps {
 public:
  // `together` divides the steps of a segment. Keeps a reference to the steps.
  JoinedSteps(StepMaps& steps, int together) : steps_(steps), together_(together) {}

  [[nodiscard]] long count() const { return steps_.count() / together_; }
  [[nodiscard]] double end(long i) const { return steps_.end((i + 1) * together_ - 1); }
  [[nodiscard]] bool read(long i, StepMap& step) const;

 private:
  StepMaps& steps_;
  int together_;
};

}  // namespace carnot::internal
