// The problems of an atlas: of a file, on a grid, or drawn. Number i is the same whatever else
// there is, and is made when it is wanted.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/ends.h"
#include "run/run_options.h"
#include "text/json_text.h"

namespace carnot::apps {

struct AtlasProblem {
  Ends ends;  // without limits
  ParameterValues parameters;
};

// Values of a coordinate of the target, on a grid.
struct Axis {
  std::string name;
  std::string unit;
  int coordinate = 0;
  std::vector<double> values;
};

class ProblemList {
 public:
  virtual ~ProblemList() = default;
  [[nodiscard]] virtual long size() const = 0;
  // Safe to call from many threads. Throws std::runtime_error where the file has changed.
  [[nodiscard]] virtual AtlasProblem at(long i) const = 0;
  // What tells this list from others.
  [[nodiscard]] virtual Json identity() const = 0;
  // What that was when the list was as long as `there`, an identity, says: lists may grow at their
  // end. The same as identity() of those that do not grow, or that are shorter than that.
  [[nodiscard]] virtual Json identity_then(const Json& /*there*/) const { return identity(); }
  // Of a grid, the first one slowest.
  [[nodiscard]] virtual std::vector<Axis> axes() const { return {}; }
  // Whether an end has a free coordinate.
  [[nodiscard]] virtual bool has_free() const = 0;
  // Parameters that differ from problem to problem.
  [[nodiscard]] virtual std::vector<std::string> parameters() const { return {}; }
};

struct ListOptions {
  std::string problems;  // one of these three
  std::string grid;
  std::string random;
  std::string from;
  std::string to;
  std::string time = "1";
};

// Targets that are drawn keep to the limits. Throws std::invalid_argument naming the option, or the
// line and column of the file.
std::unique_ptr<ProblemList> make_problem_list(const ListOptions& options,
                                               const Run& run,
                                               const std::vector<Limit>& limits);

}  // namespace carnot::apps
