// What came of all problems of an atlas.
#pragma once

#include <map>
#include <string>

#include "text/json_text.h"

namespace carnot::apps {

struct AtlasSummary {
  long solved = 0;
  std::map<std::string, long> labels;  // of the least
  std::map<std::string, long> reasons;

  // Counts one record (atlas_record.h).
  void add(const Json& record);
};

// The summary that `carnot atlas --json` prints, in words.
std::string atlas_text(const Json& json);

}  // namespace carnot::apps
