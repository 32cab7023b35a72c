// What `carnot continue` changes: --along NAME=VALUE.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/problem/problem_line.h"
#include "catalogue/limit_choice.h"
#include "run/ends.h"
#include "run/run_options.h"

namespace carnot::apps {

struct Along {
  enum class Kind { kTarget, kStart, kTime, kParameter, kLimit, kDisc };
  Kind kind = Kind::kTarget;
  std::string name;       // "to", "from", "time", a parameter, "limit:NAME" or "disc:K"
  std::size_t index = 0;  // of the limit among those of the ends, or of the disc that is asked for
  // A configuration, one number, the two bounds of a limit, or centre and radius of a disc.
  std::vector<double> start;
  std::vector<double> end;

  [[nodiscard]] std::vector<double> value(double s) const;
};

// Throws std::invalid_argument naming what is accepted.
Along parse_along(const std::string& text,
                  const Run& run,
                  const Ends& ends,
                  const AskedLimits& asked);

// `run` must outlive the line.
ProblemLine line_of(const Along& along, const Run& run, const Ends& ends, const AskedLimits& asked);

// A number that grows along the line, for an axis: the time, the parameter, the one coordinate that
// changes, or s where several do. And its label, in plots' markup.
double axis_value(const Along& along, double s);
std::string axis_label(const Along& along, const Run& run);

}  // namespace carnot::apps
