// What a scene says of itself: names, units, periods, parameters, symmetries, how to draw it.
//
// Everything here is optional for a scene; without it coordinates are called q1, q2, ...
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace carnot {

struct Coordinate {
  std::string name;
  std::string unit;
  double period = 0;  // 0: a line; 2 pi: an angle
};

// An open or closed half line of accepted values.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  bool open = true;

  static constexpr Range positive() { return {0, true}; }
  static constexpr Range non_negative() { return {0, false}; }

  [[nodiscard]] bool contains(double x) const {
    return std::isfinite(x) && (open ? x > lower : x >= lower);
  }
  [[nodiscard]] std::string text() const {
    if (std::isinf(lower)) return "finite";
    std::ostringstream text;
    text << (open ? "> " : ">= ") << lower;
    return text.str();
  }
};

// A parameter as data: where it lives, what it means. A scene lists its own in parameters().
template <class Scene>
struct Parameter {
  const char* name;
  double& (*value)(Scene&);
  const char* unit;
  Range range;
  const char* meaning;
};

// A line through points of the plane, part of a body.
struct Polyline {
  enum class Role { kBody, kWheel };
  Role role = Role::kBody;
  std::vector<std::array<double, 2>> points;
};

// Which coordinates make the picture, and the body at a configuration (plane only).
struct Drawing {
  enum class View { kTimeOnly, kPlane, kSpace };
  View view = View::kTimeOnly;
  std::array<int, 3> axes{0, 1, 2};
  std::function<std::vector<Polyline>(const double* q)> body;
};

// Symmetries of the scene. Reversing time, q(t) -> q(T - t) with p -> -p, is one of every scene
// with velocity constraints and needs no word.
struct Symmetries {
  // Diagonal of a linear map q -> D q that leaves H invariant together with p -> D p.
  std::vector<std::vector<double>> mirrors;
  // Rigid motions of the plane move the coordinates x, y and turn all the angles.
  int x = -1;
  int y = -1;
  std::vector<int> angles;
  // Other coordinates that H does not depend on.
  std::vector<int> cyclic{};
};

// A number worth reporting of a whole path: the largest |value(q)|.
struct Extreme {
  std::string name;
  std::string unit;
  std::function<double(const double* q)> value;
};

struct SceneInfo {
  std::string name;
  std::string summary;
  std::string kind = "velocity constraints";
  std::string reference;
  std::vector<Coordinate> configuration;
  Symmetries symmetries;
  Drawing drawing;
  std::vector<Extreme> extremes;
};

template <class Scene>
concept HasInfo = requires(const Scene& scene) {
  scene.info();
};

template <class Scene>
concept HasParameters = requires {
  Scene::parameters();
};

// The scene's own description, or q1, ..., qn.
template <class Scene>
SceneInfo describe_scene(const Scene& scene) {
  SceneInfo info;
  if constexpr (HasInfo<Scene>) {
    info = scene.info();
  } else {
    info.name = "scene";
    for (int i = 0; i < Scene::kDof; ++i) {
      info.configuration.push_back({"q" + std::to_string(i + 1), "", 0});
    }
  }
  return info;
}

// Throws std::invalid_argument naming the parameter that is out of its range.
template <class Scene>
void validate(Scene scene) {
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      const double value = parameter.value(scene);
      if (!parameter.range.contains(value)) {
        throw std::invalid_argument("parameter " + std::string(parameter.name) + " = " +
                                    std::to_string(value) + " must be " + parameter.range.text());
      }
    }
  }
}

}  // namespace carnot
