// Numbers as people type them, read strictly.
//
// A real is a product: an optional sign, then factors joined by '*' and '/', each a decimal number
// or `pi` (or both, as in `2pi`). So `1e-3`, `pi/2`, `-3*pi/4` are reals; `nan`, `inf`, `1e999`,
// `1/0`, `0x10`, `1 2` are not. Every refusal is a std::invalid_argument whose text names the
// option, the value and what is accepted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace carnot::apps {

// Throws std::invalid_argument "OPTION 'VALUE': WHY; accepted: ACCEPTED".
[[noreturn]] void refuse(std::string_view option,
                         std::string_view value,
                         std::string_view why,
                         std::string_view accepted);
[[noreturn]] void refuse_missing(std::string_view option, std::string_view accepted);

// What stands between the `at`s, in order; one item more than there are of them.
std::vector<std::string> split(std::string_view text, char at);

double parse_real(std::string_view option, std::string_view text);
double parse_positive(std::string_view option, std::string_view text);

// A real between `lowest` and `highest`, both included.
double parse_between(std::string_view option, std::string_view text, double lowest, double highest);

// An accepted error: from 1e-16, below which nothing can be told in double, to 1.
double parse_tolerance(std::string_view option, std::string_view text);

// One real per name, separated by commas. vector_accepted() says so.
std::vector<double> parse_vector(std::string_view option,
                                 std::string_view text,
                                 const std::vector<std::string>& names);

std::string vector_accepted(const std::vector<std::string>& names);

// The same for an end of a geodesic, with nothing where it says `*`: that coordinate is free.
std::vector<std::optional<double>> parse_end(std::string_view option,
                                             std::string_view text,
                                             const std::vector<std::string>& names);

std::string end_accepted(const std::vector<std::string>& names);

// A decimal integer between `lowest` and `highest`, both included.
long parse_integer(std::string_view option, std::string_view text, long lowest, long highest);
std::uint64_t parse_seed(std::string_view option, std::string_view text);

}  // namespace carnot::apps
