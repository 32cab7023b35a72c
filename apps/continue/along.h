// What `carnot continue` changes: --along NAME=VALUE.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/problem/problem_line.h"
#include "run/ends.h"
#include "run/run_options.h"

namespace carnot::apps {

struct Along {
  enum class Kind { kTarget, kStart, kTime, kParameter };
  Kind kind = Kind::kTarget;
  std::string name;           // "to", "from", "time" or a parameter
  std::vector<double> start;  // a configuration, or one number
  std::vector<double> end;

  [[nodiscard]] std::vector<double> value(double s) const;
};

// Throws std::invalid_argument naming what is accepted.
Along parse_along(const std::string& text, const Run& run, const Ends& ends);

// `run` must outlive the line.
ProblemLine line_of(const Along& along, const Run& run, const Ends& ends);

// A number that grows along the line, for an axis: the time, the parameter, the one coordinate that
// changes, or s where several do. And its label, in plots' markup.
double axis_value(const Along& along, double s);
std::string axis_label(const Along& along, const Run& run);

}  // namespace carnot::apps
