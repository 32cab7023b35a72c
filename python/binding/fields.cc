// The least action to every point of a grid.
#include <pybind11/stl.h>

#include <algorithm>

#include "arrays.h"
#include "background.h"
#include "calls.h"
#include "carnot/shooting/solve_field.h"
#include "text/numbers.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

using namespace apps;

struct Question {
  BoundaryValueProblem problem;
  std::vector<FieldAxis> axes;
  FieldOptions options;
};

template <class Enum>
std::vector<double> codes(const std::vector<Enum>& values) {
  std::vector<double> numbers(values.size());
  std::transform(values.begin(), values.end(), numbers.begin(), [](Enum value) {
    return static_cast<double>(value);
  });
  return numbers;
}

// Arrays of a value for each point, the first axis slowest, and counts.
py::dict field(const ModelPointer& model,
               const Texts& options,
               const std::vector<std::pair<int, std::vector<double>>>& axes,
               const py::object& callback) {
  GeodesicCall call;
  take(options, "from", call.from);
  take(options, "to", call.to);
  take(options, "time", call.time);
  call.search = model->search_options(options);
  const GeodesicRequest request = check(call, model->searching(options));
  std::string checked = "100";
  take(options, "check", checked);
  Question asked{problem_between(request.run.dynamics, request.ends), {}, {}};
  for (const auto& [coordinate, values] : axes) asked.axes.push_back({coordinate, values});
  asked.options.search = request.options;
  asked.options.threads = request.run.threads;
  asked.options.check = parse_integer("--check", checked, 0, 1000000);
  auto answer = answer_in_background<Field>(callback, [model, asked](const Progress& progress) {
    FieldOptions how = asked.options;
    how.progress = progress;
    return solve_field(asked.problem, asked.axes, how);
  });
  py::dict arrays;
  const auto points = static_cast<py::ssize_t>(answer.action.size());
  arrays["label"] = array_of(codes(answer.label));
  arrays["verification"] = array_of(codes(answer.verification));
  std::vector<std::string> reasons;
  for (const Reason reason : answer.reason) reasons.emplace_back(name_of(reason));
  arrays["reason"] = py::cast(reasons);
  arrays["action"] = array_of(std::move(answer.action));
  arrays["p0"] = array_of(std::move(answer.p0), {points, py::ssize_t{answer.dof}});
  arrays["error"] = array_of(std::move(answer.error));
  arrays["finished"] = answer.finished;
  arrays["searches"] = answer.searches;
  arrays["flows"] = answer.flows;
  arrays["settled"] = answer.settled;
  arrays["unkept"] = answer.unkept;
  arrays["triangles"] = answer.triangles;
  arrays["violations"] = answer.violations;
  arrays["checked"] = answer.checked;
  arrays["lower"] = answer.lower;
  arrays["bound"] = answer.bound;
  arrays["elapsed_seconds"] = answer.elapsed_seconds;
  return arrays;
}

}  // namespace

void add_fields(ModelClass& model) {
  model.def("distance_field", field, py::arg("options"), py::arg("axes"), py::arg("progress"));
}

}  // namespace carnot::python
