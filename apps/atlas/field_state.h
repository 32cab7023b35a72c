// The state of a field that is not done, in a file beside its journal.
//
// The journal says which call it belongs to, and keeps other runs away.
#pragma once

#include <chrono>
#include <fstream>
#include <functional>
#include <istream>
#include <ostream>
#include <string>

namespace carnot::apps {

class FieldState {
 public:
  // `path` is that of the journal.
  explicit FieldState(const std::string& path);

  // What an earlier call has left; nullptr where there is none.
  [[nodiscard]] std::istream* earlier();
  // Writes it anew, where enough time has passed since: a twentieth of the time goes into that, and
  // it is not done more often than every half second. Throws std::runtime_error where it cannot be
  // written; what was there before stays.
  void keep(const std::function<void(std::ostream&)>& write);
  [[nodiscard]] bool exists() const;
  // The file is not needed any more.
  void remove();

 private:
  using Clock = std::chrono::steady_clock;

  std::string path_;
  std::string temporary_;  // one run at a time holds the journal
  std::ifstream earlier_;
  Clock::time_point last_ = Clock::now();
  Clock::duration pause_;
};

}  // namespace carnot::apps
