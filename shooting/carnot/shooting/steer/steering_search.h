// The search behind steering: questions in their frame to answers, and answers to points.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/steer/steering_options.h"
#include "carnot/shooting/steer/steering_question.h"

namespace carnot::internal {

// In the frame of the question.
struct SteeringAnswer {
  Reason reason = Reason::kNone;  // where there is no geodesic,
  std::string message;            // and what to try
  std::optional<Geodesic> geodesic;
  std::vector<double> target;  // the image that is reached
  std::vector<double> points;  // kSteeringSamples x 2n phase points at equidistant times
  long steps = 1;              // of the method between two of them

  [[nodiscard]] double distance(const SteeringSense& sense) const {
    if (!geodesic) return std::numeric_limits<double>::infinity();
    return geodesic->length.value_or(geodesic->action) * std::sqrt(sense.contraction);
  }
};

inline constexpr long kSteeringSamples = 33;

class SteeringSearch {
 public:
  // Throws std::invalid_argument on options out of range.
  SteeringSearch(Dynamics dynamics, SteeringOptions options);

  [[nodiscard]] const Dynamics& dynamics() const { return dynamics_; }
  [[nodiscard]] const SteeringOptions& options() const { return options_; }
  // Whether a way back is as long as a way there.
  [[nodiscard]] bool reversible() const {
    return dynamics_.has_transcription() && options_.free_target.empty();
  }

  // Why these cannot be joined at all; empty: they can.
  [[nodiscard]] std::string refusal(std::span<const double> from, std::span<const double> to) const;
  [[nodiscard]] SteeringRules rules() const {
    const std::vector<bool>& free = options_.free_target;
    return {reversible(),
            options_.mod_angles,
            options_.resolution,
            &sizes_,
            free.empty() ? nullptr : &free};
  }
  // Up to `count`, least action first; one without a geodesic where there is none.
  [[nodiscard]] std::vector<std::shared_ptr<const SteeringAnswer>> answers(
      const SteeringQuestion& question, int count) const;
  // See Steering::at().
  [[nodiscard]] bool point(const SteeringAnswer& answer,
                           const SteeringSense& sense,
                           std::span<const double> from,
                           std::span<const double> to,
                           double t,
                           std::span<double> q) const;

 private:
  [[nodiscard]] GeodesicOptions options_of_search(int count) const;
  [[nodiscard]] bool follow(const SteeringAnswer& answer,
                            const SteeringSense& sense,
                            double s,
                            std::vector<double>& z) const;
  void contract(const SteeringAnswer& answer, const SteeringSense& sense, double* q) const;
  [[nodiscard]] static std::vector<Geodesic> solve(const BoundaryValueProblem& problem,
                                                   const GeodesicOptions& options,
                                                   SteeringAnswer& failure);
  void measure_sizes();
  [[nodiscard]] double period_of(int j) const { return dynamics_.info.configuration[j].period; }

  Dynamics dynamics_;
  SteeringOptions options_;
  std::vector<double> sizes_;  // natural scales of the coordinates, the same for all questions
  std::vector<double> rates_;  // of its angles (turn_rates.h)
};

}  // namespace carnot::internal
