// q(t), p(t), lambda(t) and the energy error over time, stacked, one column per curve.
#pragma once

#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"

namespace carnot::plots {

struct TimePanels {
  bool configuration = true;
  bool momentum = true;
  bool multipliers = true;  // left out where the scene has none
  bool energy = true;
};

// The panels of one curve, filling `box` inside; legends go to its right.
void draw_time_panels(Script& script,
                      const Picture& page,
                      const SceneInfo& info,
                      const Curve& curve,
                      const Box& box,
                      const TimePanels& panels);
std::size_t count_panels(const Curve& curve, const TimePanels& panels);

// Whole pages: all the panels, or the energy error of all the curves in one.
Picture time_picture(const SceneInfo& info, const std::vector<Curve>& curves);
Picture energy_picture(const SceneInfo& info, const std::vector<Curve>& curves);

}  // namespace carnot::plots
