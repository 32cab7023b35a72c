// From a discrete extremal with limits on a coarse grid to a geodesic.
//
// The grid is refined while mu is lowered. As soon as the multipliers tell where the path keeps to
// which wall, pieces are joined (bound_arcs.h), checked, and measured. Where they never join, the
// path on the finest grid is the answer.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/search/limited_problem.h"
#include "carnot/shooting/shoot/bound_arcs.h"

namespace carnot::internal {

// mu on the first grid. A wall that is met at a point pins the path to a node where mu is small,
// and every node is a minimum of its own. With 1e-6 and 64 intervals the four least of 48 starts
// for a vehicle that passes a disc were four such minima, of actions from 22.50 to 22.64, where the
// extremal has 22.52. With 1e-3 the wall acts on several nodes.
constexpr double kFirstGridMu = 1e-3;

// A discrete extremal with limits, of the problem on the rung of its path (mass_ladder.h).
struct Candidate {
  LimitedPath limited;
  double action = std::numeric_limits<double>::infinity();
  double mu = kFirstGridMu;
  int hits = 1;
  int halvings = 0;  // of the step, since its first grid
  bool minimum = false;
  bool tried = false;  // to finish it
};

struct LimitedExtremal {
  Geodesic geodesic;
  std::optional<BoundExtremal> pieces;  // where they were joined; nothing on the grid
};

class LimitedFinish {
 public:
  // Keeps references.
  LimitedFinish(const LimitedProblem& shared, const GeodesicOptions& options)
      : shared_(shared), options_(options) {}

  // From `near`, on its grid and its rung, and from the candidate's mu down to another; sets the
  // candidate where that succeeds.
  [[nodiscard]] bool solve(LimitedPath near, double last_mu, Candidate& candidate) const;
  // The candidate on the grid of half the step, and one rung down. False where there is none.
  [[nodiscard]] bool refine(Candidate& candidate, double last_mu) const;

  // Nothing where the candidate has no counterpart on finer grids, or is beyond a limit; or where
  // the caller asked to stop.
  [[nodiscard]] std::optional<LimitedExtremal> finish(Candidate candidate,
                                                      const Stop& stop = {}) const;

  // The extremal whose pieces are near these, with the same contacts; its label is not known.
  // Nothing where there is none, or where it is beyond a limit or pulled by one.
  [[nodiscard]] std::optional<LimitedExtremal> with_contacts_of(const BoundExtremal& near) const;

  // The extremal of the problem without limits near some knots. Nothing where there is none, or
  // where it does not keep to the limits.
  [[nodiscard]] std::optional<LimitedExtremal> without_contact(Knots knots) const;

 private:
  // The candidate with less mu, on the same grid. False where there is none.
  [[nodiscard]] bool sharpen(Candidate& candidate, double last_mu) const;
  [[nodiscard]] bool settle(Candidate& candidate) const;
  [[nodiscard]] static std::vector<std::vector<double>> points_along(const Path& path);
  // The pieces of a candidate joined, where that succeeds; on the first grid on which it is tried,
  // level 1, or on a finer one.
  [[nodiscard]] std::optional<LimitedExtremal> joined(const Candidate& candidate, int level) const;
  [[nodiscard]] std::optional<LimitedExtremal> by_flow(Knots knots) const;
  [[nodiscard]] Geodesic on_grid(const Candidate& candidate, double coarse_action) const;
  void add_extremes(const std::vector<std::vector<double>>& q, Geodesic& geodesic) const;

  const LimitedProblem& shared_;
  const GeodesicOptions& options_;
};

}  // namespace carnot::internal
