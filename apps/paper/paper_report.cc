#include "paper/paper_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "text/text_table.h"

namespace carnot::apps {
namespace {

std::string word(PaperVerdict verdict) {
  switch (verdict) {
    case PaperVerdict::kHolds:
      return "holds";
    case PaperVerdict::kMisprint:
      return "misprint";
    default:
      return "FAILS";
  }
}

// In lines of at most `width` characters, each with `margin` before it.
std::string wrapped(const std::string& text, std::size_t width, const std::string& margin) {
  std::string out;
  std::size_t begin = 0;
  while (begin < text.size()) {
    std::size_t end = text.size();
    if (end - begin > width) {
      end = text.rfind(' ', begin + width);
      if (end == std::string::npos || end <= begin) end = text.find(' ', begin);
      end = std::min(end, text.size());
    }
    out += margin + text.substr(begin, end - begin) + '\n';
    begin = end + 1;
  }
  return out;
}

// A table, then the notes by number.
std::string rows_text(const std::vector<PaperRow>& rows) {
  constexpr std::size_t kWidth = 96;
  std::vector<std::vector<std::string>> table{{"", "paper", "here", ""}};
  std::string notes;
  int number = 0;
  for (const PaperRow& row : rows) {
    std::string verdict = word(row.verdict);
    if (!row.note.empty()) {
      ++number;
      verdict += fmt::format(" [{}]", number);
      const std::string text = wrapped(row.note, kWidth, "      ");
      notes += fmt::format("  [{}] {}", number, text.substr(std::min<std::size_t>(6, text.size())));
    }
    table.push_back({row.what, row.paper, row.here, verdict});
  }
  return text_table(table) + notes;
}

std::string table_text(const PaperTable& table) {
  std::vector<std::vector<std::string>> lines{table.columns};
  for (const auto& row : table.rows) {
    std::vector<std::string> line;
    line.reserve(row.size());
    for (const double x : row) line.push_back(std::isfinite(x) ? text_number(x, 5) : "-");
    lines.push_back(line);
  }
  return table.title + "\n" + text_table(lines);
}

Json row_json(const PaperPart& part, const PaperRow& row) {
  return {{"part", part.title},
          {"what", row.what},
          {"paper", row.paper},
          {"here", row.here},
          {"value", or_null(row.value)},
          {"expected", or_null(row.expected)},
          {"verdict", row.verdict == PaperVerdict::kFails ? "fails" : word(row.verdict)},
          {"note", row.note}};
}

}  // namespace

std::string paper_text(const std::vector<PaperPart>& parts) {
  std::string out;
  for (const PaperPart& part : parts) {
    if (part.rows.empty() && part.tables.empty()) continue;
    out += part.title + '\n' + std::string(part.title.size(), '-') + '\n';
    if (!part.rows.empty()) out += rows_text(part.rows) + '\n';
    for (const PaperTable& table : part.tables) out += table_text(table) + '\n';
  }
  return out;
}

void add_paper_json(const std::vector<PaperPart>& parts, Json& json) {
  for (const char* key : {"rows", "tables", "figures"}) json[key] = Json::array();
  for (const PaperPart& part : parts) {
    for (const PaperRow& row : part.rows) json["rows"].push_back(row_json(part, row));
    for (const PaperTable& table : part.tables) {
      json["tables"].push_back(
          {{"title", table.title}, {"columns", table.columns}, {"rows", table.rows}});
    }
    for (const PaperFigure& figure : part.figures) {
      json["figures"].push_back({{"name", figure.name}, {"shows", figure.shows}});
    }
  }
}

std::size_t count_failures(const std::vector<PaperPart>& parts) {
  std::size_t failures = 0;
  for (const PaperPart& part : parts) {
    failures += static_cast<std::size_t>(
        std::count_if(part.rows.begin(), part.rows.end(), [](const PaperRow& row) {
          return row.verdict == PaperVerdict::kFails;
        }));
  }
  return failures;
}

}  // namespace carnot::apps
