// What a method keeps on a scene, as `carnot verify` measures it.
#include "background.h"
#include "calls.h"
#include "text/numbers.h"
#include "verify/audit_text.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

using namespace apps;

// JSON; the subject has the parameters of the model.
py::str verify(const ModelPointer& model, const std::string& steps, const py::object& callback) {
  constexpr long kFewest = 1000;
  constexpr long kMost = 100000000;
  const SceneEntry& entry = model->entry();
  auto subject = audit_subject(entry);
  if (!subject) refuse("SCENE", entry.info.name, "no start was found for it", "another scene");
  if (!model->source().set.empty()) subject->parameters = model->flowing().parameters;
  const long asked = steps.empty() ? 0 : parse_integer("--steps", steps, kFewest, kMost);
  if (subject->energy_step > 0 && asked > 0) subject->energy_steps = asked;
  const Method method = model->flowing().method;
  const auto audit = answer_in_background<Json>(
      callback, [model, subject = *subject, method](const Progress& progress) {
        return audit_json(audit_method(subject, method, audit_reference(subject), progress));
      });
  return text_of(audit);
}

}  // namespace

void add_audits(ModelClass& model) {
  model.def("verify", verify, py::arg("steps"), py::arg("progress"));
}

}  // namespace carnot::python
