// Steps along one curve of solutions, and what is seen on the way.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "carnot/shooting/continue/continuation_report.h"
#include "carnot/shooting/continue/solution_curve.h"
#include "carnot/shooting/extremal/verification.h"

namespace carnot::internal {

// A solution at s, in units of the scene.
struct Place {
  Knots knots;
  double s = 0;
};

// A branch point, with a place on either arm of the other curve where Newton's method leads there.
struct Crossing {
  Place point;
  std::vector<Place> arms;
};

class CurveTracer {
 public:
  // Keeps references to all of them; adds its points to the report. `steps` of the method.
  CurveTracer(const ProblemLine& line,
              const ContinuationOptions& options,
              long steps,
              int branch,
              ContinuationReport& report)
      : line_(line), options_(options), steps_(steps), branch_(branch), report_(report) {}

  // From near `start` towards larger s or, where given, away from `origin`.
  [[nodiscard]] ContinuationStatus trace(const Place& start, const Place* origin = nullptr);

  [[nodiscard]] const std::vector<Crossing>& crossings() const { return crossings_; }

 private:
  // A point that a step leads to, and how the curve ends there, if it does.
  struct Step {
    CurvePoint point;
    double angle = 0;  // between the tangents, radians
    std::optional<ContinuationStatus> end;
  };

  // Equations with scales, knots and steps that suit the place, and the point there. `along` is a
  // rate of (p(0), s) that tells the direction.
  [[nodiscard]] bool set_up(Place place, const Eigen::VectorXd& along);
  // The same at the present point where its scales, knots or steps no longer suit.
  [[nodiscard]] bool renew();
  [[nodiscard]] bool advance(std::optional<ContinuationStatus>& end);
  [[nodiscard]] std::optional<Step> attempt(double length);
  // Where a step leads to second order.
  [[nodiscard]] Eigen::VectorXd predicted(double length) const;
  // A step that closes the curve, where its first point is near.
  [[nodiscard]] std::optional<Step> close(double length);
  [[nodiscard]] std::optional<Step> finish(const Eigen::VectorXd& x,
                                           const Eigen::VectorXd& row,
                                           double length,
                                           std::optional<ContinuationStatus> end);
  // Verifies a point, labels it and adds it to the list.
  [[nodiscard]] bool add(const CurvePoint& point);
  void note_special_points(const CurvePoint& before, const CurvePoint& after);
  // A branch point of even multiplicity between the point before `here_` and the one after.
  void note_touch(const CurvePoint& after);
  void note_crossing(const CurvePoint& before, const Eigen::VectorXd& x);
  [[nodiscard]] SpecialPoint describe(const Eigen::VectorXd& x) const;
  [[nodiscard]] Place place_of(const Eigen::VectorXd& x) const;

  const ProblemLine& line_;
  const ContinuationOptions& options_;
  long steps_;
  int branch_;
  ContinuationReport& report_;
  std::unique_ptr<LineEquations> equations_;
  std::unique_ptr<SolutionCurve> curve_;
  CurvePoint here_;
  std::optional<CurvePoint> last_;  // before here_, unless scales or knots have changed since
  Eigen::VectorXd curvature_;       // rate of the tangent, as of the last step
  Eigen::VectorXd first_;           // (p(0), s) at the start,
  Eigen::VectorXd first_rate_;      // and its rate
  const Place* origin_ = nullptr;
  double step_ = 0;
  double largest_momentum_ = 0;
  int taken_ = 0;
  std::vector<Crossing> crossings_;
};

}  // namespace carnot::internal
