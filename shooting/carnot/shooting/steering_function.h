// Steering for planners: the geodesic between two configurations as a distance and a path.
//
//   const SteeringFunction steer(make_dynamics(scenes::Unicycle{}));
//   const double d = steer.distance(a, b);                  // infinite where none was found
//   if (steer.interpolate(a, b, 0.5, q)) use(q);            // half-way in time
//   for (const Steering& way : steer.alternatives(a, b)) use(way.distance());
//
// Where the scene says that rigid motions of the plane are symmetries, a question is moved to the
// origin first; where time may be reversed, the lesser of a -> b and b -> a is the one that is
// solved. So distance(a, b) = distance(b, a) to the last digit, and the path back is the path run
// backwards. Equal configurations have the distance 0; those that differ by less than the round-off
// of their coordinates count as equal. On a cut locus two ways are equally long: the distance is
// continuous there, the path is not.
//
// Cost: a new question is a search (geodesic.h), some 10 to 200 ms, in proportion to
// SteeringOptions::starts and to the images of the target with `mod_angles`. Answers are kept: the
// same question again takes about 1 us, a point of its path a step or two of the method more, and
// neither allocates. All calls may come from many threads at once; the answer is the same whatever
// was asked before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/reason.h"
#include "carnot/shooting/steer/steering_options.h"

namespace carnot {

// One way from a to b, or the reason why there is none. Cheap to copy.
class Steering {
 public:
  [[nodiscard]] bool found() const;
  // Why there is none, as a code, and in words with what to try; kNone and empty where there is
  // one.
  [[nodiscard]] Reason reason() const;
  [[nodiscard]] const std::string& message() const;
  // The length, or the action where the scene has no length; infinite where nothing was found.
  [[nodiscard]] double distance() const;
  // What is known of it, in the frame and the direction that were solved and before a contraction;
  // null where nothing was found. Without a trajectory.
  [[nodiscard]] const Geodesic* geodesic() const;
  // q at the time t T, t in [0, 1]: exactly `from` at 0 and, up to whole periods of the angles,
  // which turn continuously, exactly `to` at 1. False, and q is untouched, where there is none.
  [[nodiscard]] bool at(double t, std::span<double> q) const;

 private:
  friend class SteeringFunction;
  struct Way;
  explicit Steering(std::shared_ptr<const Way> way);

  std::shared_ptr<const Way> way_;
};

class SteeringFunction {
 public:
  // Throws std::invalid_argument on options out of range.
  explicit SteeringFunction(Dynamics dynamics, const SteeringOptions& options = {});

  [[nodiscard]] int dof() const;
  [[nodiscard]] const SteeringOptions& options() const;
  [[nodiscard]] const SceneInfo& info() const;
  // Whether distance(a, b) = distance(b, a).
  [[nodiscard]] bool symmetric() const;

  // The way of least action. Wrong lengths and values that are not finite are failures, too.
  [[nodiscard]] Steering steer(std::span<const double> from, std::span<const double> to) const;
  // steer().distance() and steer().at(), without an allocation where the answer is known.
  [[nodiscard]] double distance(std::span<const double> from, std::span<const double> to) const;
  [[nodiscard]] bool interpolate(std::span<const double> from,
                                 std::span<const double> to,
                                 double t,
                                 std::span<double> q) const;
  // Up to `count` ways, least action first; one that failed where there is none. They are not kept,
  // and cost several times as much as steer().
  [[nodiscard]] std::vector<Steering> alternatives(std::span<const double> from,
                                                   std::span<const double> to,
                                                   int count = 8) const;

 private:
  class Implementation;
  std::shared_ptr<const Implementation> own_;
};

}  // namespace carnot
