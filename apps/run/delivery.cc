#include "run/delivery.h"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "text/arguments.h"
#include "text/interrupt.h"
#include "text/output_file.h"

namespace carnot::apps {
namespace {

// Throws std::runtime_error when a file cannot be made.
void write_files(const Result& result, const Destination& destination, const std::string& json) {
  const bool other = !destination.output.empty() && !has_ending(destination.output, ".json");
  if (!destination.output.empty() && !other) write_file(destination.output, json);
  if (!result.delivered) return;
  if (other) write_file(destination.output, result.csv());
  if (destination.plot.empty()) return;
  const std::string warnings = result.draw(destination.plot);
  if (!warnings.empty()) complain(warnings);
}

bool print(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  return std::fflush(stdout) == 0 && written;
}

}  // namespace

void complain(const std::string& message) { fmt::print(stderr, "carnot: {}\n", one_line(message)); }

int deliver(const Result& result, const Destination& destination) {
  if (interrupted()) return kInterrupted;
  int status = result.delivered ? kSuccess : kNotDelivered;
  if (!result.delivered) complain(result.message);
  const std::string json = json_text(result.json);
  try {
    write_files(result, destination, json);
  } catch (const std::runtime_error& error) {
    if (interrupted()) return kInterrupted;
    complain(error.what());
    status = kNotDelivered;
  }
  if (interrupted()) return kInterrupted;
  if (!print(destination.json ? json : result.text())) {
    complain("cannot write to stdout");
    status = kNotDelivered;
  }
  return status;
}

}  // namespace carnot::apps
