// The result of an atlas as a file: records in the order of the problems, one after the other.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "atlas/problem_list.h"

namespace carnot::apps {

// What the writers know beforehand.
struct AtlasLayout {
  std::vector<std::string> coordinates;
  std::vector<Axis> axes;
  std::vector<std::string> parameters;  // that differ from problem to problem
  long problems = 0;
  int multipliers = 0;
  int count = 1;     // geodesics of a problem, at most; 0: any number
  long samples = 0;  // times of a trajectory
  bool free_ends = false;
  bool limited = false;
  bool times = true;  // whether seconds are told
  Json head;          // how the call can be repeated
};

class AtlasWriter {
 public:
  virtual ~AtlasWriter() = default;
  // Throws std::runtime_error where it cannot be written; so does finish().
  virtual void add(const Json& record) = 0;
  virtual void finish() = 0;
};

// The closest approach to any limit of a geodesic in a record; null without limits.
Json lowest_slack(const Json& geodesic);

// By the ending of the file: .csv, .jsonl or .h5. `path` is where it is written, `name` what it is
// called.
std::unique_ptr<AtlasWriter> make_atlas_writer(const std::string& path,
                                               const std::string& name,
                                               const AtlasLayout& layout);

}  // namespace carnot::apps
