// What a model says of itself.
#include <pybind11/stl.h>

#include "calls.h"
#include "carnot/load_scene.h"
#include "catalogue/method_table.h"
#include "catalogue/scene_choice.h"
#include "catalogue/scene_texts.h"
#include "tables/scene_json.h"
#include "text/numbers.h"
#include "text/version.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

using namespace apps;

std::string view_name(Drawing::View view) {
  switch (view) {
    case Drawing::View::kPlane:
      return "plane";
    case Drawing::View::kSpace:
      return "space";
    case Drawing::View::kTimeOnly:
      break;
  }
  return "time";
}

Json described(const Coordinate& coordinate) {
  return {{"name", coordinate.name}, {"unit", coordinate.unit}, {"period", coordinate.period}};
}

Json coordinates_json(const SceneInfo& info) {
  Json list = Json::array();
  for (const Coordinate& coordinate : info.configuration) list.push_back(described(coordinate));
  return list;
}

Json drawing_json(const Drawing& drawing) {
  Json json{{"view", view_name(drawing.view)}, {"axes", drawing.axes}};
  json["sphere"] = drawing.sphere;
  json["path"] = drawing.path;
  json["glyph"] = drawing.glyph;
  json["place"] = nullptr;
  if (drawing.place.at) {
    Json place = Json::array();
    for (const Coordinate& coordinate : drawing.place.coordinates) {
      place.push_back(described(coordinate));
    }
    json["place"] = std::move(place);
  }
  return json;
}

// As `carnot scenes SCENE --json`, and what Python asks for besides.
Json description(const Model& model) {
  const Run& run = model.searching();
  const SceneInfo& info = run.dynamics.info;
  Json json = scene_json(model.entry());
  json["values"] = parameters_json(run);
  json["coordinates"] = coordinates_json(info);
  json["dof"] = model.entry().dof;
  json["holonomic"] = model.entry().holonomic;
  json["method"] = run.method.name;
  json["flow_method"] = model.flowing().method.name;
  json["drawing"] = drawing_json(info.drawing);
  Json extremes = Json::array();
  for (const Extreme& extreme : info.extremes) {
    extremes.push_back({{"name", extreme.name}, {"unit", extreme.unit}});
  }
  json["extremes"] = std::move(extremes);
  Json limits = Json::array();
  for (const Limit& limit : model.limits()) limits.push_back(limit.name);
  json["limits"] = std::move(limits);
  return json;
}

}  // namespace

py::str text_of(const Json& json) { return {json_line(json)}; }

void add_description(py::module_& module, ModelClass& model) {
  module.attr("version") = kVersion;
  module.def("scene_names", scene_names);
  module.def("read_scene", [](const std::string& path) {
    const TextScene scene = load_scene(path);
    return py::make_tuple(scene.info().name, scene.text());
  });
  module.def("read_number", [](const std::string& text) { return parse_real("number", text); });
  module.def("is_scene_file", [](const std::string& name) { return is_scene_file(name); });
  model.def(py::init([](const std::string& name,
                        const std::string& text,
                        const std::vector<std::string>& set,
                        const std::string& method,
                        const std::vector<std::string>& limits,
                        const std::vector<std::string>& discs) {
              return std::make_shared<Model>(ModelSource{name, text, set, method, limits, discs});
            }),
            py::arg("name"),
            py::arg("text"),
            py::arg("set"),
            py::arg("method"),
            py::arg("limits"),
            py::arg("discs"));
  model.def("description", [](const Model& self) { return text_of(description(self)); });
  model.def("text", [](const Model& self) { return text_of_scene(self.entry()); });
  model.def("methods", [](const Model& self) { return method_names(self.entry()); });
}

}  // namespace carnot::python
