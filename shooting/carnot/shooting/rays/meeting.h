// Where another extremal arrives at the same place in the same time.
//
// Of a ray gamma, a rival is an extremal p1 from the same point with
//
//   q(t; p1) = S gamma(t) + w,     t (sqrt(2 H(p1)) - 1) = d,
//
// where w are whole periods of angles, S are signs, as of q and -q that are one rotation, and d is
// by how much the rival is longer. These are n + 1 equations for p1 and t. Along their solutions
// d(d)/dt = p1(t).gamma'(t) - 1 in units of speed 1, which is negative unless both arrive with one
// velocity: so t is a function of d as long as the rival has no conjugate time there, and d is
// taken to zero by continuation. At d = 0 both meet, and neither is the shortest any longer (a
// Maxwell point; Sachkov, ESAIM: COCV 16 (2010), sec. 3).
#pragma once

#include <optional>
#include <vector>

#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {

struct Rival {
  std::vector<double> p;       // at the start; runs in the time t
  std::vector<double> offset;  // w
  double t = 0;
  std::vector<double> signs{};  // S; empty: all are 1
};

// By how much the rival is longer, relative to t.
double excess_of(const Ray& ray, const Rival& rival);

// Whether both are one path: nowhere further apart than 1e-6 of its extent. Angles by which the
// rival has turned more do count.
bool same_path(const Ray& ray, const Rival& rival, long steps);

struct Meeting {
  Rival rival;       // at speed 1
  double error = 0;  // of t: what halving the step changes
};

// From a rival near the equations to one that solves them with d = 0. Nothing where the
// continuation fails, or both become one path.
std::optional<Meeting> meet(const Ray& ray, Rival rival, long steps);

// The first meeting shortly before a conjugate time. Near the edge of the cut locus the partner is
// a neighbour, and meets the ray so shortly before that no search tells. It lies on the branch of
// extremals that leaves the ray at the conjugate time along what the tangent flow does not move
// there. The branch is followed to both sides, along itself, until it is neither longer nor
// shorter; quickly to near where it is expected, where a distance of both momenta is. Of 54 such
// meetings on the vehicle, where two families are nearly conjugate at once, 48 are found; by its
// distance along the first direction the branch led to 23.
std::optional<Meeting> meet_neighbours(const Ray& ray, double conjugate_time, double expected = 0);

// Newton's method alone, for a rival that is near already; `steps` are enough.
bool polish_meeting(const Ray& ray, long steps, Rival& rival);

// Where a rival that meets the ray goes, to first order, when the ray gets another momentum: the
// derivative of the equations above by p0, with d kept. Nothing where a flow fails. Cost: two
// tangent flows.
std::optional<Rival> carried(const Ray& ray,
                             const Rival& rival,
                             const std::vector<double>& to,
                             long steps);

}  // namespace carnot::internal
