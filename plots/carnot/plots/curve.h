// What a picture shows: a trajectory with the numbers that go into its title.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "carnot/flow/reports.h"
#include "carnot/scene/scene_info.h"

namespace carnot::plots {

struct Curve {
  std::string name;  // may be empty
  const Trajectory* trajectory = nullptr;
  double action = 0;
  std::optional<double> length;
  std::vector<std::pair<std::string, double>> extremes;  // named as in SceneInfo::extremes
  std::vector<std::pair<double, double>> on_limits{};    // times between which it keeps to one
};

// "vehicle: name", markup.
std::string heading(const SceneInfo& info, const Curve& curve);
// "action 22.7, length 6.74, largest steering angle 1.3 rad", markup.
std::string numbers_line(const SceneInfo& info, const Curve& curve);
// Markup and unit of coordinate i; q1, q2, ... where the scene gives no name.
std::string coordinate_symbol(const SceneInfo& info, std::size_t i);
std::string coordinate_unit(const SceneInfo& info, std::size_t i);
// At most `rows` rows of a trajectory, evenly spread, ends included.
Trajectory thinned(const Trajectory& trajectory, std::size_t rows);
// Indices of at most `count` rows, evenly spread, ends included.
std::vector<std::size_t> spread(std::size_t rows, std::size_t count);

}  // namespace carnot::plots
