#include "atlas/atlas_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include "atlas/atlas_hdf5.h"
#include "text/output_file.h"

namespace carnot::apps {
namespace {

class TextWriter : public AtlasWriter {
 public:
  TextWriter(const std::string& path, std::string name)
      : name_(std::move(name)), file_(path, std::ios::binary) {}
  void finish() override {
    file_.close();
    check();
  }

 protected:
  void line(const std::string& text) {
    file_ << text << '\n';
    check();
  }

 private:
  void check() const {
    if (!file_) throw std::runtime_error(fmt::format("cannot write '{}'", name_));
  }

  std::string name_;
  std::ofstream file_;
};

class LinesWriter : public TextWriter {
 public:
  LinesWriter(const std::string& path, const std::string& name, const AtlasLayout& layout)
      : TextWriter(path, name), times_(layout.times) {}
  void add(const Json& record) override {
    Json told = record;
    if (!times_) told.erase("seconds");
    line(json_line(told));
  }

 private:
  bool times_;
};

// A cell of CSV: numbers with 17 digits, lists with blanks between, nothing for null.
std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) {
    const std::string text = json_line(value);
    return text == "null" ? "" : text;
  }
  std::string text;
  for (const Json& item : value) {
    if (!text.empty()) text += ' ';
    text += cell(item);
  }
  return text;
}

Json value_of(const Json& object, const std::string& key) {
  return object.contains(key) ? object.at(key) : Json(nullptr);
}

// One row a geodesic, or one where there is none.
class CsvWriter : public TextWriter {
 public:
  CsvWriter(const std::string& path, const std::string& name, const AtlasLayout& layout)
      : TextWriter(path, name), layout_(layout) {
    std::vector<std::string> names{"index"};
    add_names("from_", names);
    add_names("to_", names);
    for (const char* key : {"status", "reason", "action", "length"}) names.emplace_back(key);
    add_names("p0_", names);
    for (const char* key : {"label", "morse_index", "endpoint_error", "knot_defect"}) {
      names.emplace_back(key);
    }
    if (layout.times) names.emplace_back("seconds");
    for (const char* key : {"rank", "time"}) names.emplace_back(key);
    for (const std::string& parameter : layout.parameters) names.push_back("set_" + parameter);
    for (int i = 1; i <= layout.multipliers; ++i) names.push_back(fmt::format("lambda0_{}", i));
    for (const char* key : {"verification", "conjugate_times", "hits", "missed_estimate"}) {
      names.emplace_back(key);
    }
    if (layout.limited) {
      for (const char* key : {"lowest_slack", "limit_violation"}) names.emplace_back(key);
    }
    if (layout.free_ends) {
      add_names("from_found_", names);
      add_names("to_found_", names);
    }
    line(fmt::format("{}", fmt::join(names, ",")));
  }

  void add(const Json& record) override {
    const Json& geodesics = record.at("geodesics");
    if (geodesics.empty()) row(record, Json::object(), 0);
    for (std::size_t i = 0; i < geodesics.size(); ++i) row(record, geodesics[i], i + 1);
  }

 private:
  void add_names(const std::string& prefix, std::vector<std::string>& names) const {
    for (const std::string& name : layout_.coordinates) names.push_back(prefix + name);
  }
  // As many cells as there are, `missing` where there is no number.
  static void add_cells(const Json& values,
                        std::size_t count,
                        const char* missing,
                        std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::string text = values.is_array() ? cell(values.at(i)) : "";
      cells.push_back(values.is_array() && text.empty() ? missing : text);
    }
  }
  void row(const Json& record, const Json& geodesic, std::size_t rank) {
    const std::size_t n = layout_.coordinates.size();
    std::vector<std::string> cells{cell(record.at("index"))};
    add_cells(record.at("from"), n, "*", cells);
    add_cells(record.at("to"), n, "*", cells);
    for (const char* key : {"status", "reason"}) cells.push_back(cell(record.at(key)));
    for (const char* key : {"action", "length"}) cells.push_back(cell(value_of(geodesic, key)));
    add_cells(value_of(geodesic, "p0"), n, "", cells);
    for (const char* key : {"label", "morse_index", "endpoint_error", "knot_defect"}) {
      cells.push_back(cell(value_of(geodesic, key)));
    }
    if (layout_.times) cells.push_back(cell(record.at("seconds")));
    cells.push_back(rank > 0 ? std::to_string(rank) : "");
    cells.push_back(cell(record.at("time")));
    for (const std::string& parameter : layout_.parameters) {
      cells.push_back(cell(record.at("parameters").at(parameter)));
    }
    add_cells(value_of(geodesic, "lambda0"), layout_.multipliers, "", cells);
    for (const char* key : {"verification", "conjugate_times", "hits"}) {
      cells.push_back(cell(value_of(geodesic, key)));
    }
    cells.push_back(cell(record.at("missed_estimate")));
    if (layout_.limited) {
      cells.push_back(cell(lowest_slack(geodesic)));
      cells.push_back(cell(value_of(geodesic, "limit_violation")));
    }
    if (layout_.free_ends) {
      add_cells(value_of(geodesic, "from_found"), n, "", cells);
      add_cells(value_of(geodesic, "to_found"), n, "", cells);
    }
    line(fmt::format("{}", fmt::join(cells, ",")));
  }

  AtlasLayout layout_;
};

}  // namespace

Json lowest_slack(const Json& geodesic) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Json& limit : geodesic.value("limits", Json::array())) {
    lowest = std::min(lowest, limit.at("lowest_slack").get<double>());
  }
  return std::isfinite(lowest) ? Json(lowest) : Json(nullptr);
}

std::unique_ptr<AtlasWriter> make_atlas_writer(const std::string& path,
                                               const std::string& name,
                                               const AtlasLayout& layout) {
  if (has_ending(name, ".csv")) return std::make_unique<CsvWriter>(path, name, layout);
  if (has_ending(name, ".jsonl")) return std::make_unique<LinesWriter>(path, name, layout);
  return make_hdf5_writer(path, name, layout);
}

}  // namespace carnot::apps
