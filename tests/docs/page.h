// A page of the documentation, README.md or docs/*.md: its commands, the code it quotes, its links.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace carnot::docs {

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A fenced block: its language, the line before it, and what is in it.
struct Block {
  std::string language;
  std::string before;
  std::string text;
};

inline std::vector<Block> blocks(const std::string& page) {
  const std::string fence = "```";
  std::vector<Block> list;
  std::string before;
  bool inside = false;
  std::istringstream in(page);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(fence, 0) == 0) {
      inside = !inside;
      if (inside) list.push_back({line.substr(fence.size()), before, ""});
    } else if (inside) {
      list.back().text += line + '\n';
    }
    before = line;
  }
  return list;
}

// In a ```console block a line `$ COMMAND` is followed by the output of COMMAND, stdout and stderr.
struct Transcript {
  std::string command;
  std::string output;
};

inline std::vector<Transcript> transcripts(const std::string& page) {
  std::vector<Transcript> list;
  for (const Block& block : blocks(page)) {
    if (block.language != "console") continue;
    const std::size_t first = list.size();
    std::istringstream in(block.text);
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("$ ", 0) == 0) {
        list.push_back({line.substr(2), ""});
      } else if (list.size() > first) {
        list.back().output += line + '\n';
      }
    }
  }
  return list;
}

// Code of a file: all of it after the line `<!-- FILE -->`, some of its lines, one after the other,
// after the line `<!-- from FILE -->`. FILE is relative to the folder of the project.
struct Quotation {
  std::string file;  // empty where the page does not say which
  bool whole = true;
  std::string text;
};

inline std::vector<Quotation> quotations(const std::string& page) {
  static const std::regex kMarker("<!-- (from )?(\\S+) -->");
  std::vector<Quotation> list;
  for (const Block& block : blocks(page)) {
    if (block.language != "cpp" && block.language != "scene") continue;
    std::smatch match;
    const bool marked = std::regex_match(block.before, match, kMarker);
    list.push_back({marked ? match[2].str() : "", marked && !match[1].matched, block.text});
  }
  return list;
}

// What is not in fenced blocks.
inline std::string prose(const std::string& page) {
  std::string text;
  bool inside = false;
  std::istringstream in(page);
  for (std::string line; std::getline(in, line);) {
    const bool fence = line.rfind("```", 0) == 0;
    if (fence) inside = !inside;
    if (!fence && !inside) text += line + '\n';
  }
  return text;
}

// The targets of links to files and sections, and of pictures; no addresses on the web.
inline std::vector<std::string> links(const std::string& page) {
  static const std::regex kLink(R"(\]\(([^):]+)\))");
  const std::string text = prose(page);
  std::vector<std::string> list;
  for (std::sregex_iterator i(text.begin(), text.end(), kLink), end; i != end; ++i) {
    list.push_back((*i)[1].str());
  }
  return list;
}

// The name of the section under the heading, as in page.md#name.
inline std::string anchor_of(const std::string& heading) {
  std::string name;
  for (const char c : heading) {
    const auto code = static_cast<unsigned char>(c);
    if (std::isalnum(code) != 0 || c == '-' || c == '_') {
      name += static_cast<char>(std::tolower(code));
    } else if (c == ' ') {
      name += '-';
    }
  }
  return name;
}

inline std::vector<std::string> anchors(const std::string& page) {
  std::vector<std::string> list;
  std::istringstream in(prose(page));
  for (std::string line; std::getline(in, line);) {
    const std::size_t text = line.find_first_not_of('#');
    if (text == 0 || text == std::string::npos || line[text] != ' ') continue;
    list.push_back(anchor_of(line.substr(text + 1)));
  }
  return list;
}

}  // namespace carnot::docs
