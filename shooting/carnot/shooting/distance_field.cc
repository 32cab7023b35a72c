#include "carnot/shooting/distance_field.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "carnot/numerics/checksum.h"

namespace carnot {
namespace {

constexpr const char* kFirstLine = "carnot distance field 1";
constexpr double kRounded = 1e-9;  // of a step or a period; less is round-off

float rounded_down(double x) {
  const auto nearest = static_cast<float>(x);
  return nearest <= x ? nearest : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}

float rounded_up(double x) { return -rounded_down(-x); }

std::uint64_t checksum_of(const std::string& bytes) {
  Checksum sum;
  sum.add(bytes);
  return sum.value();
}

// Four bytes each, the lowest first.
std::string bytes_of(const std::vector<float>& values) {
  std::string bytes;
  bytes.reserve(4 * values.size());
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift);
  }
  return bytes;
}

std::vector<float> values_of(const std::string& bytes) {
  std::vector<float> values(bytes.size() / 4);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint32_t bits = 0;
    for (int k = 0; k < 4; ++k) {
      bits |= std::uint32_t{static_cast<unsigned char>(bytes[4 * i + k])} << (8 * k);
    }
    values[i] = std::bit_cast<float>(bits);
  }
  return values;
}

}  // namespace

DistanceField::DistanceField(const BoundaryValueProblem& problem,
                             const std::vector<FieldAxis>& axes,
                             bool mod_angles,
                             const Field& field)
    : scene_(problem.dynamics.info.name), from_(problem.from) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(what);
  };
  require(field.finished, "a field that was stopped has no distances");
  std::vector<bool> seen(from_.size());
  for (const FieldAxis& axis : axes) {
    require(axis.values.size() >= 3, "an axis of a distance field has at least 3 values");
    const auto& coordinate = problem.dynamics.info.configuration.at(axis.coordinate);
    require(!seen.at(axis.coordinate), "a coordinate has two axes");
    seen[axis.coordinate] = true;
    add_axis({axis.coordinate,
              axis.values.front(),
              axis.values[1] - axis.values[0],
              static_cast<long>(axis.values.size()),
              mod_angles ? coordinate.period : 0});
  }
  require(axes.size() == from_.size() && axes.size() <= kMostCoordinates,
          "a distance field has an axis for each coordinate, of which there are at most 8");
  set_strides();
  require(axes_.front().stride * axes_.front().count == std::ssize(field.action),
          "the field has other axes");
  distance_.reserve(field.action.size());
  for (const double action : field.action) {
    const bool known = std::isfinite(action);
    distance_.push_back(rounded_down(known ? std::sqrt(2 * action * problem.time) : 0));
  }
  find_deficits();
}

void DistanceField::add_axis(Axis axis) {
  const double size = std::abs(axis.step);
  axis.around =
      std::abs(size * static_cast<double>(axis.count) - axis.period) <= kRounded * axis.period &&
      axis.period > 0;
  axis.period = axis.around ? static_cast<double>(axis.count) : axis.period / size;
  axes_.push_back(axis);
}

void DistanceField::set_strides() {
  long stride = 1;
  for (std::size_t a = axes_.size(); a-- > 0;) {
    axes_[a].stride = stride;
    stride *= axes_[a].count;
  }
}

void DistanceField::find_deficits() {
  constexpr float kShare = 0.25;  // 2 / 8
  const long size = std::ssize(distance_);
  // The entry of point i, moved by so many steps along an axis; the last one there is.
  const auto moved = [](const Axis& axis, long i, long steps) {
    const long at = i / axis.stride % axis.count;
    const long to = axis.around ? (at + steps + axis.count) % axis.count
                                : std::clamp(at + steps, 0L, axis.count - 1);
    return i + (to - at) * axis.stride;
  };
  deficit_.assign(size, 0);
  std::vector<float> bend(size);
  std::vector<float> largest(size);
  for (const Axis& axis : axes_) {
    for (long i = 0; i < size; ++i) {
      const long at = i / axis.stride % axis.count;
      const bool inside = axis.around || (at > 0 && at + 1 < axis.count);
      bend[i] =
          inside ? distance_[moved(axis, i, 1)] - 2 * distance_[i] + distance_[moved(axis, i, -1)]
                 : 0;
    }
    for (const Axis& along : axes_) {
      for (long i = 0; i < size; ++i) {
        largest[i] = 0;
        for (const long steps : {-1, 0, 1, 2}) {
          largest[i] = std::max(largest[i], bend[moved(along, i, steps)]);
        }
      }
      bend.swap(largest);
    }
    for (long i = 0; i < size; ++i) deficit_[i] = rounded_up(deficit_[i] + kShare * bend[i]);
  }
}

double DistanceField::lower_bound(std::span<const double> q) const {
  std::array<double, kMostCoordinates> share{};
  // Not set to zero: that would take longer than all the rest.
  std::array<long, 1U << kMostCoordinates> corner;
  std::array<double, 1U << kMostCoordinates> value;
  corner[0] = 0;
  std::size_t corners = 1;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const Axis& axis = axes_[a];
    double x = (q[axis.coordinate] - axis.first) / axis.step;
    if (!std::isfinite(x)) return 0;
    if (axis.period > 0) x -= std::floor(x / axis.period) * axis.period;
    const long last = axis.around ? axis.count - 1 : axis.count - 2;
    const auto most = static_cast<double>(axis.count - 1);
    if (!axis.around) {
      if (!(x >= -kRounded && x <= most + kRounded)) return 0;
      x = std::clamp(x, 0.0, most);
    }
    const long cell = std::min(static_cast<long>(x), last);
    share[a] = x - static_cast<double>(cell);
    const long next = cell + 1 < axis.count ? axis.stride : -cell * axis.stride;
    for (std::size_t k = 0; k < corners; ++k) {
      corner[k] += cell * axis.stride;
      corner[k + corners] = corner[k] + next;
    }
    corners *= 2;
  }
  for (std::size_t k = 0; k < corners; ++k) value[k] = distance_[corner[k]];
  for (std::size_t a = axes_.size(); a-- > 0;) {
    corners /= 2;
    for (std::size_t k = 0; k < corners; ++k)
      value[k] += share[a] * (value[k + corners] - value[k]);
  }
  return std::max(0.0, value[0] - deficit_[corner[0]]);
}

void DistanceField::write(const std::string& path) const {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(std::numeric_limits<double>::max_digits10);
  text << kFirstLine << "\nscene " << scene_ << "\nfrom";
  for (const double x : from_) text << ' ' << x;
  for (const Axis& axis : axes_) {
    text << "\naxis " << axis.coordinate << ' ' << axis.first << ' ' << axis.step << ' '
         << axis.count << ' ' << axis.period * std::abs(axis.step);
  }
  const std::string bytes = bytes_of(distance_);
  text << '\n';
  const std::uint64_t checksum = checksum_of(text.str() + bytes);
  text << "checksum " << checksum << '\n';
  std::ofstream file(path, std::ios::binary);
  file << text.str() << bytes;
  if (!file.flush()) throw std::runtime_error("cannot write '" + path + "'");
}

DistanceField DistanceField::read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read '" + path + "'");
  const auto require = [&](bool ok, const char* what) {
    if (!ok) throw std::runtime_error("'" + path + "' is no distance field: " + what);
  };
  std::string line;
  require(std::getline(file, line) && line == kFirstLine, "its first line is another one");
  std::string head = line + '\n';
  DistanceField field;
  std::uint64_t checksum = 0;
  bool last = false;
  while (!last && std::getline(file, line)) {
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string key;
    words >> key;
    if (key == "scene") {
      words >> field.scene_;
    } else if (key == "from") {
      for (double x = 0; words >> x;) field.from_.push_back(x);
    } else if (key == "axis") {
      Axis axis;
      words >> axis.coordinate >> axis.first >> axis.step >> axis.count >> axis.period;
      require(!words.fail() && axis.count >= 3 && axis.step != 0, "an axis cannot be read");
      field.add_axis(axis);
    } else if (key == "checksum") {
      last = static_cast<bool>(words >> checksum);
    }
    if (!last) head += line + '\n';
  }
  std::ostringstream rest;
  rest << file.rdbuf();
  const std::string bytes = rest.str();
  require(last && checksum_of(head + bytes) == checksum, "it is damaged");
  const auto n = static_cast<int>(field.from_.size());
  require(n > 0 && n <= kMostCoordinates && std::ssize(field.axes_) == n, "an axis is missing");
  field.distance_ = values_of(bytes);
  std::vector<bool> seen(n);
  long left = std::ssize(field.distance_);  // points, over the axes so far
  for (const Axis& axis : field.axes_) {
    require(axis.coordinate >= 0 && axis.coordinate < n && !seen[axis.coordinate],
            "an axis is of no coordinate, or of one that has an axis");
    seen[axis.coordinate] = true;
    require(left % axis.count == 0, "its size is another one");
    left /= axis.count;
  }
  require(left == 1, "its size is another one");
  field.set_strides();
  field.find_deficits();
  return field;
}

}  // namespace carnot
