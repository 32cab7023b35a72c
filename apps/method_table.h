// The methods by name. gaussN is the Gauss method of ORDER N, which has N/2 stages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace carnot::apps {

struct MethodEntry {
  std::string name;
  int order = 0;
  int stages = 0;
};

const std::vector<MethodEntry>& method_table();

// Throws std::invalid_argument naming the methods. `gauss2` is another name of the midpoint rule.
const MethodEntry& find_method(std::string_view option, std::string_view name);

}  // namespace carnot::apps
