#include "tables/scene_json.h"

#include <utility>

#include "catalogue/scene_choice.h"

namespace carnot::apps {

Json scene_json(const SceneEntry& entry) {
  Json periods = Json::object();
  for (const Coordinate& coordinate : entry.info.configuration) {
    if (coordinate.period > 0) periods[coordinate.name] = coordinate.period;
  }
  Json parameters = Json::array();
  for (const ParameterInfo& parameter : entry.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"default", parameter.default_value},
                          {"unit", parameter.unit},
                          {"range", parameter.range.text()},
                          {"meaning", parameter.meaning}});
  }
  return {{"name", entry.info.name},
          {"summary", entry.info.summary},
          {"kind", entry.info.kind},
          {"configuration", coordinate_names(entry)},
          {"periods", std::move(periods)},
          {"multipliers", entry.multipliers},
          {"parameters", std::move(parameters)},
          {"reference", entry.info.reference}};
}

}  // namespace carnot::apps
