// Two printed texts are the same: the words must be, white space apart; numbers may differ by
// round-off.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace carnot::docs {

// Numbers in these lines depend on the machine.
inline constexpr std::array kEffort{"starts converged", "evaluations", "seconds"};
// Below this, the tolerance of a geodesic, a number is round-off; its digits mean nothing.
inline constexpr double kRoundOff = 1e-10;
// Of numbers that are printed with more digits than this.
inline constexpr double kRelative = 1e-9;
// A number with fewer digits than this may be one printed in full, such as 0.5.
inline constexpr std::size_t kRoundedDigits = 3;

// The parking manoeuvre and its mirror image have the same action; round-off may swap them.
inline const std::pair<std::string, std::string> kMirrorImages{
    "(-5.3631314, 16.184377, -9.3116147, -4.0807579)",
    "(5.3631314, 16.184377, -14.674746, -4.0807579)"};

// Without blank lines.
inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(' ') != std::string::npos) lines.push_back(line);
  }
  return lines;
}

// Words, numbers and signs: "p0 (-1.5, 2e-3)" is p0 ( -1.5 , 2e-3 ).
inline std::vector<std::string> tokens_of(const std::string& line) {
  static const std::regex kToken(R"([A-Za-z_]\w*|[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[^\s])");
  return {std::sregex_token_iterator(line.begin(), line.end(), kToken),
          std::sregex_token_iterator()};
}

inline bool is_number(const std::string& token) {
  return std::any_of(token.begin(), token.end(), [](unsigned char c) { return std::isdigit(c); }) &&
         std::isalpha(static_cast<unsigned char>(token[0])) == 0 && token[0] != '_';
}

// One unit in the last place that is printed; 0 for a number that may have been printed in full.
inline double last_place(const std::string& token) {
  const std::string mantissa = token.substr(0, token.find_first_of("eE"));
  const std::size_t point = mantissa.find('.');
  if (point == std::string::npos) return 0;
  const std::size_t first = mantissa.find_first_of("123456789");
  const std::size_t digits =
      first == std::string::npos ? 0 : mantissa.size() - first - (first < point ? 1 : 0);
  if (digits < kRoundedDigits) return 0;
  const double unit = std::pow(10.0, -static_cast<double>(mantissa.size() - point - 1));
  const double scale = mantissa.size() < token.size()
                           ? std::pow(10.0, std::stod(token.substr(mantissa.size() + 1)))
                           : 1.0;
  return unit * scale;
}

inline bool same_number(const std::string& expected, const std::string& actual) {
  constexpr double kSlack = 1.01;  // the difference is rounded, too
  const double a = std::strtod(expected.c_str(), nullptr);
  const double b = std::strtod(actual.c_str(), nullptr);
  const double larger = std::max(std::abs(a), std::abs(b));
  return larger < kRoundOff ||
         std::abs(a - b) <= std::max(kRelative * larger, kSlack * last_place(expected));
}

inline bool same_line(const std::string& expected, const std::string& actual) {
  const bool effort = std::any_of(kEffort.begin(), kEffort.end(), [&](const char* words) {
    return expected.find(words) != std::string::npos;
  });
  const auto a = tokens_of(expected);
  const auto b = tokens_of(actual);
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(), [&](const std::string& x, const std::string& y) {
        if (!is_number(x) || !is_number(y)) return x == y;
        return effort || same_number(x, y);
      });
}

inline bool same_text(const std::string& expected, const std::string& actual) {
  const auto a = lines_of(expected);
  const auto b = lines_of(actual);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_line);
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline bool agrees(const std::string& expected, const std::string& actual) {
  const auto& [one, other] = kMirrorImages;
  return same_text(expected, actual) || same_text(replaced(expected, one, other), actual) ||
         same_text(replaced(expected, other, one), actual);
}

}  // namespace carnot::docs
