// Geodesics between two ends, and along lines of problems.
#include <pybind11/stl.h>

#include "background.h"
#include "calls.h"
#include "continue/continue_result.h"
#include "geodesic/geodesic_result.h"
#include "text/numbers.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

using namespace apps;

// (JSON without trajectories, [trajectory]).
py::tuple geodesics(const ModelPointer& model, const Texts& options, const py::object& callback) {
  GeodesicCall call;
  take(options, "from", call.from);
  take(options, "to", call.to);
  take(options, "time", call.time);
  take(options, "guess", call.guess);
  call.search = model->search_options(options);
  GeodesicRequest request = check(call, model->searching(options));
  bool without = false;
  take(options, "no-trajectory", without);
  if (without) request.options.samples = 0;
  request.run.no_trajectory = true;  // they go to Python as arrays
  auto report =
      answer_in_background<GeodesicReport>(callback, [model, request](const Progress& progress) {
        GeodesicOptions search = request.options;
        search.progress = progress;
        return find_geodesics(problem_between(request.run.dynamics, request.ends), search);
      });
  Json json = geodesic_result(request, report, {}).json;
  json["reason"] = name_of(report.reason);
  const Dynamics& dynamics = request.run.dynamics;
  py::list trajectories;
  for (Geodesic& geodesic : report.geodesics) {
    trajectories.append(
        trajectory_arrays(std::move(geodesic.trajectory), dynamics.dof, dynamics.multipliers));
  }
  return py::make_tuple(text_of(json), trajectories);
}

// JSON.
py::str follow_line(const ModelPointer& model, const Texts& options, const py::object& callback) {
  ContinueCall call;
  take(options, "from", call.from);
  take(options, "to", call.to);
  take(options, "time", call.time);
  take(options, "along", call.along);
  take(options, "rank", call.rank);
  take(options, "guess", call.guess);
  take(options, "max-points", call.max_points);
  take(options, "tolerance", call.tolerance);
  take(options, "time-limit", call.time_limit);
  take(options, "branches", call.branches);
  take(options, "no-labels", call.no_labels);
  call.asked = model->asked();
  // The parts of a request refer to each other: it stays where it is.
  const auto request =
      std::make_shared<const ContinueRequest>(check(call, model->searching(options)));
  const auto report = answer_in_background<ContinuationReport>(
      callback, [model, request](const Progress& progress) { return follow(*request, progress); });
  return text_of(continue_result(*request, report, {}).json);
}

}  // namespace

void add_searches(ModelClass& model) {
  model.def("geodesics", geodesics, py::arg("options"), py::arg("progress"));
  model.def("follow", follow_line, py::arg("options"), py::arg("progress"));
}

}  // namespace carnot::python
