#include "carnot/plots/script.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <locale>
#include <utility>

#include "carnot/plots/units.h"

namespace carnot::plots {
namespace {

std::string classic(double x, int digits) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(digits);
  out << x;
  return out.str();
}

struct Rgb {
  int r, g, b;
};

// matplotlib's plasma at 0, 1/8, ..., 6/8.
constexpr std::array<Rgb, 7> kPlasma{{{0x0d, 0x08, 0x87},
                                      {0x4b, 0x03, 0xa1},
                                      {0x7d, 0x03, 0xa8},
                                      {0xa8, 0x22, 0x96},
                                      {0xcb, 0x46, 0x79},
                                      {0xe5, 0x6b, 0x5d},
                                      {0xf0, 0x7f, 0x2f}}};

}  // namespace

std::string quoted_markup(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += "''";
    else
      out += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? ' ' : c;
  }
  return out + "'";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string("\\^_{}@&~").find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string quoted(const std::string& text) { return quoted_markup(escaped(text)); }

std::string symbol(const std::string& name) {
  static const std::vector<std::pair<std::string, std::string>> kGreek = {{"alpha", "α"},
                                                                          {"beta", "β"},
                                                                          {"gamma", "γ"},
                                                                          {"delta", "δ"},
                                                                          {"lambda", "λ"},
                                                                          {"phi", "φ"},
                                                                          {"psi", "ψ"},
                                                                          {"theta", "θ"},
                                                                          {"omega", "ω"}};
  std::size_t end = name.size();
  while (end > 0 && std::isdigit(static_cast<unsigned char>(name[end - 1])) != 0) --end;
  std::string stem = name.substr(0, end);
  for (const auto& [word, letter] : kGreek) {
    if (stem == word) stem = letter;
  }
  const std::string index = name.substr(end);
  return escaped(stem) + (index.empty() || stem.empty() ? index : "_{" + index + "}");
}

std::string with_unit(const std::string& symbol, const std::string& unit) {
  return unit.empty() ? symbol : symbol + " [" + unit_markup(unit) + "]";
}

double text_width(const std::string& markup) {
  constexpr double kLetter = 7.6;
  double letters = 0;
  for (const char c : markup) {
    const bool continues = (static_cast<unsigned char>(c) & 0xc0U) == 0x80U;  // of a UTF-8 letter
    if (!continues && std::string("\\^_{}").find(c) == std::string::npos) ++letters;
  }
  return kLetter * letters;
}

std::string number(double x, int digits) { return classic(x, digits); }

std::string line_color_of(const char* color) { return std::string("lc rgb '") + color + "'"; }

std::string line_color(std::size_t i) {
  static constexpr std::array<const char*, 7> kColors = {
      "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"};
  return std::string("lc rgb '") + kColors[i % kColors.size()] + "' dt " +
         std::to_string(1 + i / kColors.size() % 4);
}

std::string TimeColors::palette() {
  std::string text = "set palette defined (";
  for (std::size_t i = 0; i < kPlasma.size(); ++i) {
    const Rgb c = kPlasma[i];
    std::array<char, 16> hex{};
    std::snprintf(hex.data(), hex.size(), "#%02x%02x%02x", c.r, c.g, c.b);
    text += (i == 0 ? "" : ", ") + std::to_string(i) + " '" + hex.data() + "'";
  }
  return text + ") maxcolors 64\n";  // a .gif holds 256 colours
}

double TimeColors::argb(double fraction, int alpha) {
  const auto last = static_cast<double>(kPlasma.size() - 1);
  const double place = std::clamp(fraction, 0.0, 1.0) * last;
  const auto i = static_cast<std::size_t>(std::min(place, last - 1));
  const double w = place - static_cast<double>(i);
  const auto mix = [w](int a, int b) { return std::round(a + w * (b - a)); };
  const Rgb a = kPlasma[i];
  const Rgb b = kPlasma[i + 1];
  return ((alpha * 256.0 + mix(a.r, b.r)) * 256.0 + mix(a.g, b.g)) * 256.0 + mix(a.b, b.b);
}

double TimeColors::pale(double fraction) {
  constexpr double kSteps = 63;
  constexpr double kVeil = 0.7;
  const double rounded = std::round(std::clamp(fraction, 0.0, 1.0) * kSteps) / kSteps;
  const auto color = static_cast<unsigned>(argb(rounded, 0));
  double mixed = 0;
  for (const unsigned shift : {16U, 8U, 0U}) {
    const auto part = static_cast<double>((color >> shift) & 0xffU);
    mixed = mixed * 256 + std::round(part + kVeil * (255 - part));
  }
  return mixed;
}

Script::Script() {
  text_.imbue(std::locale::classic());
  text_.precision(15);
}

bool drawable(const Row& row) {
  return !row.empty() && std::all_of(row.begin(), row.end(), [](double x) {
    return std::isfinite(x) && std::abs(x) < kTooLarge;
  });
}

bool drawable(const Rows& rows) {
  return std::any_of(rows.begin(), rows.end(), [](const Row& row) { return drawable(row); });
}

std::string Script::data(const Rows& rows) {
  if (!drawable(rows)) return {};
  std::string name = "$d" + std::to_string(++blocks_);
  text_ << name << " << EOD\n";
  bool open = false;  // a line has begun
  for (const Row& row : rows) {
    if (drawable(row)) {
      for (std::size_t i = 0; i < row.size(); ++i) text_ << (i == 0 ? "" : " ") << row[i];
      text_ << "\n";
      open = true;
    } else if (open) {  // one blank line: two would begin a new data set
      text_ << "\n";
      open = false;
    }
  }
  text_ << "EOD\n";
  return name;
}

Plot::Plot(Script& script, std::string command, const Row& corner)
    : script_(script), command_(std::move(command)) {
  command_ += " " + script_.data({corner}) + " with lines notitle";
}

Plot& Plot::add(const Rows& rows, const std::string& style) {
  const std::string name = script_.data(rows);
  if (!name.empty()) command_ += ", " + name + " " + style + " notitle";
  return *this;
}

Plot& Plot::key(const std::string& style, const std::string& markup) {
  command_ += ", keyentry " + style + " title " + quoted_markup(markup);
  return *this;
}

void Plot::draw() { script_ << command_ << "\n"; }

}  // namespace carnot::plots
