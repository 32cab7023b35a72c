// The state of a field that is not done, in a file beside its journal.
//
// The journal says which call it belongs to, and keeps other runs away.
#pragma once

#include <chrono>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "carnot/shooting/solve_field.h"

namespace carnot::apps {

class FieldState {
 public:
  // `path` is that of the journal.
  explicit FieldState(const std::string& path);

  // solve_field() from what an earlier call has left; where that is damaged, from the beginning.
  // Throws what it throws, and std::runtime_error where the state cannot be written; what was there
  // before stays.
  Field solve(const BoundaryValueProblem& problem,
              const std::vector<FieldAxis>& axes,
              FieldOptions options);
  // How many states were damaged.
  [[nodiscard]] long repaired() const { return repaired_; }
  [[nodiscard]] bool exists() const;
  // The file is not needed any more.
  void remove();

 private:
  using Clock = std::chrono::steady_clock;

  // Writes it anew, where enough time has passed since: a twentieth of the time goes into that, and
  // it is not done more often than every half second.
  void keep(const std::function<void(std::ostream&)>& write);

  std::string path_;
  std::string temporary_;  // one run at a time holds the journal
  long repaired_ = 0;
  Clock::time_point last_ = Clock::now();
  Clock::duration pause_;
};

}  // namespace carnot::apps
