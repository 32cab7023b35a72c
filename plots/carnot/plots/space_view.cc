#include "carnot/plots/space_view.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "carnot/plots/instants.h"

namespace carnot::plots {
namespace {

using Point = std::array<double, 3>;

Interval extent(const SceneInfo& info, const std::vector<Curve>& curves, std::size_t axis) {
  constexpr std::size_t kAllAlong = 90;
  Interval values;
  for (const Curve& curve : curves) {
    const auto& q = curve.trajectory->q;
    for (const auto& row : q) values.include(path_point(info, row)[axis]);
    for (const std::size_t i : spread(q.size(), kAllAlong)) {
      for (const Row& point : body_points(info, q[i])) values.include(point[axis]);
    }
  }
  return values;
}

// A turn that has most of the paths on the near side of the sphere. None of them looks along an
// axis.
double best_turn(const SceneInfo& info, const std::vector<Curve>& curves) {
  constexpr double kMirrored = 90 - kTurn;
  double best = kTurn;
  double most = -1e300;
  for (const double quarter : {0.0, 90.0, 180.0, 270.0}) {
    for (const double turn : {quarter + kTurn, quarter + kMirrored}) {
      const double x = std::sin(turn * kDegree);  // towards the viewer
      const double y = -std::cos(turn * kDegree);
      double sum = 0;
      for (const Curve& curve : curves) {
        for (const auto& q : curve.trajectory->q) {
          const Row point = path_point(info, q);
          const double near = x * point[0] + y * point[1];
          if (std::isfinite(near)) sum += near;
        }
      }
      if (sum > most + 1e-9 * std::abs(most)) {
        most = sum;
        best = turn;
      }
    }
  }
  return best;
}

bool comparable(double a, double b) {
  constexpr double kComparable = 4;  // spans within this factor get one scale
  return std::max(a, b) <= kComparable * std::min(a, b);
}

}  // namespace

std::array<double, 3> corner_of_box(bool x, bool y, bool z) {
  return {x ? 0.5 : -0.5, y ? 0.5 : -0.5, z ? 0.5 : -0.5};
}

Row point_in_box(const SpaceFrame& frame, const Point& fractions) {
  Row point;
  for (std::size_t i = 0; i < 3; ++i) {
    const Axis& axis = frame.axes[i];
    point.push_back(axis.offset + axis.lower + (fractions[i] + 0.5) * axis.span());
  }
  return point;
}

SpaceFrame::SpaceFrame(const SceneInfo& info, const std::vector<Curve>& curves)
    : axes{Axis(extent(info, curves, 0)),
           Axis(extent(info, curves, 1)),
           Axis(extent(info, curves, 2))} {
  constexpr double kMargin = 1.1;
  constexpr double kMarginOfSphere = 1.12;  // numbers at the corners stay apart
  constexpr double kFlattest = 0.45;        // of the longer side of the floor
  constexpr double kFreeHeight = 0.8;
  sphere = info.drawing.sphere;
  if (sphere > 0) {
    const double radius = sphere;
    turn = best_turn(info, curves);
    Interval values;
    values.include(-radius);
    values.include(radius);
    for (Axis& axis : axes) values.include(axis.lower), values.include(axis.upper);
    for (Axis& axis : axes) {
      axis = Axis(values);
      axis.widen(kMarginOfSphere);
    }
    return;
  }
  for (Axis& axis : axes) axis.widen(kMargin);
  auto& [x, y, z] = axes;
  const double floor = std::max(x.span(), y.span());
  if (comparable(x.span(), y.span())) {
    x.widen_to(kFlattest * floor);
    y.widen_to(kFlattest * floor);
    drawn[0] = x.span() / floor;
    drawn[1] = y.span() / floor;
  }
  constexpr double kUnder = 0.15;  // the floor lies below the curve
  const bool same_unit = space_coordinate(info, 0).unit == space_coordinate(info, 2).unit;
  drawn[2] = kFreeHeight;
  if (same_unit && comparable(x.span(), y.span()) && comparable(floor, z.span())) {
    z.widen_to(kFlattest * floor);
    drawn[2] = (1 + kUnder) * z.span() / floor;
  }
  z.lower -= kUnder * z.span();
}

Coordinate space_coordinate(const SceneInfo& info, std::size_t axis) {
  if (info.drawing.place.at) return info.drawing.place.coordinates[axis];
  const auto i = static_cast<std::size_t>(info.drawing.axes[axis]);
  if (i < info.configuration.size()) return info.configuration[i];
  return {"q" + std::to_string(i + 1), "", 0};
}

SpaceView::SpaceView(const SpaceFrame& frame,
                     const Box& room,
                     double turn,
                     const std::array<double, 2>& turns)
    : frame_(frame), turn_(0) {
  constexpr int kTurns = 13;
  constexpr double kLeft = 66;  // numbers and label of the upright axis
  constexpr double kRight = 34;
  constexpr double kBelow = 40;
  constexpr double kAbove = 8;
  Interval right;
  Interval up;
  for (int i = 0; i < kTurns; ++i) {
    turn_ = (turns[0] + (turns[1] - turns[0]) * i / (kTurns - 1)) * kDegree;
    const auto include = [&](Point corner) {
      for (std::size_t j = 0; j < 3; ++j) corner[j] *= frame_.drawn[j];
      const Point seen = projected(corner);
      right.include(seen[0]);
      up.include(seen[1]);
    };
    for (const bool x : {false, true}) {
      for (const bool y : {false, true}) {
        include(corner_of_box(x, y, false));
        // Around a sphere only one of the upright edges at the sides is drawn.
        const bool aside = (x == near_upper(0)) != (y == near_upper(1));
        if (frame_.sphere == 0 || aside) include(corner_of_box(x, y, true));
      }
    }
  }
  if (frame_.sphere > 0) up.include(frame_.drawn[2] * frame_.sphere / frame_.axes[2].span());
  turn_ = turn * kDegree;
  scale_ = std::min((room.width - kLeft - kRight) / right.span(),
                    (room.height - kBelow - kAbove) / up.span());
  box_.width = right.span() * scale_ + kLeft + kRight;
  box_.height = up.span() * scale_ + kBelow + kAbove;
  box_.x = room.x + (room.width - box_.width) / 2;
  box_.y = room.y + (room.height - box_.height) / 2;
  middle_ = {box_.x + kLeft - right.lower * scale_, box_.y + kBelow - up.lower * scale_};
}

std::array<double, 3> SpaceView::projected(const Point& drawn) const {
  const double right = drawn[0] * std::cos(turn_) + drawn[1] * std::sin(turn_);
  const double back = -drawn[0] * std::sin(turn_) + drawn[1] * std::cos(turn_);
  const double c = std::cos(kElevation * kDegree);
  const double s = std::sin(kElevation * kDegree);
  return {right, drawn[2] * c + back * s, drawn[2] * s - back * c};
}

Row SpaceView::at(const Row& point) const {
  Point drawn{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Axis& axis = frame_.axes[i];
    drawn[i] = frame_.drawn[i] * ((axis.at(point[i]) - axis.lower) / axis.span() - 0.5);
  }
  const Point seen = projected(drawn);
  return {middle_[0] + scale_ * seen[0], middle_[1] + scale_ * seen[1]};
}

bool SpaceView::near(const Row& point) const {
  return projected({point[0], point[1], point[2]})[2] >= 0;
}

bool SpaceView::near_upper(std::size_t i) const {
  Point axis{};
  axis[i] = 1;
  return projected(axis)[2] > 0;
}

}  // namespace carnot::plots
