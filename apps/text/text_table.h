// Tables for people: columns aligned, separated by two blanks.
#pragma once

#include <string>
#include <vector>

namespace carnot::apps {

// The first row is the header.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

// The same in Markdown; all but the first column to the right.
std::string markdown_table(const std::vector<std::vector<std::string>>& cells);

// "(1, 2.5, -3)" with `digits` significant digits.
std::string text_vector(const std::vector<double>& values, int digits = 6);

// For screens: `digits` significant digits.
std::string text_number(double value, int digits = 6);

}  // namespace carnot::apps
