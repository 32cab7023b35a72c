#include "atlas/atlas_summary.h"

#include <fmt/format.h>

#include <vector>

#include "text/text_table.h"

namespace carnot::apps {

void AtlasSummary::add(const Json& record) {
  const Json& geodesics = record.at("geodesics");
  if (geodesics.empty()) {
    ++reasons[record.at("reason").get<std::string>()];
    return;
  }
  ++solved;
  ++labels[geodesics[0].at("label").get<std::string>()];
}

std::string atlas_text(const Json& json) {
  std::vector<std::vector<std::string>> rows;
  for (const char* key : {"scene", "problems", "solved", "failed", "resumed", "repaired"}) {
    const Json& value = json.at(key);
    const bool quiet =
        (std::string(key) == "resumed" || std::string(key) == "repaired") && value.get<long>() == 0;
    if (!quiet) rows.push_back({key, value.is_string() ? value.get<std::string>() : value.dump()});
  }
  for (const char* key : {"labels", "reasons"}) {
    for (const auto& [name, number] : json.at(key).items()) rows.push_back({name, number.dump()});
  }
  rows.push_back({"wall time", fmt::format("{:.3g} s", json.at("elapsed_seconds").get<double>())});
  return text_table(rows);
}

}  // namespace carnot::apps
