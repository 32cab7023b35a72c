// The first mesh of a section by a condition on the ends (front/end_section.h).
//
// The momenta, a circle times a plane, are filled with tetrahedra: discs about the origin of the
// plane, one for each direction of an even spread, and prisms between them, which are cut in three.
// A disc reaches out to where extremals are conjugate. Where the condition changes its sign along
// an edge it has a zero, and through the zeros of a tetrahedron there goes a triangle or a
// quadrangle: marching tetrahedra. Edges on which it vanishes twice are split first. Parts of the
// section that lie between the places of the lattice are not found.
#pragma once

#include "carnot/dynamics.h"
#include "carnot/shooting/front/end_section.h"
#include "carnot/shooting/front/surface.h"
#include "carnot/shooting/front/unit_momenta.h"

namespace carnot::internal {

// The plane of momenta as its lattice measures it: axes as long as extremals along them are not
// conjugate at the time. Extremals that start along an abnormal curve stay so up to momenta far out
// in one direction of the plane, which is the first axis. On the vehicle, at length 1, these axes
// are 130 and 5.6. Cost: some 400 conjugate times, ten times each.
Eigen::Matrix2d plane_axes(const Dynamics& dynamics,
                           const std::vector<double>& from,
                           const UnitMomenta& momenta,
                           double conjugate,
                           int threads);

struct SectionLattice {
  const Dynamics& dynamics;
  const std::vector<double>& from;
  const UnitMomenta& momenta;  // with the axes of their plane
  double length = 0;           // of the extremals
  double conjugate = 0;        // discs reach to what is conjugate by then; 0: they have radius 1
  int threads = 0;
};

// Without images. Cost: ten conjugate times in each of 1152 directions, 13872 extremals for the
// lattice, and 94512 for the middles of its edges.
Surface section_surface(const SectionLattice& lattice, const EndSection& section);

}  // namespace carnot::internal
