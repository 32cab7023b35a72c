#include "carnot/plots/page.h"

#include <algorithm>
#include <cmath>

namespace carnot::plots {
namespace {

constexpr double kFar = 1e4;     // spans from the origin: beyond, an offset is taken off
constexpr double kFlat = 1e-12;  // relative span that is rounding only

// 1, 2 or 5 times a power of ten, not below x.
double round_step(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double m : {1.0, 2.0, 5.0}) {
    if (m * power >= x * (1 - 1e-9)) return m * power;
  }
  return 10 * power;
}

}  // namespace

void Interval::include(double x) {
  if (!std::isfinite(x) || std::abs(x) >= kTooLarge) return;
  lower = std::min(lower, x);
  upper = std::max(upper, x);
}

Axis::Axis(const Interval& values) {
  if (values.empty()) return;
  const double size = std::max(std::abs(values.lower), std::abs(values.upper));
  const double middle = values.lower + values.span() / 2;
  const bool flat = values.span() <= std::max(kFlat * size, 1e-100);
  if (flat ? size > kFar : size > kFar * values.span()) {
    const double unit = flat ? 1 : round_step(values.span());
    offset = std::round(middle / unit) * unit;
  }
  lower = flat ? middle - offset - 0.5 : values.lower - offset;
  upper = flat ? middle - offset + 0.5 : values.upper - offset;
}

void Axis::widen(double factor) { widen_to(factor * span()); }

void Axis::widen_to(double wanted_span) {
  const double more = std::max(0.0, wanted_span - span()) / 2;
  lower -= more;
  upper += more;
}

std::string Axis::label(const std::string& symbol, const std::string& unit) const {
  if (offset == 0) return with_unit(symbol, unit);
  return with_unit(symbol + (offset < 0 ? " + " : " − ") + number(std::abs(offset)), unit);
}

double tic_step(const Axis& axis, double about, int least) {
  const auto count = [&](double step) {
    return std::floor(axis.upper / step + 1e-9) - std::ceil(axis.lower / step - 1e-9) + 1;
  };
  double step = round_step(axis.span() / about);
  constexpr int kMostTries = 10;
  for (int i = 0; i < kMostTries && count(step) < least; ++i) step = round_step(step / 2.6);
  return step;
}

std::string tic_number(double x, double span) {
  constexpr int kDigits = 6;
  if (std::abs(x) < 1e-9 * span) return "0";
  return (x < 0 ? "−" : "") + number(std::abs(x), kDigits);
}

void set_axis(
    Script& script, const std::string& letter, const Axis& axis, double size, double spacing) {
  const double labels = std::max(2.0, size / spacing);
  const int least = labels < 4 ? 2 : 3;
  script << "set " << letter << "range [" << axis.lower << ":" << axis.upper << "]\n";
  script << "set " << letter << "tics " << tic_step(axis, labels, least) << "\n";
}

void set_box(Script& script, const Picture& page, const Box& box) {
  script << "set lmargin at screen " << box.x / page.width << "\n";
  script << "set rmargin at screen " << (box.x + box.width) / page.width << "\n";
  script << "set bmargin at screen " << box.y / page.height << "\n";
  script << "set tmargin at screen " << (box.y + box.height) / page.height << "\n";
}

void put_text(Script& script,
              const Picture& page,
              double x,
              double y,
              const std::string& markup,
              const std::string& options) {
  script << "set label " << quoted_markup(markup) << " at screen " << x / page.width << ", screen "
         << y / page.height << " " << options << "\n";
}

void clear_settings(Script& script) {
  script
      << "unset label\nunset object\nunset logscale\nunset colorbox\nunset grid\nset origin 0, 0\n"
      << "set size noratio 1, 1\nset key default\nset tics offset 0, 0\nset xlabel '' offset 0, 0\n"
      << "set ylabel '' offset 0, 0\nset format '%h'\n";
}

}  // namespace carnot::plots
