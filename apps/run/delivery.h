// A result on its way out: to the file, the plot and stdout, with the exit status that fits.
#pragma once

#include <functional>
#include <string>

#include "run/run_options.h"
#include "text/json_text.h"

namespace carnot::apps {

inline constexpr int kSuccess = 0;
inline constexpr int kNotDelivered = 1;  // the numerics, or a file, did not come about
inline constexpr int kBadInput = 2;
inline constexpr int kInterrupted = 130;

struct Result {
  bool delivered = true;  // false: only the JSON is written, and the exit status is 1
  std::string message;    // why not
  Json json;
  std::function<std::string()> csv;                     // or what else --output is to hold
  std::function<std::string()> text;                    // for people; files follow it
  std::function<std::string(const std::string&)> draw;  // makes the plot file; warnings
};

// Nothing at all once interrupted.
int deliver(const Result& result, const Destination& destination);

// Prints "carnot: MESSAGE" on stderr, in one line.
void complain(const std::string& message);

}  // namespace carnot::apps
