#include "text/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace carnot::apps {
namespace {

constexpr std::size_t kIndent = 2;

std::string scalar_text(const Json& value) {
  if (value.is_number_float()) {
    const double x = value.get<double>();
    return std::isfinite(x) ? fmt::format("{:.17g}", x) : "null";
  }
  // An argument that is not UTF-8 must not stop the output.
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void append(const Json& value, std::size_t indent, std::string& out);

void append_lines(const Json& value, std::size_t indent, std::string& out) {
  const std::string margin(indent + kIndent, ' ');
  const bool object = value.is_object();
  std::string_view separator = "\n";
  out += object ? '{' : '[';
  for (const auto& [key, item] : value.items()) {
    out += separator;
    out += margin;
    if (object) out += scalar_text(Json(key)) + ": ";
    append(item, indent + kIndent, out);
    separator = ",\n";
  }
  out += '\n' + std::string(indent, ' ') + (object ? '}' : ']');
}

void append(const Json& value, std::size_t indent, std::string& out) {
  if (!value.is_structured()) {
    out += scalar_text(value);
  } else if (value.empty()) {
    out += value.is_object() ? "{}" : "[]";
  } else if (value.is_object() || std::any_of(value.begin(), value.end(), [](const Json& item) {
               return item.is_structured();
             })) {
    append_lines(value, indent, out);
  } else {
    std::string_view separator = "[";
    for (const Json& item : value) {
      out += separator;
      out += scalar_text(item);
      separator = ", ";
    }
    out += ']';
  }
}

}  // namespace

std::string json_text(const Json& value) {
  std::string out;
  append(value, 0, out);
  return out + '\n';
}

std::string json_line(const Json& value) {
  if (!value.is_structured()) return scalar_text(value);
  const bool object = value.is_object();
  std::string out(1, object ? '{' : '[');
  for (const auto& [key, item] : value.items()) {
    if (out.size() > 1) out += ", ";
    if (object) out += scalar_text(Json(key)) + ": ";
    out += json_line(item);
  }
  return out + (object ? '}' : ']');
}

Json trajectory_json(const Trajectory& trajectory) {
  return {{"t", trajectory.t},
          {"q", trajectory.q},
          {"p", trajectory.p},
          {"lambda", trajectory.lambda},
          {"hamiltonian", trajectory.hamiltonian}};
}

}  // namespace carnot::apps
