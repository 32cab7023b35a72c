// A sphere about the origin that a curve in space lies on, and what of its lines is near.
#pragma once

#include "carnot/plots/space_view.h"

namespace carnot::plots {

// Lines on a sphere, what is near and what is far; each point with its further numbers after the
// place. Without a sphere all is near.
struct Sides {
  Rows near;
  Rows far;

  void add(const SpaceView& view, const Rows& points, bool sphere);
};

// Meridians and parallels, every 30 degrees.
Sides sphere_grid(const SpaceView& view, double radius);

// The outline of the sphere: its points at right angles to the rays.
Rows sphere_outline(const SpaceView& view, double radius);

}  // namespace carnot::plots
