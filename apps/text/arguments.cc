#include "text/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "text/numbers.h"

namespace carnot::apps {
namespace {

bool contains(const std::vector<std::string>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// `--word`; a value never looks like that.
bool looks_like_option(std::string_view text) {
  return text.size() > 2 && text.starts_with("--") &&
         std::isalpha(static_cast<unsigned char>(text[2])) != 0;
}

}  // namespace

std::vector<std::string> join_values(const std::vector<std::string>& arguments,
                                     const OptionNames& names) {
  std::vector<std::string> joined;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::size_t equals = arguments[i].find('=');
    const std::string name = arguments[i].substr(0, equals);
    if (equals != std::string::npos && contains(names.flags, name)) {
      refuse(name, arguments[i].substr(equals + 1), "takes no value", name);
    }
    const bool repeatable = contains(names.repeatable, name);
    if (!repeatable && !contains(names.valued, name)) {
      joined.push_back(arguments[i]);
      continue;
    }
    std::string value;
    if (equals != std::string::npos) {
      value = arguments[i].substr(equals + 1);
    } else if (i + 1 < arguments.size() && !looks_like_option(arguments[i + 1])) {
      value = arguments[++i];
    }
    if (value.empty()) {
      refuse(name, value, "the value is missing", name + " VALUE");
    }
    if (!seen.insert(name).second && !repeatable) {
      refuse(name, value, "given twice", name + " once");
    }
    joined.push_back(fmt::format("{}={}", name, value));
  }
  return joined;
}

std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    const bool control = code < 0x20 || code == 0x7f;
    if (c == '\n') {
      line += "\\n";
    } else if (control) {
      line += fmt::format("\\x{:02x}", code);
    } else {
      line += c;
    }
  }
  return line;
}

}  // namespace carnot::apps
