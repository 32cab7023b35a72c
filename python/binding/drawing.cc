// The body of a scene at a configuration, as lines.
#include <pybind11/stl.h>

#include "arrays.h"
#include "calls.h"
#include "carnot/plots/instants.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

template <std::size_t d>
py::array_t<double> points_of(const std::vector<std::array<double, d>>& points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{d}});
  double* to = array.mutable_data();
  for (const auto& point : points) to = std::copy(point.begin(), point.end(), to);
  return array;
}

// [(role, points)].
py::list body(const Model& model, const Array& q) {
  const SceneInfo& info = model.searching().dynamics.info;
  const std::vector<double> at = vector_of(q, "q", model.entry().dof);
  py::list lines;
  if (info.drawing.body) {
    for (const Polyline& line : info.drawing.body(at.data())) {
      const bool wheel = line.role == Polyline::Role::kWheel;
      lines.append(py::make_tuple(wheel ? "wheel" : "body", points_of(line.points)));
    }
  }
  if (info.drawing.body_in_space) {
    for (const SpaceLine& line : info.drawing.body_in_space(at.data())) {
      lines.append(py::make_tuple("body", points_of(line.points)));
    }
  }
  return lines;
}

// The points that draw the path of configurations, in the plane or in space.
py::array_t<double> path(const Model& model, const Array& q) {
  check_rows(q, "q", model.entry().dof);
  const SceneInfo& info = model.searching().dynamics.info;
  const int dimensions = info.drawing.view == Drawing::View::kSpace ? 3 : 2;
  std::vector<std::vector<double>> points;
  for (py::ssize_t i = 0; i < q.shape(0); ++i) {
    points.push_back(plots::path_point(info, {q.data(i), q.data(i) + model.entry().dof}));
  }
  return matrix_of(points, dimensions);
}

// The rows at which the body is to be drawn.
std::vector<std::size_t> instants(const Model& model, const Array& q, std::size_t most) {
  check_rows(q, "q", model.entry().dof);
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < q.shape(0); ++i) {
    trajectory.q.emplace_back(q.data(i), q.data(i) + model.entry().dof);
  }
  return plots::body_instants(model.searching().dynamics.info, trajectory, most);
}

// [(name, corners)] of what limits forbid in the plane.
py::list outlines(const Model& model) {
  py::list regions;
  for (const Limit& limit : model.limits()) {
    if (!limit.outline.empty()) {
      regions.append(py::make_tuple(limit.name, points_of(limit.outline)));
    }
  }
  return regions;
}

}  // namespace

void add_drawing(ModelClass& model) {
  model.def("body", body, py::arg("q"));
  model.def("path", path, py::arg("q"));
  model.def("instants", instants, py::arg("q"), py::arg("most"));
  model.def("outlines", outlines);
}

}  // namespace carnot::python
