// Initial value problems, and values at a phase point.
#include <pybind11/stl.h>

#include "arrays.h"
#include "background.h"
#include "calls.h"
#include "flow/flow_run.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

using namespace apps;

FlowRequest request_of(const Model& model, const Texts& options) {
  FlowOptions call;
  take(options, "from", call.from);
  take(options, "momentum", call.momentum);
  take(options, "velocity", call.velocity);
  take(options, "lambda", call.lambda);
  take(options, "time", call.time);
  take(options, "step", call.step);
  take(options, "steps", call.steps);
  take(options, "tolerance", call.tolerance);
  take(options, "stage-tolerance", call.stage_tolerance);
  take(options, "start-time", call.start_time);
  take(options, "tangent", call.tangent);
  FlowRequest request = check(call, model.flowing(options));
  request.run.no_trajectory = true;  // it goes to Python as arrays
  return request;
}

// (JSON, action, length, trajectory).
py::tuple flow(const ModelPointer& model, const Texts& options, const py::object& callback) {
  const FlowRequest request = request_of(*model, options);
  auto outcome =
      answer_in_background<FlowOutcome>(callback, [model, request](const Progress& progress) {
        return run_flow(request, [&](long /*steps*/) { return progress; });
      });
  const Dynamics& dynamics = request.run.dynamics;
  const py::str json = text_of(flow_result(request, outcome, {}).json);
  return py::make_tuple(
      json,
      outcome.summary.action,
      outcome.summary.length,
      trajectory_arrays(std::move(outcome.summary.trajectory), dynamics.dof, dynamics.multipliers));
}

// (H, velocity, multipliers); throws where the scene is not regular there.
py::tuple evaluate(const Model& model, const Array& q_in, const Array& p_in, double t) {
  const Dynamics& dynamics = model.flowing().dynamics;
  const std::vector<double> q = vector_of(q_in, "q", dynamics.dof);
  const std::vector<double> p = vector_of(p_in, "p", dynamics.dof);
  std::vector<double> velocity(dynamics.dof);
  std::vector<double> lambda(dynamics.multipliers);
  const PointValues at = dynamics.evaluate(t, q, p, velocity, lambda);
  if (at.status != RateStatus::kOk) throw py::value_error(std::string(describe(at.status)));
  return py::make_tuple(at.hamiltonian, array_of(std::move(velocity)), array_of(std::move(lambda)));
}

// (p, by how much the velocity violates the constraints).
py::tuple momentum(
    const Model& model, const Array& q_in, const Array& v_in, const Array& lambda_in, double t) {
  const Dynamics& dynamics = model.flowing().dynamics;
  const std::vector<double> q = vector_of(q_in, "q", dynamics.dof);
  std::vector<double> v = vector_of(v_in, "velocity", dynamics.dof);
  const std::vector<double> lambda = vector_of(lambda_in, "multipliers", dynamics.multipliers);
  std::vector<double> p(dynamics.dof);
  const double violation = dynamics.momentum(t, q, v, lambda, p);
  return py::make_tuple(array_of(std::move(p)), violation);
}

}  // namespace

py::dict trajectory_arrays(Trajectory trajectory, int n, int k) {
  py::dict arrays;
  arrays["q"] = matrix_of(trajectory.q, n);
  arrays["p"] = matrix_of(trajectory.p, n);
  arrays["multipliers"] = matrix_of(trajectory.lambda, k);
  arrays["t"] = array_of(std::move(trajectory.t));
  arrays["hamiltonian"] = array_of(std::move(trajectory.hamiltonian));
  return arrays;
}

void add_flows(ModelClass& model) {
  model.def("flow", flow, py::arg("options"), py::arg("progress"));
  model.def("evaluate", evaluate, py::arg("q"), py::arg("p"), py::arg("t"));
  model.def("momentum",
            momentum,
            py::arg("q"),
            py::arg("velocity"),
            py::arg("multipliers"),
            py::arg("t"));
}

}  // namespace carnot::python
