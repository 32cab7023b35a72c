// A scene as its text says it: names, formulas in a graph, and what to draw. Nothing is derived
// yet.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "carnot/language/expression.h"
#include "carnot/language/text_error.h"
#include "carnot/language/variables.h"
#include "carnot/scene/scene_info.h"

namespace carnot::language {

struct ParameterSource {
  std::string name;
  double value = 0;
  double default_value = 0;
  std::string unit;
  Range range{};
  std::string meaning;
};

// A formula, and where it is written.
struct Formula {
  Expression expression;
  Place place;
};

// Row by row.
struct MatrixFormula {
  int rows = 0;
  int columns = 0;
  std::vector<Expression> entries;
  Place place;
  [[nodiscard]] const Expression& operator()(int i, int j) const {
    return entries[i * columns + j];
  }
};

// q -> the formulas, which the text claims to be a symmetry.
struct SymmetrySource {
  std::vector<int> coordinates;
  std::vector<Expression> images;
  Place place;
};

// A line through points of two or three coordinates each, or a wheel or a box: its centre, heading
// and sizes.
struct DrawingSource {
  enum class Shape { kLine, kWheel, kBox };
  Shape shape = Shape::kLine;
  std::vector<std::vector<Expression>> points;
  std::vector<Expression> sizes;
  Place place;
};

struct ReportSource {
  std::string name;
  std::string unit;
  std::vector<Expression> values;  // the largest of them counts
};

// lower <= value <= upper.
struct LimitSource {
  std::string name;
  Expression value;
  double lower = 0;
  double upper = 0;
  Place place;
  std::optional<std::array<double, 3>> disc;  // centre and radius, where it keeps out of one
};

// A point of the body in the plane, which discs keep away from.
struct PointSource {
  std::string name;
  std::vector<Expression> at;
};

struct SceneSource {
  std::unique_ptr<Graph> graph;
  std::string name;
  std::string summary;
  std::string reference;
  std::vector<Coordinate> coordinates;
  std::vector<ParameterSource> parameters;
  std::vector<std::string> controls;
  std::optional<Formula> kinetic;
  std::optional<Formula> potential;
  std::optional<Formula> lagrangian;
  std::optional<Formula> hamiltonian;
  std::optional<Formula> cost;
  std::optional<Formula> chart;
  std::optional<MatrixFormula> mass;
  std::optional<MatrixFormula> structure;
  std::optional<MatrixFormula> basis;
  std::vector<Formula> rows;                          // each is zero
  std::vector<std::optional<Formula>> dynamics;       // of each coordinate, with controls
  std::vector<std::pair<Expression, Formula>> guess;  // of controls or velocities, of t, q, p
  std::vector<SymmetrySource> symmetries;
  std::vector<DrawingSource> drawing;
  std::vector<ReportSource> reports;
  std::optional<std::vector<Expression>> path;  // the point that is drawn
  std::vector<LimitSource> limits;
  std::vector<PointSource> points;

  [[nodiscard]] int dof() const { return static_cast<int>(coordinates.size()); }
};

// Parameters by name; those left out keep their default.
using ParameterSettings = std::map<std::string, double>;

// Reads a text; parameters are folded into the formulas as constants. `name` is that of the scene
// where the text gives none, `file` is what errors call the text. Throws TextError, and
// std::invalid_argument for settings that the scene does not have or that are out of range.
SceneSource read_scene(std::string_view text,
                       const std::string& name,
                       const std::string& file,
                       const ParameterSettings& settings = {});

// A TextError at a place of the text.
[[noreturn]] void refuse_text(std::string_view text,
                              const std::string& file,
                              const Place& place,
                              const std::string& what);

}  // namespace carnot::language
