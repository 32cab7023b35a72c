// Which part of the line of momenta a mesh has, in each direction.
//
// The farther out on the line of front/unit_momenta.h, the faster extremals turn, and the earlier
// they are conjugate. What is conjugate by a time T is no shortest path there. So a sphere of
// length T needs no more of the line of each direction than what is not conjugate by then.
//
// Beside the direction of an abnormal curve that part grows beyond all bounds: on the flat Martinet
// problem like the square of the logarithm of the angle between them. There ends change fast from
// direction to direction, and hardly along the line: middles of edges would make a thousand
// vertices where thirty are enough. So directions are added to the first mesh where their ends are
// too far apart.
#pragma once

#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/image_scale.h"
#include "carnot/shooting/front/unit_momenta.h"

namespace carnot::internal {

// A direction c, and what of its line a mesh has: w from low to high.
struct Column {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  double low = 0;
  double high = 0;
  bool added = false;  // between others
};

// Where the first mesh has vertices on a column.
inline constexpr int kPlacesOnColumn = 33;
UnitMomentum place_on(const Column& column, int i);

// Evenly spread directions in order, or the two that there are, with w from -bound to bound. They
// are in general position: none is that of an abnormal curve, whose neighbours have other cut
// times.
std::vector<Column> even_columns(const UnitMomenta& momenta, double bound);

// The least x from which on the extremals at the places (c, x w) of a side (c, w) are conjugate at
// `target`; infinite where it is above 2^doublings / target.
double bound_along(const Dynamics& dynamics,
                   const std::vector<double>& from,
                   const UnitMomenta& momenta,
                   double target,
                   const UnitMomentum& side,
                   int doublings);

// The same along an axis, to both sides of so many directions.
std::vector<double> bounds_along(const Dynamics& dynamics,
                                 const std::vector<double>& from,
                                 const UnitMomenta& momenta,
                                 double target,
                                 const Eigen::Vector2d& axis,
                                 int directions,
                                 int doublings,
                                 int threads);

// The least |w| beyond which all extremals are conjugate at `target`; infinite where there is none.
double conjugate_bound(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const UnitMomenta& momenta,
                       double target,
                       int threads);

// The one beyond which those of half of the directions are: beside an abnormal extremal others are
// so only far out. It is looked for up to a million turns in the target, since momenta that act by
// three brackets are as large as 40 over the square of a small length.
double median_conjugate_bound(const Dynamics& dynamics,
                              const std::vector<double>& from,
                              const UnitMomenta& momenta,
                              double target,
                              int threads);

// What the columns of a sphere are asked for.
struct ConjugateColumns {
  const Dynamics& dynamics;
  const std::vector<double>& from;
  const UnitMomenta& momenta;
  double target = 0;  // the time
  double edge = 0;    // how far apart the ends of neighbours may be, seen in `scale`
  int threads = 0;
};

// Even columns up to where extremals are conjugate at the target, with others between. Empty where
// some are not conjugate by then, however far out. The scale is measured on the ends of the even
// ones. Cost: some twenty conjugate times a column.
std::vector<Column> conjugate_columns(const ConjugateColumns& asked, ImageScale scale);

}  // namespace carnot::internal
