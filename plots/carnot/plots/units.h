// Units in labels.
//
// A unit is a product of powers: "length^2", "rad/time", "action/(length time)", "1" for none.
// Factors are parted by blanks, '*' or '·'; what follows a '/' is below the line, up to the next
// blank or, in parentheses, as far as these go.
#pragma once

#include <string>

namespace carnot::plots {

// The unit in gnuplot's markup, exponents as superscripts: "length^{2}". Text that is no unit comes
// out as it is, escaped.
std::string unit_markup(const std::string& unit);

// The unit of the momentum of a coordinate, which is action over the unit of the coordinate:
// "action/length" for "length", "action time/rad" for "rad/time", "action" for "1", and nothing for
// a coordinate without a unit.
std::string momentum_unit(const std::string& unit);

}  // namespace carnot::plots
