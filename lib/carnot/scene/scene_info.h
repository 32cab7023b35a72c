// What a scene says of itself: names, units, periods, parameters, symmetries, how to draw it.
//
// Everything here is optional for a scene. Without it the scene is called like its type, and its
// coordinates are called q1, q2, ...
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/scene/limit.h"

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
  double Scene::*value;
  const char* unit;
  Range range;
  const char* meaning;
};

// A line through points of the plane, part of a body. It is closed where its last point is its
// first. A wheel of two points, the ends of its diameter as seen from above, is drawn as a narrow
// rectangle. body.h makes the usual parts.
struct Polyline {
  enum class Role { kBody, kWheel };
  Role role = Role::kBody;
  std::vector<std::array<double, 2>> points;
};

// A line through points of space, part of a body.
struct SpaceLine {
  std::vector<std::array<double, 3>> points;
};

// How the scene is drawn: which point makes the path, and the body at a configuration. Functions
// get the kDof numbers of q and return lengths in the units of the axes; empty ones draw nothing.
struct Drawing {
  enum class View { kTimeOnly, kPlane, kSpace };
  // A point of space as a function of q, with the names and units of its coordinates.
  struct Place {
    std::array<Coordinate, 3> coordinates;
    std::function<std::array<double, 3>(const double* q)> at;
  };
  View view = View::kTimeOnly;
  std::array<int, 3> axes{0, 1, 2};  // the coordinates drawn; the third one only in space
  std::function<std::vector<Polyline>(const double* q)> body{};            // in the plane
  std::function<std::vector<SpaceLine>(const double* q)> body_in_space{};  // in space
  Place place{};        // in space, instead of the coordinates in `axes`
  double sphere = 0;    // the path lies on a sphere of this radius about the origin; 0: on none
  std::string path{};   // what moves along the path, for the legend; empty: the coordinates
  std::string glyph{};  // what the body is, for the legend; empty: it needs no word
};

// Symmetries of the scene. Reversing time, q(t) -> q(T - t) with p -> -p, is one of every scene
// with velocity constraints and needs no word.
struct Symmetries {
  // Diagonal of a linear map q -> D q that leaves H invariant together with p -> D p.
  std::vector<std::vector<double>> mirrors{};
  // Rigid motions of the plane move the coordinates x, y and turn all the angles.
  int x = -1;
  int y = -1;
  std::vector<int> angles{};
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
  std::string kind;  // set by describe_scene()
  std::string reference;
  std::vector<Coordinate> configuration;
  Symmetries symmetries;
  Drawing drawing;
  std::vector<Extreme> extremes;
  std::vector<Limit> limits;
};

template <class Scene>
concept HasInfo = requires(const Scene& scene) {
  scene.info();
};

template <class Scene>
concept HasParameters = requires {
  Scene::parameters();
};

// Throws std::invalid_argument naming the parameter that is out of its range.
template <class Scene>
void validate(Scene scene) {
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      const double value = scene.*parameter.value;
      if (!parameter.range.contains(value)) {
        throw std::invalid_argument("parameter " + std::string(parameter.name) + " = " +
                                    std::to_string(value) + " must be " + parameter.range.text());
      }
    }
  }
}

}  // namespace carnot
