#include "carnot/plots/units.h"

#include <cctype>
#include <cstddef>
#include <vector>

#include "carnot/plots/script.h"

namespace carnot::plots {
namespace {

// Factors above and below the line, each with its exponent as text.
struct Fraction {
  std::vector<std::string> above;
  std::vector<std::string> below;
};

Fraction parsed(const std::string& unit) {
  Fraction fraction;
  std::string factor;
  bool below = false;
  bool bracket = false;
  const auto close = [&] {
    if (!factor.empty() && factor != "1") {
      (below ? fraction.below : fraction.above).push_back(factor);
    }
    factor.clear();
    below = below && bracket;
  };
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const char c = unit[i];
    const bool dot = unit.compare(i, 2, "·") == 0;  // of two bytes
    if (c == ' ' || c == '*' || dot) {
      close();
      i += dot ? 1 : 0;
    } else if (c == '/') {
      close();
      below = true;
    } else if (c == '(') {
      bracket = true;
    } else if (c == ')') {
      close();
      bracket = below = false;
    } else {
      factor += c;
    }
  }
  close();
  return fraction;
}

std::string joined(const std::vector<std::string>& factors) {
  std::string text;
  for (const std::string& factor : factors) text += (text.empty() ? "" : " ") + factor;
  return text;
}

}  // namespace

std::string unit_markup(const std::string& unit) {
  std::string text;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    std::size_t end = i + 1;
    if (unit[i] == '^') {
      if (end < unit.size() && unit[end] == '-') ++end;
      while (end < unit.size() && std::isdigit(static_cast<unsigned char>(unit[end])) != 0) ++end;
    }
    const std::string exponent = unit.substr(i + 1, end - i - 1);
    if (exponent.empty() || exponent == "-") {
      text += escaped(unit.substr(i, 1));
    } else {
      text += "^{" + (exponent[0] == '-' ? "−" + exponent.substr(1) : exponent) + "}";
      i = end - 1;
    }
  }
  return text;
}

std::string momentum_unit(const std::string& unit) {
  if (unit.empty()) return {};
  Fraction fraction = parsed(unit);
  fraction.below.insert(fraction.below.begin(), "action");
  std::string above = joined(fraction.below);
  const std::string below = joined(fraction.above);
  if (below.empty()) return above;
  return above + "/" + (fraction.above.size() > 1 ? "(" + below + ")" : below);
}

}  // namespace carnot::plots
