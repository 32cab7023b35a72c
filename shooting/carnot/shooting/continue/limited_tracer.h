// Continuation of an extremal that keeps to limits.
//
// Along the line arcs on limits appear, grow, part and vanish, and each such change is a change of
// the equations (bound_arcs.h). So s only goes up, and each point is looked for in three ways.
// First the pieces of the point before, carried on by the secant, are joined. Where they do not
// join, or are beyond a limit or pulled by one, its path is solved on a grid by the interior point
// method and finished as in a search (limited_finish.h), which tells anew where the path keeps to
// which limit. A path without contact is shot for directly. A step is taken where the path hardly
// departs from the secant, and shortened where it does, or where no extremal is found. So a branch
// that ends is said to end, and is not left for another one in silence.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "carnot/shooting/continue/continuation_report.h"
#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/problem/problem_line.h"
#include "carnot/shooting/search/limited_finish.h"
#include "carnot/shooting/search/limited_problem.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

class LimitedTracer {
 public:
  // Keeps references to all of them; adds its points and changes of contact to the report.
  LimitedTracer(const ProblemLine& line,
                const ContinuationOptions& options,
                ContinuationReport& report);

  // From an extremal of line.at(0) with limits, which has 64 k + 1 samples.
  [[nodiscard]] ContinuationStatus trace(const Geodesic& start);

  // Why it stopped before s = 1; empty: nothing more is known.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

 private:
  struct Point {
    double s = 0;
    Knots knots;  // at kIntervals + 1 equidistant times
    std::optional<BoundExtremal> pieces;
    Geodesic geodesic;  // without samples
  };
  static constexpr int kIntervals = 256;

  // The extremal at s near another one, or near a guess; nothing where there is none.
  [[nodiscard]] std::optional<Point> solve(double s, const Point& near);
  // What knots lead to on a first grid of so many intervals, near or not.
  [[nodiscard]] std::optional<LimitedExtremal> solve_on(const LimitedProblem& shared,
                                                        const Knots& near,
                                                        int intervals) const;
  // Whether a grid finds a minimum there.
  [[nodiscard]] static bool is_minimum(const LimitedProblem& shared, const Knots& knots);
  // Where the line through two points leads.
  [[nodiscard]] static Point on_secant(const Point& a, const Point& b, double s);
  // Where between two points the contacts change.
  void note_changes(Point before, const Point& after);

  const ProblemLine& line_;
  const ContinuationOptions& options_;
  ContinuationReport& report_;
  GeodesicOptions finishing_;
  Point here_;
  std::string trouble_;
};

}  // namespace carnot::internal
