// How the coefficients of a method become numbers of T: read or computed in a wider type, then
// rounded once.
#pragma once

#include <string_view>
#include <type_traits>

namespace carnot {

// What the coefficients for T are computed in.
template <class T>
using Wider = std::conditional_t<std::is_same_v<T, double>, long double, T>;

// The number written as "-12.345", to two units of round-off of T, whatever T.
template <class T>
constexpr T decimal(std::string_view text) {
  const bool negative = text.front() == '-';
  if (negative) text.remove_prefix(1);
  const std::size_t point = text.find('.');
  T whole(0);
  T fraction(0);
  for (const char digit : text.substr(0, point)) whole = T(10) * whole + T(digit - '0');
  for (std::size_t i = text.size(); point != std::string_view::npos && i > point + 1; --i) {
    fraction = (fraction + T(text[i - 1] - '0')) / T(10);  // from the right: errors fade
  }
  return negative ? -(whole + fraction) : whole + fraction;
}

}  // namespace carnot
