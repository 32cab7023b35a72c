#include "carnot/language/describe_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "carnot/language/tape.h"
#include "carnot/scene/body.h"

namespace carnot::language {
namespace {

int named(const std::vector<Coordinate>& coordinates, const std::string& name) {
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    if (coordinates[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

// The coordinates that are drawn: those called x, y and z, or else the first ones that are no
// angles.
std::vector<int> places(const std::vector<Coordinate>& coordinates) {
  std::vector<int> found;
  for (const char* const name : {"x", "y", "z"}) {
    if (const int i = named(coordinates, name); i >= 0) found.push_back(i);
  }
  if (found.size() >= 2) return found;
  found.clear();
  for (std::size_t i = 0; i < coordinates.size() && found.size() < 3; ++i) {
    if (!is_angle(coordinates[i])) found.push_back(static_cast<int>(i));
  }
  return found;
}

Tape tape_of(const SceneSource& scene, const std::vector<Expression>& expressions) {
  const std::array<Block, 1> inputs{first_of(kConfiguration, scene.dof())};
  const std::array<int, 1> outputs{static_cast<int>(expressions.size())};
  return {*scene.graph, inputs, expressions, outputs};
}

// All numbers of what is drawn come from one tape; `count` of them.
struct Numbers {
  std::shared_ptr<const Tape> tape;
  std::size_t count = 0;
  [[nodiscard]] std::vector<double> at(const double* q) const {
    std::vector<double> values(count);
    tape->run(std::array<const double*, 1>{q}, std::array<double*, 1>{values.data()});
    return values;
  }
};

Numbers numbers(const SceneSource& scene, const std::vector<Expression>& expressions) {
  return {std::make_shared<const Tape>(tape_of(scene, expressions)), expressions.size()};
}

void draw_in_plane(const SceneSource& scene, Drawing& drawing) {
  std::vector<Expression> all;
  struct Part {
    DrawingSource::Shape shape;
    std::size_t points;
  };
  std::vector<Part> parts;
  for (const DrawingSource& source : scene.drawing) {
    if (source.points[0].size() != 2) continue;
    for (const auto& point : source.points) all.insert(all.end(), point.begin(), point.end());
    all.insert(all.end(), source.sizes.begin(), source.sizes.end());
    parts.push_back({source.shape, source.points.size()});
  }
  if (parts.empty()) return;
  drawing.body = [of = numbers(scene, all), parts](const double* q) {
    const std::vector<double> values = of.at(q);
    const double* next = values.data();
    std::vector<Polyline> lines;
    for (const Part& part : parts) {
      const std::array<double, 2> centre{next[0], next[1]};
      if (part.shape == DrawingSource::Shape::kWheel) {
        lines.push_back(wheel(centre, next[2], next[3]));
        next += 4;
      } else if (part.shape == DrawingSource::Shape::kBox) {
        lines.push_back(rectangle(centre, next[2], next[3], next[4]));
        next += 5;
      } else {
        Polyline line;
        for (std::size_t i = 0; i < part.points; ++i, next += 2) {
          line.points.push_back({next[0], next[1]});
        }
        lines.push_back(std::move(line));
      }
    }
    return lines;
  };
}

void draw_in_space(const SceneSource& scene, Drawing& drawing) {
  std::vector<Expression> all;
  std::vector<std::size_t> sizes;
  for (const DrawingSource& source : scene.drawing) {
    if (source.points[0].size() != 3) continue;
    for (const auto& point : source.points) all.insert(all.end(), point.begin(), point.end());
    sizes.push_back(source.points.size());
  }
  if (sizes.empty()) return;
  drawing.body_in_space = [of = numbers(scene, all), sizes](const double* q) {
    const std::vector<double> values = of.at(q);
    const double* next = values.data();
    std::vector<SpaceLine> lines;
    for (const std::size_t size : sizes) {
      SpaceLine line;
      for (std::size_t i = 0; i < size; ++i, next += 3) {
        line.points.push_back({next[0], next[1], next[2]});
      }
      lines.push_back(std::move(line));
    }
    return lines;
  };
}

Limit limit_of(const SceneSource& scene, const LimitSource& source) {
  const int n = scene.dof();
  Graph& graph = *scene.graph;
  std::vector<Expression> all{source.value};
  for (int i = 0; i < n; ++i) {
    all.push_back(graph.derivative(source.value, kConfiguration.first + i));
  }
  for (int i = 0; i < n * n; ++i) {
    all.push_back(graph.derivative(all[1 + i / n], kConfiguration.first + i % n));
  }
  Limit limit;
  limit.name = source.name;
  limit.lower = source.lower;
  limit.upper = source.upper;
  if (source.disc) {
    const auto& [x, y, radius] = *source.disc;
    limit.outline = circle_outline({x, y}, radius);
    limit.radius = radius;
  }
  limit.value = [of = numbers(scene, all), n](const double* q, double* gradient, double* hessian) {
    const std::vector<double> values = of.at(q);
    if (gradient != nullptr) std::copy_n(values.begin() + 1, n, gradient);
    if (hessian != nullptr) std::copy_n(values.begin() + 1 + n, n * n, hessian);
    return values[0];
  };
  return limit;
}

Drawing drawing_of(const SceneSource& scene, const std::vector<Coordinate>& coordinates) {
  Drawing drawing;
  const std::vector<int> axes = places(coordinates);
  const bool in_space =
      scene.path || std::any_of(scene.drawing.begin(),
                                scene.drawing.end(),
                                [](const DrawingSource& d) { return d.points[0].size() == 3; });
  const bool in_plane = !in_space && !scene.drawing.empty();
  for (std::size_t i = 0; i < axes.size(); ++i) drawing.axes[i] = axes[i];
  if (in_space || (!in_plane && axes.size() == 3)) {
    drawing.view = Drawing::View::kSpace;
    if (scene.path) {
      const std::string unit = axes.empty() ? "" : coordinates[axes[0]].unit;
      drawing.place.coordinates = {{{"x", unit, 0}, {"y", unit, 0}, {"z", unit, 0}}};
      drawing.place.at = [of = numbers(scene, *scene.path)](const double* q) {
        const std::vector<double> values = of.at(q);
        return std::array{values[0], values[1], values[2]};
      };
    } else if (axes.size() < 3) {
      drawing.view = Drawing::View::kTimeOnly;
    }
    draw_in_space(scene, drawing);
  } else if (axes.size() >= 2) {
    drawing.view = Drawing::View::kPlane;
    draw_in_plane(scene, drawing);
  }
  return drawing;
}

}  // namespace

bool is_angle(const Coordinate& c) { return c.period > 0 || c.unit == "rad"; }

SceneInfo describe_text(const SceneSource& scene, const Formulation& formulation) {
  SceneInfo info;
  info.name = scene.name;
  info.summary = scene.summary;
  info.kind = kind_text(formulation);
  info.reference = scene.reference;
  info.configuration = scene.coordinates;
  if (formulation.kind == Formulation::Kind::kGeneralizedHamiltonian) {
    // q are the first coordinates where the linear map leaves those alone, and nameless elsewhere.
    const int size = scene.dof();
    const int n = formulation.dof;
    info.configuration.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      const double* const column = formulation.darboux->basis.data() + i * size;
      int only = -1;
      for (int j = 0; j < size; ++j) {
        if (column[j] == 0) continue;
        const bool first = only < 0 && column[j] == 1;
        only = first ? j : size;
      }
      if (0 <= only && only < size) {
        info.configuration[i] = scene.coordinates[only];
      } else if (!scene.basis) {
        info.configuration[i] = {"q" + std::to_string(i + 1), "", 0};
      }
    }
  }
  // The formulas of a generalized Hamiltonian scene are in z, which a configuration does not have.
  info.drawing = drawing_of(scene, info.configuration);
  for (const ReportSource& report : scene.reports) {
    const Numbers of = numbers(scene, report.values);
    info.extremes.push_back({"largest_" + report.name, report.unit, [of](const double* q) {
                               const std::vector<double> values = of.at(q);
                               return *std::max_element(
                                   values.begin(), values.end(), [](double a, double b) {
                                     return std::abs(a) < std::abs(b);
                                   });
                             }});
  }
  for (const LimitSource& limit : scene.limits) info.limits.push_back(limit_of(scene, limit));
  return info;
}

namespace {

// With controls that enter linearly, the rate of the limit is r + a.u. Two of them and no drift are
// replaced by one, u = w (-a_2, a_1), which is regular wherever a is; otherwise one control is that
// which the others leave.
void hold_controls(SceneSource& scene, const LimitSource& limit) {
  Graph& graph = *scene.graph;
  const auto m = static_cast<int>(scene.controls.size());
  Expression rate = graph.number(0);
  for (int i = 0; i < scene.dof(); ++i) {
    const Expression by_i = graph.derivative(limit.value, kConfiguration.first + i);
    const std::optional<Formula>& velocity = scene.dynamics.at(i);
    if (velocity) rate = rate + by_i * velocity->expression;
  }
  std::vector<Expression> a;
  for (int j = 0; j < m; ++j) {
    a.push_back(graph.derivative(rate, kAlgebraic.first + j));
    if (graph.depends(a.back(), kAlgebraic.first, m)) {
      throw std::invalid_argument("controls that do not enter linearly cannot be held on a limit");
    }
  }
  const std::vector<Expression> still(m, graph.number(0));
  const Expression drift = graph.substitute(rate, kAlgebraic.first, still);
  std::vector<Expression> u;
  if (m == 2 && drift.is_zero()) {
    const Expression w = graph.variable(kAlgebraic.first);
    u = {-a[1] * w, a[0] * w};
  } else {
    const auto constant = std::find_if(
        a.begin(), a.end(), [](const Expression& e) { return e.is_constant() && !e.is_zero(); });
    const auto some =
        std::find_if(a.begin(), a.end(), [](const Expression& e) { return !e.is_zero(); });
    const auto pivot = constant != a.end() ? constant : some;
    if (pivot == a.end()) throw std::invalid_argument("no control moves what is limited");
    Expression rest = drift;
    for (int j = 0, next = 0; j < m; ++j) {
      if (j == pivot - a.begin()) {
        u.push_back(graph.number(0));
        continue;
      }
      u.push_back(graph.variable(kAlgebraic.first + next++));
      rest = rest + a[j] * u.back();
    }
    u[pivot - a.begin()] = -rest / *pivot;
  }
  for (std::optional<Formula>& velocity : scene.dynamics) {
    if (velocity)
      velocity->expression = graph.substitute(velocity->expression, kAlgebraic.first, u);
  }
  if (scene.cost)
    scene.cost->expression = graph.substitute(scene.cost->expression, kAlgebraic.first, u);
  scene.controls.pop_back();
  scene.guess.clear();
}

}  // namespace

void hold(SceneSource& scene, std::size_t index) {
  const LimitSource& limit = scene.limits[index];
  if (!scene.controls.empty()) return hold_controls(scene, limit);
  Graph& graph = *scene.graph;
  Expression rate = graph.number(0);
  for (int i = 0; i < scene.dof(); ++i) {
    rate = rate + graph.derivative(limit.value, kConfiguration.first + i) *
                      graph.variable(kVelocity.first + i);
  }
  scene.rows.push_back({rate, limit.place});
}

}  // namespace carnot::language
