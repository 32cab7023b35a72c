// carnot._carnot: the library for the package carnot, which gives it a face.
//
// Everything here takes and gives plain values: texts, JSON, arrays. std::invalid_argument becomes
// ValueError.
#include "background.h"
#include "calls.h"

namespace py = pybind11;

PYBIND11_MODULE(_carnot, module) {
  using namespace carnot::python;
  ModelClass model(module, "Model");
  add_description(module, model);
  add_drawing(model);
  add_flows(model);
  add_searches(model);
  add_many(model);
  add_fields(model);
  add_audits(model);
  add_steering(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(finish_background));
}
