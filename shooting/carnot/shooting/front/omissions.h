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
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

}  // namespace carnot::internal
