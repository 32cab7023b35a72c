// The words of a text: names, numbers and marks, line by line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "carnot/language/text_error.h"

namespace carnot::language {

struct Token {
  enum class Kind {
    kName,
    kNumber,
    kMark,     // one of + - * / ^ ' ( ) [ ] , ; : = > <, or --, ->, >=, <=
    kText,     // "..."
    kLineEnd,  // of a statement: none inside brackets
    kEnd,
    kBad,  // a character that the language does not have, or a number that is none
  };
  Kind kind = Kind::kEnd;
  std::string text{};
  double number = 0;
  Place place{};
};

// The tokens of a text, the last of them kEnd; a token kBad is the last one, too. `first_comment`,
// if not null, gets the comment of the first line.
std::vector<Token> tokens_of(std::string_view text, std::string* first_comment = nullptr);

}  // namespace carnot::language
