// Axes and their place on the page.
//
// Far from the origin (a path of size 1 at x = 4.5e9) tick labels would all read the same, so an
// axis carries an offset that is taken off the values and named in the label.
#pragma once

#include <limits>
#include <string>

#include "carnot/plots/plot_file.h"
#include "carnot/plots/script.h"

namespace carnot::plots {

struct Interval {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();

  void include(double x);  // ignores what is not finite
  [[nodiscard]] bool empty() const { return lower > upper; }
  [[nodiscard]] double span() const { return upper - lower; }
};

// Values x are drawn at x - offset, inside [lower, upper], never empty.
struct Axis {
  double lower = 0;
  double upper = 1;
  double offset = 0;

  explicit Axis(const Interval& values);
  [[nodiscard]] double span() const { return upper - lower; }
  [[nodiscard]] double at(double x) const { return x - offset; }
  void widen(double factor);          // about the middle
  void widen_to(double wanted_span);  // about the middle, never narrower
  // "x [length]", or "x - 4500000000 [length]", markup.
  [[nodiscard]] std::string label(const std::string& symbol, const std::string& unit) const;
};

// A box on the canvas of a picture, in its units.
struct Box {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

// A step of tics, 1, 2 or 5 times a power of ten: about so many, and not fewer than `least` <= 3.
double tic_step(const Axis& axis, double about, int least);
// The number at a tic of an axis of that span, without round-off; markup.
std::string tic_number(double x, double span);

// "set Xrange" and tics, about one per `spacing` units of a side that is `size` long.
void set_axis(
    Script& script, const std::string& letter, const Axis& axis, double size, double spacing);
// Places the inside of the next plot.
void set_box(Script& script, const Picture& page, const Box& box);
// Text centred at a place on the page.
void put_text(Script& script,
              const Picture& page,
              double x,
              double y,
              const std::string& markup,
              const std::string& options = "center");
// Back to the defaults of what a panel sets; the palette stays, since a .gif holds 256 colours.
void clear_settings(Script& script);

}  // namespace carnot::plots
