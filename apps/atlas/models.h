// The scene of an atlas with the parameters that a problem asks for.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "run/run_options.h"
#include "run/search_options.h"

namespace carnot::apps {

// A scene with some values of its parameters, and the limits that it has with them.
struct Model {
  Dynamics dynamics;
  std::vector<Limit> limits;
};

// Models by their parameters, the latest of them kept. Safe to call from many threads.
class Models {
 public:
  // Keeps references. Throws std::invalid_argument where a limit is wrong.
  Models(const SearchOptions& search, const Run& run);

  std::shared_ptr<const Model> of(const ParameterValues& parameters);

 private:
  const SearchOptions& search_;
  const Run& run_;
  std::mutex mutex_;
  std::map<ParameterValues, std::shared_ptr<const Model>> models_;
  std::deque<ParameterValues> order_;
};

}  // namespace carnot::apps
