// Pieces, handles and hollows of bodies on a grid.
#include "carnot/shooting/front/grid_topology.h"

#include <gtest/gtest.h>

#include <cmath>

namespace carnot::internal::grid_topology_test {
namespace {

// A grid of the cube from -1 to 1.
FieldGrid cube() {
  constexpr int kCount = 21;
  FieldGrid grid;
  grid.to = {0, 0, 0};
  for (int k = 0; k < 3; ++k) {
    FieldGrid::Axis axis{k, {}, false, 0};
    for (int i = 0; i < kCount; ++i) axis.values.push_back(2.0 * i / (kCount - 1) - 1);
    grid.axes.push_back(std::move(axis));
  }
  return grid;
}

// f(x, y, z) < 0 belongs to the body.
template <class F>
GridTopology topology_where(const F& f) {
  const FieldGrid grid = cube();
  return grid_topology(grid, [&](long i) {
    const std::vector<double> q = grid.target(i);
    return f(q[0], q[1], q[2]) < 0;
  });
}

double ball(double x, double y, double z) { return std::hypot(x, y, z) - 0.8; }
double torus(double x, double y, double z) { return std::hypot(std::hypot(x, y) - 0.6, z) - 0.25; }

TEST(GridTopology, OfABallIsOnePiece) {
  const GridTopology body = topology_where(ball);
  EXPECT_EQ(body.pieces, 1);
  EXPECT_EQ(body.euler, 1);
  EXPECT_EQ(body.handles(), 0);
}

TEST(GridTopology, SeesAHandle) {
  EXPECT_EQ(topology_where(torus).handles(), 1);
  EXPECT_EQ(topology_where([](double x, double y, double z) { return torus(z, x, y); }).handles(),
            1);
  // A ball with a hole through it.
  EXPECT_EQ(topology_where([](double x, double y, double z) {
              return std::max(ball(x, y, z), 0.3 - std::hypot(x, z));
            }).handles(),
            1);
}

TEST(GridTopology, SeesAHollow) {
  const GridTopology shell = topology_where(
      [](double x, double y, double z) { return std::abs(std::hypot(x, y, z) - 0.6) - 0.25; });
  EXPECT_EQ(shell.pieces, 1);
  EXPECT_EQ(shell.euler, 2);
}

TEST(GridTopology, CountsPieces) {
  const GridTopology two = topology_where(
      [](double x, double y, double z) { return std::hypot(std::abs(x) - 0.5, y, z) - 0.3; });
  EXPECT_EQ(two.pieces, 2);
  EXPECT_EQ(two.euler, 2);
  EXPECT_EQ(topology_where([](double, double, double) { return 1.0; }).pieces, 0);
}

}  // namespace
}  // namespace carnot::internal::grid_topology_test
