#include "atlas/problem_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "carnot/language/nearest.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr long kStride = 64;

// The lines of a file from an offset on, without their ends.
class Lines {
 public:
  Lines(int file, std::int64_t offset) : file_(file), offset_(offset) {}

  // Where the next line begins.
  [[nodiscard]] std::int64_t offset() const { return offset_; }
  std::optional<std::string> next() {
    std::size_t end = block_.find('\n', at_);
    while (end == std::string::npos && fill()) end = block_.find('\n', at_);
    if (end == std::string::npos) {
      if (at_ == block_.size()) return std::nullopt;
      end = block_.size();
    }
    std::string line = block_.substr(at_, end - at_);
    offset_ += static_cast<std::int64_t>(std::min(end + 1, block_.size()) - at_);
    at_ = std::min(end + 1, block_.size());
    if (line.ends_with('\r')) line.pop_back();
    return line;
  }

 private:
  // Adds a block; false at the end of the file.
  bool fill() {
    constexpr std::size_t kBlock = 1 << 16;
    block_.erase(0, at_);
    at_ = 0;
    const std::size_t size = block_.size();
    block_.resize(size + kBlock);
    ssize_t got = -1;
    do {
      got = pread(file_, block_.data() + size, kBlock, offset_ + static_cast<off_t>(size));
    } while (got < 0 && errno == EINTR);
    block_.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return got > 0;
  }

  int file_;
  std::int64_t offset_;
  std::string block_;
  std::size_t at_ = 0;
};

bool is_blank(const std::string& line) {
  return line.find_first_not_of(" \t,") == std::string::npos;
}

// What stands between the commas, without blanks and quotes around it.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) {
    const auto strip = [&](const char* what) {
      const std::size_t first = cell.find_first_not_of(what);
      cell = first == std::string::npos
                 ? ""
                 : cell.substr(first, cell.find_last_not_of(what) - first + 1);
    };
    strip(" \t");
    strip("\"");
  }
  return cells;
}

}  // namespace

ProblemFile::ProblemFile(const ListOptions& options, const Run& run, Ends given)
    : path_(options.problems),
      entry_(*run.entry),
      parameters_(run.parameters),
      given_(std::move(given)),
      file_(open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_ < 0) {
    refuse("--problems", path_, std::strerror(errno), "a file of comma-separated values");
  }
  try {
    Lines lines(file_, 0);
    std::optional<std::string> header = lines.next();
    if (!header || is_blank(*header)) {
      refuse("--problems", path_, "it has no header", "columns from_NAME and to_NAME");
    }
    if (header->starts_with("\xef\xbb\xbf")) header->erase(0, 3);  // a byte order mark
    read_header(*header, options);
    read_lines();
  } catch (...) {
    close(file_);
    throw;
  }
}

ProblemFile::~ProblemFile() { close(file_); }

void ProblemFile::read_header(const std::string& line, const ListOptions& options) {
  const std::vector<std::string> coordinates = coordinate_names(entry_);
  std::vector<std::string> known{"time"};
  for (const std::string& name : coordinates) known.push_back("from_" + name);
  for (const std::string& name : coordinates) known.push_back("to_" + name);
  for (const ParameterInfo& parameter : entry_.parameters) known.push_back("set_" + parameter.name);
  const std::string where = path_ + ":1: column";
  for (const std::string& name : cells_of(line)) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      refuse(where,
             name,
             "not expected" + language::suggestion(name, known),
             fmt::format("{}", fmt::join(known, ", ")));
    }
    if (std::any_of(columns_.begin(), columns_.end(), [&](const Column& column) {
          return column.name == name;
        })) {
      refuse(where, name, "given twice", "each column once");
    }
    const auto index = static_cast<int>(found - known.begin());
    const auto n = static_cast<int>(coordinates.size());
    Column column{name, Column::Role::kTime, 0};
    if (index > 2 * n) {
      column.role = Column::Role::kParameter;
      column.index = static_cast<int>(set_.size());
      set_.push_back(entry_.parameters[index - 2 * n - 1].name);
    } else if (index > 0) {
      column.role = index > n ? Column::Role::kTo : Column::Role::kFrom;
      column.index = (index - 1) % n;
    }
    columns_.push_back(std::move(column));
  }
  // Each coordinate has a column, or an option says what it is.
  for (const auto& [prefix, given] : {std::pair<std::string, std::string>{"from_", options.from},
                                      std::pair<std::string, std::string>{"to_", options.to}}) {
    if (!given.empty()) continue;
    for (const std::string& name : coordinates) {
      const std::string wanted = prefix + name;
      if (std::none_of(columns_.begin(), columns_.end(), [&](const Column& column) {
            return column.name == wanted;
          })) {
        refuse(where, wanted, "is missing", fmt::format("{}", fmt::join(known, ", ")));
      }
    }
  }
}

void ProblemFile::read_lines() {
  Lines lines(file_, 0);
  (void)lines.next();
  long number = 2;
  for (;; ++number) {
    const std::int64_t offset = lines.offset();
    const std::optional<std::string> line = lines.next();
    if (!line) break;
    if (is_blank(*line)) continue;
    const AtlasProblem problem = parse(*line, fmt::format("{}:{}: column", path_, number));
    has_free_ = has_free_ || apps::has_free(problem.ends);
    if (size_ % kStride == 0) places_.push_back({offset, number});
    ++size_;
  }
  if (size_ == 0) refuse("--problems", path_, "it has no problems", "a line for each problem");
}

AtlasProblem ProblemFile::parse(const std::string& line, const std::string& where) const {
  const std::vector<std::string> cells = cells_of(line);
  if (cells.size() != columns_.size()) {
    refuse(where.substr(0, where.rfind(':')),
           line,
           fmt::format("{} values", cells.size()),
           fmt::format("{}, one for each column of the header", columns_.size()));
  }
  const auto as_given = [](const std::vector<double>& end, const std::vector<bool>& free) {
    std::vector<std::optional<double>> values(end.begin(), end.end());
    for (std::size_t j = 0; j < end.size(); ++j) {
      if (free[j]) values[j].reset();
    }
    return values;
  };
  std::vector<std::optional<double>> from = as_given(given_.from, given_.free_from);
  std::vector<std::optional<double>> to = as_given(given_.to, given_.free_to);
  double time = given_.time;
  ParameterValues parameters = parameters_;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Column& column = columns_[i];
    const std::string place = where + " " + column.name;
    switch (column.role) {
      case Column::Role::kTime:
        time = parse_positive(place, cells[i]);
        break;
      case Column::Role::kParameter: {
        const std::string& name = set_[column.index];
        const std::string text = name + "=" + cells[i];
        parameters[name] = parse_parameter(entry_, place, text, "a number in range").second;
        break;
      }
      case Column::Role::kFrom:
      case Column::Role::kTo: {
        auto& end = column.role == Column::Role::kFrom ? from : to;
        end[column.index] = parse_end(place, cells[i], {column.name})[0];
        break;
      }
    }
  }
  AtlasProblem problem{ends_of(from, to), std::move(parameters)};
  problem.ends.time = time;
  return problem;
}

AtlasProblem ProblemFile::at(long i) const {
  const Place& place = places_[i / kStride];
  Lines lines(file_, place.offset);
  long skip = i % kStride;
  for (long number = place.line;; ++number) {
    const std::optional<std::string> line = lines.next();
    if (!line) throw std::runtime_error(fmt::format("'{}' has changed while it was read", path_));
    if (is_blank(*line)) continue;
    if (skip-- == 0) return parse(*line, fmt::format("{}:{}: column", path_, number));
  }
}

Json ProblemFile::identity_of_first(long count) const {
  Json columns = Json::array();
  for (const Column& column : columns_) columns.push_back(column.name);
  boost::crc_32_type sum;
  Lines lines(file_, 0);
  (void)lines.next();
  for (long left = count; left > 0;) {
    const std::optional<std::string> line = lines.next();
    if (!line) throw std::runtime_error(fmt::format("'{}' has changed while it was read", path_));
    if (is_blank(*line)) continue;
    sum.process_bytes(line->data(), line->size());
    sum.process_byte('\n');
    --left;
  }
  return {{"file", {{"problems", count}, {"columns", columns}, {"checksum", sum.checksum()}}},
          {"from", end_json(given_.from, given_.free_from)},
          {"to", end_json(given_.to, given_.free_to)},
          {"time", given_.time}};
}

Json ProblemFile::identity_then(const Json& there) const {
  const Json file = there.value("file", Json::object());
  const Json size = file.value("problems", Json(nullptr));
  return identity_of_first(size.is_number_integer() && size < size_ ? size.get<long>() : size_);
}

}  // namespace carnot::apps
