// Sections by a condition on the ends: all of them is found, and vertices are on it.
#include "carnot/shooting/front/section_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "carnot/shooting/rays/ray.h"
#include "shooting/problems.h"

namespace carnot::internal::section_surface_test {
namespace {

const std::vector<double> kOrigin(4, 0.0);
constexpr EndCondition kAligned{2, 3, 0};  // theta = phi

Dynamics vehicle() { return test::vehicle(kOrigin, kOrigin).dynamics; }

// On the vehicle: momenta in units in which discs of radius 1 are enough, and their section.
class VehicleSection : public ::testing::Test {
 protected:
  VehicleSection() { momenta_.set_plane(plane_axes(dynamics_, kOrigin, momenta_, kLength, 2)); }
  [[nodiscard]] double excess_of(const UnitMomentum& place) const {
    const Ray ray(dynamics_, kOrigin, momenta_.momentum(place));
    const std::vector<double> z = ray.follow(kLength).z;
    return z[2] - z[3];
  }
  void expect_holes_at_the_rim_only(const Surface& surface) const;
  void expect_all_momenta(const Surface& surface) const;

  static constexpr double kLength = 1;
  Dynamics dynamics_ = vehicle();
  UnitMomenta momenta_{dynamics_, kOrigin, {}, true};
  EndSection section_{dynamics_, kOrigin, momenta_, kAligned, kLength, true};
};

double distance_of(const UnitMomentum& a, const UnitMomentum& b) {
  return std::hypot((a.c - b.c).norm(), (a.w - b.w).norm());
}

// The covector that annihilates both admissible directions and their bracket is that of the
// abnormal curve, along which extremals are conjugate last: at the origin (p_y, p_theta) = (-1, 1).
TEST_F(VehicleSection, ItsFirstAxisIsThatOfTheAbnormalCurve) {
  constexpr double kTold = 0.05;  // in radians: widths hardly differ within that
  const std::vector<double> far = momenta_.momentum({Eigen::Vector3d::Zero(), {1, 0}});
  const std::vector<double> across = momenta_.momentum({Eigen::Vector3d::Zero(), {0, 1}});
  EXPECT_LT(std::abs(far[1] + far[2]), kTold * std::hypot(far[1], far[2]));
  EXPECT_GT(std::hypot(far[1], far[2]), 10 * std::hypot(across[1], across[2]));
}

TEST_F(VehicleSection, PlacesAreThoseOfTheirMomenta) {
  constexpr double kRounding = 1e-13;
  const UnitMomentum place{{std::cos(0.7), std::sin(0.7), 0}, {0.3, -0.4}};
  EXPECT_LT(distance_of(momenta_.place(momenta_.momentum(place)), place), kRounding);
}

TEST_F(VehicleSection, NewtonsMethodLeadsToTheSection) {
  constexpr double kRoundOff = 1e-12;  // of the flow
  UnitMomentum place{{std::cos(0.4), std::sin(0.4), 0}, {0.1, 0.2}};
  ASSERT_GT(std::abs(excess_of(place)), 1e-3);
  const UnitMomentum before = place;
  ASSERT_TRUE(section_.settle(place));
  EXPECT_NEAR(excess_of(place), 0, kRoundOff);
  EXPECT_NEAR(place.c.norm(), 1, kRoundOff);
  EXPECT_LT(distance_of(place, before), 1);
}

// Its vertices are on the section, too.
void VehicleSection::expect_holes_at_the_rim_only(const Surface& surface) const {
  constexpr double kRoundOff = 1e-10;  // of places on edges, which are told to 1e-12 of them
  constexpr double kRim = 0.85;        // places of the rim move by less
  ASSERT_GT(surface.triangles.size(), 1000U);
  const std::vector<bool> border = surface.on_border();
  EXPECT_GT(std::count(border.begin(), border.end(), true), 0);
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    EXPECT_NEAR(excess_of(surface.vertices[i].place), 0, kRoundOff);
    if (border[i]) {
      EXPECT_GT(surface.vertices[i].place.w.norm(), kRim);
    }
  }
}

void VehicleSection::expect_all_momenta(const Surface& surface) const {
  constexpr double kSpacing = 0.3;  // of the lattice
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> angle(0, 2 * M_PI);
  std::uniform_real_distribution<double> in_disc(-0.6, 0.6);
  int settled = 0;
  for (int k = 0; k < 200; ++k) {
    const double phi = angle(engine);
    UnitMomentum place{{std::cos(phi), std::sin(phi), 0}, {in_disc(engine), in_disc(engine)}};
    if (!section_.settle(place) || place.w.norm() > 0.8) continue;
    ++settled;
    double nearest = 10;
    for (const SurfaceVertex& vertex : surface.vertices) {
      nearest = std::min(nearest, distance_of(vertex.place, place));
    }
    EXPECT_LT(nearest, kSpacing) << phi << ": " << place.w.transpose();
  }
  EXPECT_GT(settled, 100);
}

TEST_F(VehicleSection, IsWholeUpToTheRimOfTheDiscs) {
  const Surface surface = section_surface({dynamics_, kOrigin, momenta_, kLength, 0, 2}, section_);
  expect_holes_at_the_rim_only(surface);
  expect_all_momenta(surface);
}

// Where a lattice is too coarse, edges lead from one sheet to another, and what is between them is
// led to one of their ends. Of long edges 13 in 1,000 were such ones before edges of the lattice
// were split, and one of them is left.
TEST_F(VehicleSection, ItsEdgesStayOnOneSheet) {
  constexpr double kLong = 0.09;
  constexpr double kAside = 0.25;  // of an edge
  constexpr double kShare = 0.005;
  constexpr long kEvery = 12;  // all edges would take half a minute
  const Surface surface =
      section_surface({dynamics_, kOrigin, momenta_, kLength, kLength, 2}, section_);
  std::set<Edge> edges;
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) edges.insert(edge_of(t[k], t[(k + 1) % 3]));
  }
  long seen = 0;
  long looked_at = 0;
  long aside = 0;
  for (const auto& [a, b] : edges) {
    const UnitMomentum& one = surface.vertices[a].place;
    const UnitMomentum& other = surface.vertices[b].place;
    const double length = distance_of(one, other);
    if (length < kLong || seen++ % kEvery != 0) continue;
    ++looked_at;
    const UnitMomentum middle = between(one, other, 0.5);
    UnitMomentum settled = middle;
    const bool near = section_.settle(settled) && distance_of(settled, middle) < kAside * length;
    if (!near) ++aside;
  }
  EXPECT_GT(looked_at, 900);
  EXPECT_LT(static_cast<double>(aside), kShare * static_cast<double>(looked_at));
}

// Angles that differ by whole turns agree, unless told otherwise.
TEST(EndSection, CountsWholeTurnsWhereAsked) {
  const Dynamics dynamics = vehicle();
  const UnitMomenta momenta(dynamics, kOrigin, {}, true);
  const std::vector<double> q{0.25, 0, 2 * M_PI + 0.5, 0.125};
  const auto excess = [&](const EndCondition& condition, bool mod_angles) {
    return EndSection(dynamics, kOrigin, momenta, condition, 1, mod_angles).excess(q.data());
  };
  constexpr double kRounding = 1e-15;
  EXPECT_NEAR(excess(kAligned, true), 0.375, kRounding);
  EXPECT_NEAR(excess(kAligned, false), 2 * M_PI + 0.375, kRounding);
  EXPECT_NEAR(excess({2, -1, 0.5}, true), 0, kRounding);
  EXPECT_NEAR(excess({0, -1, 0.5}, true), -0.25, kRounding);
  EXPECT_NEAR(excess({0, 3, 0.5}, true), -0.375, kRounding);
}

}  // namespace
}  // namespace carnot::internal::section_surface_test
