// Runs for `carnot paper`: a scene and a method by name, the flow recorded, lines fitted.
#pragma once

#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/laws/tangent_map.h"
#include "carnot/numerics/line_fit.h"

namespace carnot::apps {

inline constexpr double kEps = std::numeric_limits<double>::epsilon();
inline constexpr double kPi = std::numbers::pi;

// The scene with its default parameters.
Dynamics paper_dynamics(const std::string& scene, const std::string& method);

// Does the runs and tells `progress` of the steps done, of `total` in all. A run that fails or is
// stopped throws std::runtime_error with the reason.
class PaperWork {
 public:
  PaperWork(Progress progress, double total);

  // Advances z; `samples` equidistant times are recorded.
  FlowSummary flow(const Dynamics& dynamics,
                   const StepPlan& plan,
                   std::vector<double>& z,
                   long samples = 0);
  TangentMap tangent(const Dynamics& dynamics, const StepPlan& plan, const std::vector<double>& z);

  [[nodiscard]] double steps() const { return steps_; }

 private:
  [[nodiscard]] Progress part(double steps) const;
  void finish(const Dynamics& dynamics, const FlowReport& report, double steps);

  Progress progress_;
  double total_;
  double steps_ = 0;
};

// (q, p) of a row of a trajectory.
std::vector<double> phase_point(const Trajectory& trajectory, std::size_t row);

double max_distance(const std::vector<double>& a, const std::vector<double>& b);

// Slope of log(y) over x, from the first to the last y in [lower, upper].
LineFit fit_growth(const std::vector<double>& x,
                   const std::vector<double>& y,
                   double lower,
                   double upper);

}  // namespace carnot::apps
