#include "text/text_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace carnot::apps {

std::string text_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += fmt::format("{}{:<{}}", i == 0 ? "" : "  ", row[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  }
  return out;
}

std::string text_number(double value, int digits) { return fmt::format("{:.{}g}", value, digits); }

std::string text_vector(const std::vector<double>& values, int digits) {
  std::string out = "(";
  for (const double value : values) {
    out += (out.size() == 1 ? "" : ", ") + text_number(value, digits);
  }
  return out + ")";
}

std::string markdown_table(const std::vector<std::vector<std::string>>& cells) {
  std::string text;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += fmt::format("| {} |\n", fmt::join(cells[i], " | "));
    if (i > 0) continue;
    text += "|---|";
    for (std::size_t k = 1; k < cells[0].size(); ++k) text += "--:|";
    text += '\n';
  }
  return text;
}

}  // namespace carnot::apps
