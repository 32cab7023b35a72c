// A question of steering in its own frame: what does not matter for the answer is taken away.
//
// Rigid motions of the plane, where they are symmetries, move the start to the origin with its
// first angle 0; where time may be reversed, the lesser of the question and its reverse stands for
// both. A target nearer than `resolution` is moved away to there, and the answer is contracted.
// Coordinates of the target that are free are those of the start.
#pragma once

#include <span>
#include <vector>

#include "carnot/scene/scene_info.h"

namespace carnot::internal {

// What holds for all questions.
struct SteeringRules {
  bool reversible = true;
  bool mod_angles = true;
  double resolution = 0;                           // Euclidean norm of to - from, over the sizes
  const std::vector<double>* sizes = nullptr;      // of each coordinate; null: one
  const std::vector<bool>* free_target = nullptr;  // null: none is free

  [[nodiscard]] bool is_free(std::size_t j) const {
    return free_target != nullptr && (*free_target)[j];
  }
  [[nodiscard]] double size(std::size_t j) const { return sizes != nullptr ? (*sizes)[j] : 1; }
};

// From the answer in the frame back to what was asked.
struct SteeringSense {
  bool reversed = false;   // the target of the frame is the start of what was asked
  double contraction = 1;  // towards the start of the frame; 0 where only round-off moves it
};

struct SteeringQuestion {
  std::vector<double> ends;  // start and target in the frame, 2n; no -0, equal ones have equal bits
  SteeringSense sense;

  // No allocation where `ends` has been used before.
  void ask(const SceneInfo& info,
           const SteeringRules& rules,
           std::span<const double> from,
           std::span<const double> to);
};

// Takes q, in the frame where `origin` is at the origin, back to where `origin` is.
void leave_frame(const SceneInfo& info, const double* origin, double* q);

}  // namespace carnot::internal
