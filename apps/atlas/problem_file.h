// Problems in a CSV file: a header of from_NAME, to_NAME and, where wanted, time and set_PARAMETER,
// then a line for each problem.
//
// All lines are checked before any is solved. After that only where they begin is kept, for each 64
// of them, so that memory does not grow with the file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "atlas/problem_list.h"

namespace carnot::apps {

class ProblemFile : public ProblemList {
 public:
  // `given` is what --from, --to and --time say, of coordinates without a column. Throws
  // std::invalid_argument naming line and column.
  ProblemFile(const ListOptions& options, const Run& run, Ends given);
  ~ProblemFile() override;

  [[nodiscard]] long size() const override { return size_; }
  [[nodiscard]] AtlasProblem at(long i) const override;
  [[nodiscard]] Json identity() const override { return identity_of_first(size_); }
  [[nodiscard]] Json identity_then(const Json& there) const override;
  [[nodiscard]] bool has_free() const override { return has_free_; }
  [[nodiscard]] std::vector<std::string> parameters() const override { return set_; }

 private:
  // Where the numbers of a column go.
  struct Column {
    enum class Role { kFrom, kTo, kTime, kParameter };
    std::string name;
    Role role = Role::kTime;
    int index = 0;  // of the coordinate, or of the parameter in set_
  };

  void read_header(const std::string& line, const ListOptions& options);
  // Checks all lines and notes where they are.
  void read_lines();
  // Throws std::runtime_error where the file has changed.
  [[nodiscard]] Json identity_of_first(long count) const;
  [[nodiscard]] AtlasProblem parse(const std::string& line, const std::string& where) const;

  std::string path_;
  const SceneEntry& entry_;
  ParameterValues parameters_;
  Ends given_;
  int file_ = -1;
  std::vector<Column> columns_;
  std::vector<std::string> set_;
  bool has_free_ = false;
  long size_ = 0;
  struct Place {
    std::int64_t offset = 0;
    long line = 0;
  };
  std::vector<Place> places_;  // of every kStride-th problem
};

}  // namespace carnot::apps
