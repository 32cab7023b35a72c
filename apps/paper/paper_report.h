// What `carnot paper` has found: claims of the paper and what became of them, tables, figures.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "text/json_text.h"

namespace carnot::apps {

enum class PaperVerdict {
  kHolds,     // measured as it should be
  kMisprint,  // the paper's own equations give something else, and that was measured
  kFails      // measured, and not as it should be
};

constexpr PaperVerdict holds(bool yes) { return yes ? PaperVerdict::kHolds : PaperVerdict::kFails; }

struct PaperRow {
  std::string what;
  std::string paper;  // what the paper says
  std::string here;   // what was measured
  PaperVerdict verdict = PaperVerdict::kHolds;
  std::string note{};                // how it was measured or why it is so
  std::optional<double> value{};     // the number behind `here`
  std::optional<double> expected{};  // what it should be, where a formula says so
};

// A table of numbers.
struct PaperTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

struct PaperFigure {
  std::string name;  // of the file, without its ending
  std::string shows;
  std::function<std::string(const std::string& file)> draw;  // returns warnings
};

// One subject.
struct PaperPart {
  std::string title;
  std::vector<PaperRow> rows{};
  std::vector<PaperTable> tables{};
  std::vector<PaperFigure> figures{};
};

std::string paper_text(const std::vector<PaperPart>& parts);
// Adds "rows", "tables" and "figures".
void add_paper_json(const std::vector<PaperPart>& parts, Json& json);
// How many rows fail.
std::size_t count_failures(const std::vector<PaperPart>& parts);

}  // namespace carnot::apps
