#include "carnot/language/lexer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace carnot::language {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  std::vector<Token> run(std::string* first_comment) {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\n') {
        line_end();
      } else if (is_space(c)) {
        ++at_;
      } else if (c == '#') {
        comment(first_comment);
      } else if (is_letter(c)) {
        word();
      } else if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) {
        if (!number()) return std::move(tokens_);
      } else if (c == '"') {
        if (!quoted()) return std::move(tokens_);
      } else if (!mark()) {
        add(Token::Kind::kBad, std::string(1, c));
        return std::move(tokens_);
      }
    }
    add(Token::Kind::kLineEnd, "");
    add(Token::Kind::kEnd, "");
    return std::move(tokens_);
  }

 private:
  void add(Token::Kind kind, std::string text, double number = 0) {
    const Place place{line_, static_cast<int>(at_ - line_start_) + 1};
    tokens_.push_back({kind, std::move(text), number, place});
  }

  // Brackets that are open join lines.
  void line_end() {
    if (open_ <= 0) add(Token::Kind::kLineEnd, "");
    ++at_;
    ++line_;
    line_start_ = at_;
  }

  void comment(std::string* first_comment) {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    if (first_comment != nullptr && line_ == 1)
      *first_comment = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end;
  }

  void word() {
    std::size_t end = at_;
    while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
    add(Token::Kind::kName, std::string(text_.substr(at_, end - at_)));
    at_ = end;
  }

  bool number() {
    double value = 0;
    const char* const begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) {
      add(Token::Kind::kBad, std::string(begin, end));
      return false;
    }
    add(Token::Kind::kNumber, std::string(begin, end), value);
    at_ += static_cast<std::size_t>(end - begin);
    return true;
  }

  bool quoted() {
    const std::size_t end = text_.find_first_of("\"\n", at_ + 1);
    if (end == std::string_view::npos || text_[end] == '\n') {
      add(Token::Kind::kBad, "\"");
      return false;
    }
    add(Token::Kind::kText, std::string(text_.substr(at_ + 1, end - at_ - 1)));
    at_ = end + 1;
    return true;
  }

  bool mark() {
    constexpr std::array<std::string_view, 4> kPairs{"--", "->", ">=", "<="};
    constexpr std::string_view kMarks = "+-*/^'()[],;:=><";
    for (const std::string_view pair : kPairs) {
      if (text_.substr(at_, 2) == pair) {
        add(Token::Kind::kMark, std::string(pair));
        at_ += 2;
        return true;
      }
    }
    const char c = text_[at_];
    if (kMarks.find(c) == std::string_view::npos) return false;
    if (c == '(' || c == '[') ++open_;
    if ((c == ')' || c == ']') && open_ > 0) --open_;
    add(Token::Kind::kMark, std::string(1, c));
    ++at_;
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
  int open_ = 0;  // brackets
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> tokens_of(std::string_view text, std::string* first_comment) {
  return Lexer(text).run(first_comment);
}

}  // namespace carnot::language
