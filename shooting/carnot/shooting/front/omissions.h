// What a mesh leaves out, told as one line.
#pragma once

#include <ostream>
#include <sstream>
#include <string>

namespace carnot::internal {

class Omissions {
 public:
  Omissions() { text_.precision(4); }

  // Where the next thing that is left out is to be written.
  std::ostream& add() { return text_ << (text_.view().empty() ? "" : "; "); }
  void add_unknown_cuts(long count) {
    if (count == 0) return;
    add() << "searches did not find the cut times of " << count
          << " extremals, which are taken for their conjugate times";
  }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

}  // namespace carnot::internal
