#include "catalogue/method_table.h"

#include <fmt/format.h>

#include "carnot/language/nearest.h"
#include "text/numbers.h"

namespace carnot::apps {

std::vector<std::string> method_names(const SceneEntry& entry) {
  std::vector<std::string> names;
  for (const Method& method : methods()) {
    if (entry.suits(method)) names.push_back(method.name);
  }
  return names;
}

const Method& choose_method(std::string_view name, const SceneEntry& entry) {
  if (name.empty()) name = entry.needs_rattle ? "rattle" : "gauss16";
  const Method* const method = find_method(name);
  if (method != nullptr && entry.suits(*method)) return *method;
  const std::vector<std::string> names = method_names(entry);
  const std::string why =
      method == nullptr ? "no such method" + language::suggestion(name, names)
                        : entry.info.name + " has holonomic constraints, which it does not keep";
  refuse("--method", name, why, fmt::format("{}", fmt::join(names, ", ")));
}

}  // namespace carnot::apps
