// carnot._carnot: the library for the package carnot, which gives it a face.
//
// Everything here takes and gives plain values: texts, JSON, arrays. std::invalid_argument becomes
// ValueError.
#include <exception>
#include <stdexcept>
#include <string>

#include "background.h"
#include "calls.h"

namespace py = pybind11;

PYBIND11_MODULE(_carnot, module) {
  using namespace carnot::python;
  // Words may quote what is no UTF-8, such as half a character.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 asks for this type of function
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const std::invalid_argument& error) {
      const std::string what = error.what();
      const auto words = py::reinterpret_steal<py::object>(
          PyUnicode_DecodeUTF8(what.data(), static_cast<py::ssize_t>(what.size()), "replace"));
      PyErr_SetObject(PyExc_ValueError, words.ptr());
    }
  });
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
