// What is wrong in a text, and where.
#pragma once

#include <stdexcept>
#include <string>

namespace carnot::language {

// A place in a text; both begin at 1.
struct Place {
  int line = 0;
  int column = 0;
};

// what() is "NAME:LINE:COLUMN: what is wrong", then the line and a caret below the place.
class TextError : public std::invalid_argument {
 public:
  TextError(const std::string& text, const Place& place)
      : std::invalid_argument(text), place_(place) {}
  [[nodiscard]] const Place& place() const { return place_; }

 private:
  Place place_;
};

}  // namespace carnot::language
