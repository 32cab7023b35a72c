// How long an extremal is a shortest path.
//
// From a point every extremal is the shortest way at first. It stops being so at its cut time, the
// first of
//
//   its first conjugate time, from which on neighbours are shorter, and
//   the first time at which another extremal arrives at the same place and is as long.
//
// Once it is not the shortest it never is again: so a search tells on which side of the cut time a
// time is. What is shorter there is followed back to where both are equally long, by continuation
// and Newton's method (rays/meeting.h), and a search just before tells whether anything was
// missed.
//
//   const CutTime cut = cut_time(make_dynamics(scenes::Unicycle{}), {0, 0, 0}, {0.5, 0.4, 0.8});
//   if (cut.cut_time) use(*cut.cut_time, cut.label);
//
// Cost: two to ten searches (find_geodesics.h). All symmetries are only looked at in the end, to
// name what makes the pair.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot {

struct CutTimeOptions {
  // How far the extremal is followed, in time; 0: kNaturalHorizon natural lengths of the scene,
  // what a radian is worth or 1 where there are no angles, or a few turns of the extremal where
  // that is more.
  double max_time = 0;
  bool mod_angles = true;  // angles that agree modulo their periods are one place
  // 1 or -1 for each coordinate: places that these signs take to each other are one, such as the
  // quaternions q and -q. The scene is to be the same there. Empty: none are.
  std::vector<double> signs{};
  std::uint64_t seed = 0;
  int threads = 0;                                              // 0: all cores
  double time_limit = std::numeric_limits<double>::infinity();  // in seconds
  Progress progress;                                            // returns false to stop
};

inline constexpr double kNaturalHorizon = 64;

// How the search for a cut time ended.
enum class CutStatus {
  kConverged,     // cut_time is known, or the extremal is the shortest up to max_time
  kNotConverged,  // no: see the message
  kInterrupted,
};

struct CutTime {
  CutStatus status = CutStatus::kNotConverged;
  std::string message;
  std::optional<double> cut_time;
  std::optional<double> conjugate_time;  // the first one up to max_time; not of abnormal extremals
  std::optional<std::vector<double>> partner_p0;  // with the same H; nothing where a family arrives
  // What takes the extremal to its partner: "mirror", "reversal" or "mirror and reversal" where the
  // scene says that these are symmetries, "none" where neither does it; "conjugate" where the cut
  // time is the conjugate time; "none-found" where there is none up to max_time.
  std::string label = "none-found";
  double max_time = 0;
  double error = 0;  // of cut_time, by what halving the steps changes
  int searches = 0;
  double elapsed_seconds = 0;
};

// Of the extremal that starts at `from` with momentum p0, both of length n. Throws
// std::invalid_argument on bad input, and for scenes whose H is not quadratic in p: with drift, a
// potential or the time in it.
CutTime cut_time(const Dynamics& dynamics,
                 const std::vector<double>& from,
                 const std::vector<double>& p0,
                 const CutTimeOptions& options = {});

// Throws std::invalid_argument unless these are signs as in CutTimeOptions, or nothing, and the
// scene moves alike where they are changed.
void check_signs(const Dynamics& dynamics,
                 const std::vector<double>& from,
                 const std::vector<double>& signs);

}  // namespace carnot
