// Spheres of sections: closed, exact at each vertex, and nothing is nearer than searches tell.
#include "carnot/shooting/front/section_sphere.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/front/level_point.h"
#include "carnot/shooting/rays/ray.h"
#include "carnot/shooting/wavefront.h"
#include "shooting/problems.h"
#include "shooting/same_mesh.h"

namespace carnot::section_sphere_test {
namespace {

const std::vector<double> kOrigin(4, 0.0);
constexpr double kRoundOff = 1e-10;  // of flows, relative to widths of one

Dynamics vehicle() { return test::vehicle(kOrigin, kOrigin).dynamics; }

FrontOptions aligned() {
  FrontOptions options;
  options.what = FrontKind::kSphere;
  options.section = EndCondition{2, 3, 0};  // theta = phi
  options.edge = 0.5;
  return options;
}

double length_to(const std::vector<double>& q) {
  GeodesicOptions options;
  options.mod_angles = false;
  const GeodesicReport report = find_geodesics({vehicle(), kOrigin, q, 1}, options);
  return report.geodesics.empty() ? std::nan("") : std::sqrt(2 * report.geodesics[0].action);
}

// Each vertex is the end of an extremal of unit speed, in the section, and no way there is shorter.
// Where the section is cut, neighbours meet: the mesh has no border. All this in another unit of
// length, but for the searches.
TEST(SectionSphere, OfTheVehicleIsClosedAndExact) {
  constexpr double kUnit = 1e-3;
  const std::vector<double> units{kUnit, kUnit, 1, 1};
  const Dynamics dynamics = test::vehicle_in_units(kUnit);
  FrontOptions options = aligned();
  options.length = kUnit;
  const FrontMesh mesh = wavefront(dynamics, kOrigin, options);
  ASSERT_TRUE(mesh.finished);
  EXPECT_EQ(mesh.message, "");
  EXPECT_TRUE(mesh.closed);
  EXPECT_EQ(mesh.euler, 2);
  EXPECT_GT(mesh.volume, 0.011 * kUnit * kUnit);  // 0.0116 on a mesh of edges of 0.1
  EXPECT_LT(mesh.volume, 0.012 * kUnit * kUnit);
  ASSERT_GT(mesh.vertices.size(), 1000U);
  int seam = 0;
  for (const FrontVertex& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.q[2], vertex.q[3], kRoundOff);
    const internal::Ray ray(dynamics, kOrigin, vertex.p0);
    const std::vector<double> end = ray.at(kUnit, 2 * ray.enough_steps(kUnit));
    ASSERT_EQ(end.size(), 8U);
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(end[j], vertex.q[j], kRoundOff * units[j]);
    EXPECT_NEAR(internal::speed_of(dynamics, kOrigin, vertex.p0), 1, kRoundOff);
    // Shortest paths have none before their end.
    EXPECT_GE(vertex.conjugate_time, (1 - 1e-6) * kUnit);
    if (vertex.cut_time == kUnit) ++seam;
    EXPECT_EQ(vertex.cut_time == kUnit, is_maxwell(vertex.label));
  }
  EXPECT_GT(seam, 10);
  constexpr std::size_t kSearched = 20;
  for (std::size_t k = 0; k < kSearched; ++k) {
    std::vector<double> q = mesh.vertices[k * (mesh.vertices.size() - 1) / (kSearched - 1)].q;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] /= units[j];
    EXPECT_NEAR(length_to(q), 1, 1e-8) << k;
  }
}

void expect_cut_times(const FrontMesh& mesh) {
  CutTimeOptions search;
  search.max_time = 1.5;
  constexpr std::size_t kSearched = 6;
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const FrontVertex& vertex = mesh.vertices[k];
    EXPECT_GE(vertex.cut_time, 1);
    EXPECT_LE(vertex.cut_time, vertex.conjugate_time * (1 + kRoundOff));
    if (k % (mesh.vertices.size() / kSearched) != 0) continue;
    const CutTime cut = cut_time(vehicle(), kOrigin, vertex.p0, search);
    const double expected = cut.cut_time.value_or(std::numeric_limits<double>::infinity());
    if (vertex.cut_time != expected) {
      EXPECT_NEAR(vertex.cut_time, expected, 1e-8) << k;
    }
  }
}

TEST(SectionSphere, HasCutTimesThatNoNumberOfThreadsChanges) {
  FrontOptions options = aligned();
  options.edge = 1;
  options.section = EndCondition{0, -1, 0.9};  // x = 0.9, at the tip
  options.times = true;
  options.threads = 2;
  const FrontMesh one = wavefront(vehicle(), kOrigin, options);
  options.threads = 3;
  const FrontMesh other = wavefront(vehicle(), kOrigin, options);
  EXPECT_TRUE(one.closed);
  test::expect_the_same(one, other);
  for (std::size_t i = 0; i < one.vertices.size(); ++i) {
    EXPECT_EQ(one.vertices[i].cut_time, other.vertices[i].cut_time);
  }
  expect_cut_times(one);
}

TEST(SectionSphere, SaysWhereItIsOutOfReach) {
  FrontOptions options = aligned();
  options.edge = 1;
  options.section = EndCondition{0, -1, 1.5};  // x = 1.5
  const FrontMesh mesh = wavefront(vehicle(), kOrigin, options);
  EXPECT_TRUE(mesh.finished);
  EXPECT_FALSE(mesh.closed);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_THAT(mesh.message, testing::HasSubstr("as near as the length"));
}

TEST(SectionSphere, EndsWhenInterrupted) {
  FrontOptions options = aligned();
  options.progress = [](double) { return false; };
  EXPECT_FALSE(wavefront(vehicle(), kOrigin, options).finished);
}

// Straight on is the shortest way to (1, 0, 0, 0), with p = (1, 0, 0, 0).
TEST(LevelPoint, IsWhereExtremalsArriveInTime) {
  const Dynamics dynamics = vehicle();
  const internal::LevelProblem problem{dynamics, kOrigin, 1, Eigen::Vector4d::Ones()};
  const internal::Simplex side{{0.5, 0, 0, 0}, Eigen::Vector4d(2, 0, 0, 0)};
  internal::LevelPoint point{{Eigen::Vector4d(0.9, 0.1, -0.1, 0.05)}, Eigen::VectorXd(1)};
  point.s[0] = 0.3;
  ASSERT_TRUE(internal::settle(problem, side, point));
  EXPECT_NEAR(point.s[0], 0.25, kRoundOff);
  EXPECT_NEAR(point.p[0][0], 1, kRoundOff);
  EXPECT_NEAR(point.p[0].tail(3).norm(), 0, 1e-7);  // dq/dp is 1e-3 there
  EXPECT_NEAR(internal::excess_energy(problem, point.p[0]), 0, kRoundOff);
}

// Forwards first and backwards first to (0, y, 0, 0) are as short, and mirror images: on a face of
// places about the y axis both extremals meet on that axis.
TEST(LevelPoint, IsWhereTwoExtremalsAreAsShort) {
  const Dynamics dynamics = vehicle();
  GeodesicOptions options;
  options.count = 2;
  const GeodesicReport report = find_geodesics({dynamics, kOrigin, {0, 0.1, 0, 0}, 1}, options);
  ASSERT_EQ(report.geodesics.size(), 2U);
  const double length = std::sqrt(2 * report.geodesics[0].action);
  ASSERT_NEAR(std::sqrt(2 * report.geodesics[1].action), length, 1e-8);
  const internal::LevelProblem problem{dynamics, kOrigin, length, Eigen::Vector4d::Ones()};
  internal::Simplex face{{-0.02, 0.09, 0, 0}, Eigen::MatrixXd::Zero(4, 2)};
  face.sides(0, 0) = 0.04;
  face.sides(1, 1) = 0.02;
  internal::LevelPoint point;
  for (const Geodesic& one : report.geodesics) {
    point.p.emplace_back(internal::vector_of(one.p0) / length);
  }
  point.s = Eigen::Vector2d(0.48, 0.52);
  ASSERT_TRUE(internal::settle(problem, face, point));
  EXPECT_NEAR(point.s[0], 0.5, 1e-8);
  EXPECT_NEAR(point.s[1], 0.5, 1e-8);
  EXPECT_GT((point.p[0] - point.p[1]).norm(), 0.1);
}

}  // namespace
}  // namespace carnot::section_sphere_test
