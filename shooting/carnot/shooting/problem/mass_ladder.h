// A problem in which something light may move freely, by way of heavier ones.
//
// Where the kinetic energy hardly weighs a coordinate, such as the angle of a light steering axle,
// an extremal changes it almost at once. The layers in which it does so last a part of the time
// that is in proportion to the root of its mass. A coarse grid does not resolve them, and what it
// finds are mostly artefacts. So such a problem stands at the foot of a ladder of problems. On each
// rung the least mass is four times that of the rung below, up to that of a problem for which a
// coarse grid will do. A path that begins on a rung goes down one rung whenever its step is halved.
// Thus its layers, which become thinner by half, last as many intervals as before.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

class MassLadder {
 public:
  // Of a problem in its natural scales (natural_scales.h), in which a mass of one is as much as
  // others have. Keeps a reference to it. Cost: n evaluations of the scene.
  explicit MassLadder(const BoundaryValueProblem& problem);

  // How many rungs there are above the problem: none where nothing is light.
  [[nodiscard]] int height() const { return static_cast<int>(heavier_.size()); }
  // The problem on a rung, from 0, the problem itself, to height(). Those above it are good for
  // paths only: they have a transcription, and no flow.
  [[nodiscard]] const BoundaryValueProblem& on(int rung) const {
    return rung == 0 ? problem_ : heavier_[rung - 1];
  }
  // Between a rung above the problem, share 0, and the one below, share 1.
  [[nodiscard]] BoundaryValueProblem below(int rung, double share) const;
  // The lowest rung whose layers last as many intervals, of so many, as on the coarsest grid at the
  // top.
  [[nodiscard]] int rung_for(int intervals) const;
  // The rung on which start number `start` begins on a grid of so many intervals.
  [[nodiscard]] int rung_of(int start, int intervals) const;

 private:
  // The least mass on a rung, or between two.
  [[nodiscard]] double least_on(double rung) const;
  // The same problem with no free mass below `least`.
  [[nodiscard]] BoundaryValueProblem with_masses_from(double least) const;

  const BoundaryValueProblem& problem_;
  std::vector<double> masses_;  // of coordinates that may move freely; zero for others
  double lightest_ = 1;         // of these, where it is light
  std::vector<BoundaryValueProblem> heavier_;
};

}  // namespace carnot::internal
