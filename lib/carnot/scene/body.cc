#include "carnot/scene/body.h"

#include <cmath>
#include <numbers>

namespace carnot {
namespace {

using Point = std::array<double, 3>;

constexpr double kTurn = 2 * std::numbers::pi;

// A point that is given in the axes of the body.
Point in_space(const Attitude& attitude, const Point& x) {
  Point point{};
  for (std::size_t i = 0; i < 3; ++i) {
    point[i] = x[0] * attitude[0][i] + x[1] * attitude[1][i] + x[2] * attitude[2][i];
  }
  return point;
}

// The visible parts of a line on the unit ball that is given at `count` parameters from 0 to 1.
template <class Line>
void add_visible(const Line& line,
                 int count,
                 const std::array<double, 2>& centre,
                 double radius,
                 std::vector<Polyline>& lines) {
  constexpr double kEdge = -1e-9;  // a line along the outline is visible
  Polyline part;
  const auto close = [&] {
    if (part.points.size() > 1) lines.push_back(part);
    part.points.clear();
  };
  for (int i = 0; i < count; ++i) {
    const Point point = line(static_cast<double>(i) / (count - 1));
    if (point[2] < kEdge) {
      close();
    } else {
      part.points.push_back({centre[0] + radius * point[0], centre[1] + radius * point[1]});
    }
  }
  close();
}

double norm(const Point& x) { return std::hypot(x[0], x[1], x[2]); }

}  // namespace

Attitude attitude_of_angles(double psi, double theta, double phi) {
  const double c1 = std::cos(psi);
  const double s1 = std::sin(psi);
  const double c2 = std::cos(theta);
  const double s2 = std::sin(theta);
  const double c3 = std::cos(phi);
  const double s3 = std::sin(phi);
  return {Point{c1 * c2, s1 * c2, -s2},
          Point{c1 * s2 * s3 - s1 * c3, s1 * s2 * s3 + c1 * c3, c2 * s3},
          Point{c1 * s2 * c3 + s1 * s3, s1 * s2 * c3 - c1 * s3, c2 * c3}};
}

Attitude attitude_of_quaternion(const double* q) {
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  Attitude r = {Point{w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)},
                Point{2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)},
                Point{2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z}};
  for (Point& axis : r) {
    for (double& component : axis) component /= square;
  }
  return r;
}

Polyline rectangle(const std::array<double, 2>& centre,
                   double heading,
                   double length,
                   double width) {
  const double dx = length / 2 * std::cos(heading);
  const double dy = length / 2 * std::sin(heading);
  const double nx = -width / 2 * std::sin(heading);
  const double ny = width / 2 * std::cos(heading);
  const auto& [x, y] = centre;
  return {Polyline::Role::kBody,
          {{x - dx, y - dy},  // the middle of a side, so that the line closes without a notch
           {x - dx - nx, y - dy - ny},
           {x + dx - nx, y + dy - ny},
           {x + dx + nx, y + dy + ny},
           {x - dx + nx, y - dy + ny},
           {x - dx, y - dy}}};
}

Polyline wheel(const std::array<double, 2>& centre, double heading, double radius) {
  const double dx = radius * std::cos(heading);
  const double dy = radius * std::sin(heading);
  const auto& [x, y] = centre;
  return {Polyline::Role::kWheel, {{x - dx, y - dy}, {x + dx, y + dy}}};
}

std::vector<Polyline> globe(const std::array<double, 2>& centre,
                            double radius,
                            const Attitude& attitude) {
  constexpr double kNorth = 0.45;  // radii in radians
  constexpr double kPrime = 0.2;
  constexpr int kCircle = 97;
  constexpr int kMeridian = 49;
  std::vector<Polyline> lines;
  const auto add = [&](const auto& line, int count) {
    add_visible(line, count, centre, radius, lines);
  };
  add([](double s) { return Point{std::cos(kTurn * s), std::sin(kTurn * s), 0}; }, kCircle);
  // The circle at a distance in radians from where the body axis `pole` leaves the ball.
  const auto circle = [&](std::size_t pole, double distance) {
    return [&attitude, pole, distance](double s) {
      Point x{};
      x[pole] = std::cos(distance);
      x[(pole + 1) % 3] = std::sin(distance) * std::cos(kTurn * s);
      x[(pole + 2) % 3] = std::sin(distance) * std::sin(kTurn * s);
      return in_space(attitude, x);
    };
  };
  const auto meridian = [&attitude](double s) {
    return in_space(attitude, {std::sin(kTurn / 2 * s), 0, std::cos(kTurn / 2 * s)});
  };
  add(circle(2, kTurn / 4), kCircle);
  add(circle(2, kNorth), kCircle);
  add(circle(0, kPrime), kCircle);
  add(meridian, kMeridian);
  return lines;
}

std::vector<SpaceLine> arrow_on_sphere(const std::array<double, 3>& place,
                                       const std::array<double, 3>& direction,
                                       double length) {
  constexpr int kShaft = 9;
  constexpr double kHead = 0.3;  // of the length
  constexpr double kHalfWidth = 0.15;
  const double radius = norm(place);
  const double size = norm(direction);
  // The point `along` the arrow and `across` to its left, in lengths of the arrow.
  const auto point = [&](double along, double across) {
    const double angle = along * length / radius;
    const Point left = {(place[1] * direction[2] - place[2] * direction[1]) / (radius * size),
                        (place[2] * direction[0] - place[0] * direction[2]) / (radius * size),
                        (place[0] * direction[1] - place[1] * direction[0]) / (radius * size)};
    Point at{};
    for (std::size_t i = 0; i < 3; ++i) {
      at[i] = std::cos(angle) * place[i] + radius * std::sin(angle) * direction[i] / size +
              across * length * left[i];
    }
    const double back = radius / norm(at);  // onto the sphere
    for (double& x : at) x *= back;
    return at;
  };
  SpaceLine shaft;
  for (int i = 0; i < kShaft; ++i) {
    shaft.points.push_back(point(static_cast<double>(i) / (kShaft - 1), 0));
  }
  const SpaceLine head{{point(1 - kHead, kHalfWidth), point(1, 0), point(1 - kHead, -kHalfWidth)}};
  return {shaft, head};
}

}  // namespace carnot
