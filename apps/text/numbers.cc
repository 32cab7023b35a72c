#include "text/numbers.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace carnot::apps {
namespace {

constexpr std::string_view kReal = "a finite number such as 0.5, 1e-3, pi/2 or -3*pi/4";

bool starts_number(std::string_view text) {
  return !text.empty() && (text[0] == '.' || (text[0] >= '0' && text[0] <= '9'));
}

// Reads a number, `pi` or both from the front of `text`; empty when there is neither.
std::optional<double> take_factor(std::string_view& text) {
  double value = 1;
  const bool number = starts_number(text);
  if (number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range) {
      // Too large, or so small that it is zero.
      value = std::strtod(std::string(text.data(), end).c_str(), nullptr);
    } else if (error != std::errc()) {
      return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  if (text.starts_with("pi")) {
    text.remove_prefix(2);
    return value * std::numbers::pi;
  }
  return number ? std::optional(value) : std::nullopt;
}

std::optional<double> read_real(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  std::optional<double> value = take_factor(text);
  while (value && !text.empty()) {
    const char operation = text[0];
    text.remove_prefix(1);
    const std::optional<double> factor = take_factor(text);
    if (!factor || (operation != '*' && operation != '/')) return std::nullopt;
    *value = operation == '*' ? *value * *factor : *value / *factor;
  }
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return negative ? -*value : *value;
}

std::string_view without_blanks(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> split_at_commas(std::string_view text) {
  std::vector<std::string_view> items;
  for (;;) {
    const std::size_t comma = text.find(',');
    items.push_back(without_blanks(text.substr(0, comma)));
    if (comma == std::string_view::npos) return items;
    text.remove_prefix(comma + 1);
  }
}

// As many items as asked for, each a real or, where that is allowed, `*` for nothing.
std::vector<std::optional<double>> read_vector(std::string_view option,
                                               std::string_view text,
                                               std::size_t count,
                                               bool allows_free,
                                               const std::string& accepted) {
  const auto items = split_at_commas(text);
  std::vector<std::optional<double>> values;
  for (const std::string_view item : items) {
    values.push_back(read_real(item));
    if (values.back() || (allows_free && item == "*")) continue;
    constexpr std::size_t kLongest = 60;
    refuse(option,
           text,
           fmt::format("'{}{}' is not a finite number",
                       item.substr(0, kLongest),
                       item.size() > kLongest ? "..." : ""),
           accepted);
  }
  if (items.size() != count) {
    const std::string_view plural = items.size() == 1 ? "" : "s";
    refuse(option, text, fmt::format("{} number{} given", items.size(), plural), accepted);
  }
  return values;
}

template <class Integer>
std::optional<Integer> read_integer(std::string_view text) {
  Integer value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace

void refuse(std::string_view option,
            std::string_view value,
            std::string_view why,
            std::string_view accepted) {
  constexpr std::size_t kLongest = 200;  // keeps a pasted file from filling the terminal
  const std::string_view more = value.size() > kLongest ? "..." : "";
  throw std::invalid_argument(fmt::format(
      "{} '{}{}': {}; accepted: {}", option, value.substr(0, kLongest), more, why, accepted));
}

void refuse_missing(std::string_view option, std::string_view accepted) {
  refuse(option, "", "is missing", accepted);
}

std::vector<std::string> split(std::string_view text, char at) {
  std::vector<std::string> items(1);
  for (const char c : text) {
    if (c == at) {
      items.emplace_back();
    } else {
      items.back() += c;
    }
  }
  return items;
}

double parse_real(std::string_view option, std::string_view text) {
  const auto value = read_real(text);
  if (!value) refuse(option, text, "not a finite number", kReal);
  return *value;
}

double parse_positive(std::string_view option, std::string_view text) {
  const auto value = read_real(text);
  if (!value) refuse(option, text, "not a finite number", "a finite number > 0");
  if (*value <= 0) refuse(option, text, "not positive", "a finite number > 0");
  return *value;
}

double parse_between(std::string_view option,
                     std::string_view text,
                     double lowest,
                     double highest) {
  const std::string accepted = fmt::format("a number from {:g} to {:g}", lowest, highest);
  const auto value = read_real(text);
  if (!value) refuse(option, text, "not a finite number", accepted);
  if (*value < lowest || *value > highest) refuse(option, text, "out of range", accepted);
  return *value;
}

double parse_tolerance(std::string_view option, std::string_view text) {
  return parse_between(option, text, 1e-16, 1);
}

std::string vector_accepted(const std::vector<std::string>& names) {
  return fmt::format("{} comma-separated finite number{} {}, such as 0.5, -1e-3 or pi/2",
                     names.size(),
                     names.size() == 1 ? "" : "s",
                     fmt::join(names, ","));
}

std::vector<double> parse_vector(std::string_view option,
                                 std::string_view text,
                                 const std::vector<std::string>& names) {
  std::vector<double> values;
  for (const auto& value : read_vector(option, text, names.size(), false, vector_accepted(names))) {
    values.push_back(*value);
  }
  return values;
}

std::string end_accepted(const std::vector<std::string>& names) {
  return vector_accepted(names) + ", or * for a free coordinate";
}

std::vector<std::optional<double>> parse_end(std::string_view option,
                                             std::string_view text,
                                             const std::vector<std::string>& names) {
  return read_vector(option, text, names.size(), true, end_accepted(names));
}

long parse_integer(std::string_view option, std::string_view text, long lowest, long highest) {
  const std::string accepted = fmt::format("an integer from {} to {}", lowest, highest);
  const auto value = read_integer<long>(text);
  if (!value) refuse(option, text, "not an integer in range", accepted);
  if (*value < lowest || *value > highest) refuse(option, text, "out of range", accepted);
  return *value;
}

std::uint64_t parse_seed(std::string_view option, std::string_view text) {
  constexpr auto kHighest = std::numeric_limits<std::uint64_t>::max();
  const auto value = read_integer<std::uint64_t>(text);
  if (!value) refuse(option, text, "not a seed", fmt::format("an integer from 0 to {}", kHighest));
  return *value;
}

}  // namespace carnot::apps
