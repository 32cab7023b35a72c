// What `carnot front` is asked: the options as texts, and the same checked.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "carnot/shooting/wavefront.h"
#include "run/run_options.h"

namespace carnot::apps {

struct FrontCall {
  RunOptions run;
  std::string from;
  std::string momentum;
  std::string what;
  std::string max_time;
  std::string time_limit;
  std::string length;
  std::vector<std::string> fix;
  std::string project;
  std::string order;
  std::string edge;
  std::string vertices;
  std::string bound;
  std::string output;
  bool times = false;
  bool check = false;
  bool cusps = false;
  bool cover = false;
  bool mod_angles = false;
  std::string mod_sign;
};

struct FrontRequest {
  Run run;
  std::vector<double> from;
  std::vector<double> momentum;  // of one extremal; empty: surfaces are asked for
  std::vector<double> lengths;
  FrontOptions front;
  std::string output;  // .vtp, .ply or .csv; empty: none
  bool check = false;
  double max_time = 0;  // 0: chosen
  double time_limit = std::numeric_limits<double>::infinity();
  bool mod_angles = true;
};

// Throws std::invalid_argument.
FrontRequest check(const FrontCall& options);

}  // namespace carnot::apps
