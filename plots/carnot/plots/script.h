// The text of a gnuplot script: numbers, labels, data and one plot command at a time.
//
// Numbers are written in the classic locale whatever the program's own is. A value that is not
// finite never reaches gnuplot: its row becomes a gap in the line, and a line without any point is
// not plotted, so that no data can make gnuplot complain.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace carnot::plots {

using Row = std::vector<double>;
using Rows = std::vector<Row>;

// A blank row ends a line; inside Plot::add.
inline Row gap() { return {}; }

// Numbers from here on cannot be drawn: gnuplot squares them.
inline constexpr double kTooLarge = 1e150;
// Whether all the numbers of a row can be drawn, and whether those of any row can be.
bool drawable(const Row& row);
bool drawable(const Rows& rows);

// 'text' as a gnuplot string that shows exactly these characters.
std::string quoted(const std::string& text);
// The same for text that is already in gnuplot's markup.
std::string quoted_markup(const std::string& text);
// Markup of a coordinate's name: Greek letters, and a trailing number as a subscript.
std::string symbol(const std::string& name);
// Characters as they are, in markup.
std::string escaped(const std::string& text);
// "symbol [unit]", markup; the unit as in units.h.
std::string with_unit(const std::string& symbol, const std::string& unit);
// About how wide a text in markup will be, in hundredths of an inch at the size of labels.
double text_width(const std::string& markup);
// A number of the given significant digits, as in "%g".
std::string number(double x, int digits = 15);

// "lc rgb 'COLOR'".
std::string line_color_of(const char* color);
// Colours that colour-blind readers can tell apart (Okabe and Ito 2008).
std::string line_color(std::size_t i);

// Time, from start to end: the darker three quarters of the "plasma" map, even in perception.
struct TimeColors {
  static constexpr const char* kStart = "#0d0887";
  static constexpr const char* kMiddle = "#a82296";
  static constexpr const char* kEnd = "#f07f2f";
  static std::string palette();
  // "0xAARRGGBB" for a fraction of the time; alpha 0 is opaque.
  static double argb(double fraction, int alpha);
  // The colour of a fraction of the time in front of white, as through a thin veil; one of 64.
  static double pale(double fraction);
};

class Script {
 public:
  Script();

  template <class T>
  Script& operator<<(const T& x) {
    text_ << x;
    return *this;
  }
  // Starts an inline data block that can be plotted by its name; empty if no row can be drawn.
  std::string data(const Rows& rows);
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  int blocks_ = 0;
};

// One plot or splot command, put together piece by piece.
class Plot {
 public:
  // `corner` is a point inside the ranges: it keeps the command valid when nothing else is drawn.
  Plot(Script& script, std::string command, const Row& corner);

  Plot& add(const Rows& rows, const std::string& style);
  Plot& key(const std::string& style, const std::string& markup);
  void draw();

 private:
  Script& script_;
  std::string command_;
};

}  // namespace carnot::plots
