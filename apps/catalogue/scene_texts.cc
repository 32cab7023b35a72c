#include "catalogue/scene_texts.h"

#include <fmt/format.h>

#include "text/numbers.h"

namespace carnot::apps {

std::string text_of_scene(const SceneEntry& entry) {
  if (!entry.text.empty()) return entry.text;
  std::vector<std::string_view> names;
  for (const SceneText& known : scene_texts()) {
    if (known.name == entry.info.name) return std::string(known.text);
    names.push_back(known.name);
  }
  refuse("--text",
         entry.info.name,
         "this scene has no text",
         fmt::format("{}", fmt::join(names, ", ")));
}

std::string new_scene_text(const std::string& name) {
  constexpr std::string_view kText =
      R"(# NAME.scene: a robot that pulls a trailer (say here what yours is)
#
# One statement a line; docs/scene_language.md has all of them. Try
#   carnot scenes NAME.scene
#   carnot geodesic NAME.scene --from 0,0,0,0 --to 0,1,0,0 --plot NAME.png

# The configuration. A unit holds for the names before it; angles have the period 2 pi.
coordinates x, y [length], theta, psi [angle]

# Name, default, unit, range; --set rod=2 changes one.
parameters rod = 1 [length] > 0 "from the robot to the axle of the trailer"
parameters turning = 1 [length^2] > 0 "what turning costs against driving"

# What a path makes stationary: x' is the velocity of x.
kinetic = (x'^2 + y'^2 + turning theta'^2) / 2

# What velocities obey: no wheel slips sideways.
0 = x' sin(theta) - y' cos(theta)
0 = x' sin(psi) - y' cos(psi) + rod psi'

# How it is drawn, and what is reported of a path: the largest absolute value.
let tx = x - rod cos(psi)
let ty = y - rod sin(psi)
draw box((x, y), theta, rod / 2, rod / 3)
draw (x, y) -- (tx, ty)
draw box((tx, ty), psi, rod / 2, rod / 3)
draw wheel((tx, ty), psi, rod / 8)
report hinge [angle] = theta - psi
)";
  std::string text(kText);
  for (std::size_t at = text.find("NAME"); at != std::string::npos; at = text.find("NAME", at)) {
    text.replace(at, 4, name);
    at += name.size();
  }
  return text;
}

}  // namespace carnot::apps
