#include "run/delivery.h"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <vector>

#include "text/arguments.h"
#include "text/interrupt.h"
#include "text/output_file.h"

namespace carnot::apps {
namespace {

// Adds the names of the files to `written` as they come about. Throws std::runtime_error when one
// cannot be made.
void write_files(const Result& result,
                 const Destination& destination,
                 const std::string& json,
                 std::vector<std::string>& written) {
  const std::string& output = destination.output;
  const bool is_json = has_ending(output, ".json");
  if (!output.empty() && (is_json || result.delivered)) {
    write_file(output, is_json ? json : result.csv());
    written.push_back(output);
  }
  if (!result.delivered || destination.plot.empty()) return;
  const std::string warnings = result.draw(destination.plot);
  written.insert(written.begin(), destination.plot);
  if (!warnings.empty()) complain(warnings);
}

bool print(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  return std::fflush(stdout) == 0 && written;
}

}  // namespace

void complain(const std::string& message) {
  // Nobody is told where stderr is closed.
  const std::string line = fmt::format("carnot: {}\n", one_line(message));
  (void)std::fwrite(line.data(), 1, line.size(), stderr);
}

int deliver(const Result& result, const Destination& destination) {
  if (interrupted()) return kInterrupted;
  int status = result.delivered ? kSuccess : kNotDelivered;
  if (!result.delivered) complain(result.message);
  const std::string json = json_text(result.json);
  std::vector<std::string> written;
  try {
    write_files(result, destination, json, written);
  } catch (const std::runtime_error& error) {
    if (interrupted()) return kInterrupted;
    complain(error.what());
    status = kNotDelivered;
  }
  if (interrupted()) return kInterrupted;
  std::string text = destination.json ? json : result.text();
  for (const std::string& file : written) {
    if (!destination.json) text += "written: " + file + '\n';
  }
  if (!print(text)) {
    complain("cannot write to stdout");
    status = kNotDelivered;
  }
  return status;
}

}  // namespace carnot::apps
