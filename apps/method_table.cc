#include "method_table.h"

#include "nearest.h"
#include "numbers.h"

namespace carnot::apps {
namespace {

std::vector<MethodEntry> make_table() {
  constexpr int kMostStages = 8;
  std::vector<MethodEntry> table;
  for (int s = 1; s <= kMostStages; ++s) {
    table.push_back({s == 1 ? "midpoint" : "gauss" + std::to_string(2 * s), 2 * s, s});
  }
  return table;
}

}  // namespace

const std::vector<MethodEntry>& method_table() {
  static const std::vector<MethodEntry> table = make_table();
  return table;
}

const MethodEntry& find_method(std::string_view option, std::string_view name) {
  std::vector<std::string> names;
  std::string list;
  for (const MethodEntry& method : method_table()) {
    if (method.name == name || (method.order == 2 && name == "gauss2")) return method;
    names.push_back(method.name);
    list += (list.empty() ? "" : ", ") + method.name;
  }
  refuse(option, name, "no such method" + suggestion(name, names), list);
}

}  // namespace carnot::apps
