#include "carnot/shooting/distance_field.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "shooting/problems.h"

namespace carnot::distance_field_test {
namespace {

constexpr double kPi = std::numbers::pi;

FieldAxis axis(int coordinate, double first, double last, int count) {
  FieldAxis axis{coordinate, {}};
  for (int i = 0; i < count; ++i) {
    axis.values.push_back(first + i * (last - first) / (count - 1));
  }
  return axis;
}

// From the origin of the Heisenberg group to (x, y, z) leads the arc of a circle over the chord
// (x, y), with the area |z| between them: of radius R and angle a,
//
//   chord = 2 R sin(a/2),   area = R^2 (a - sin a) / 2,   length = R a.
double heisenberg_distance(double x, double y, double z) {
  const double chord = std::hypot(x, y);
  const double area = std::abs(z);
  if (area == 0) return chord;
  double low = 0;
  double high = 2 * kPi;
  double radius = 0;
  for (int i = 0; i < 60; ++i) {
    const double a = 0.5 * (low + high);
    radius = std::sqrt(2 * area / (a - std::sin(a)));
    (2 * radius * std::sin(a / 2) > chord ? low : high) = a;
  }
  return radius * low;
}

const std::vector<FieldAxis> kAxes{axis(0, -2, 2, 21), axis(1, 2, -2, 21), axis(2, -1.5, 1.5, 21)};

Field exact_field() {
  Field field;
  field.finished = true;
  for (const double x : kAxes[0].values) {
    for (const double y : kAxes[1].values) {
      for (const double z : kAxes[2].values) {
        field.action.push_back(std::pow(heisenberg_distance(x, y, z), 2) / 2);
      }
    }
  }
  return field;
}

// Of T = 1, as the field.
DistanceField heisenberg() {
  return {test::heisenberg_group({0, 0, 0}), kAxes, false, exact_field()};
}

std::array<double, 3> random_point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = 2 * unit(random);
  const double y = 2 * unit(random);
  return {x, y, 1.5 * unit(random)};
}

// Below the closed form everywhere, the start and the axis, which is the cut locus, included; and
// not far below.
TEST(DistanceField, BoundsTheHeisenbergGroup) {
  constexpr int kPoints = 20000;
  const DistanceField field = heisenberg();
  std::mt19937_64 random(1);
  double loss = 0;
  for (int i = 0; i < kPoints; ++i) {
    std::array<double, 3> q = random_point(random);
    if (i % 4 == 0) q[0] = q[1] = 0;  // the axis
    if (i % 4 == 1)
      for (double& x : q) x *= 0.1;  // near the start
    const double exact = heisenberg_distance(q[0], q[1], q[2]);
    const double bound = field.lower_bound(q);
    ASSERT_LE(bound, exact) << q[0] << ' ' << q[1] << ' ' << q[2];
    if (i % 4 > 1) loss += (exact - bound) / exact / (kPoints / 2.0);
  }
  EXPECT_LT(loss, 0.05);
  EXPECT_GT(loss, 0.001);
}

TEST(DistanceField, IsTheDistanceAtPointsOfTheGridLessTheDeficit) {
  const DistanceField field = heisenberg();
  const double exact = heisenberg_distance(1.6, 1.6, 0);
  EXPECT_NEAR(field.lower_bound(std::vector{1.6, 1.6, 0.0}), exact, 0.05 * exact);
  EXPECT_EQ(field.lower_bound(std::vector{0.0, 0.0, 0.0}), 0);
  EXPECT_EQ(field.from(), (std::vector<double>{0, 0, 0}));
}

TEST(DistanceField, KnowsNothingBeyondTheGrid) {
  const DistanceField field = heisenberg();
  EXPECT_GT(field.lower_bound(std::vector{2.0, 2.0, 1.5}), 2);
  for (const double far : {2.01,
                           -2.01,
                           std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(field.lower_bound(std::vector{0.0, far, 1.0}), 0);
  }
}

// Unknown points have the bound 0, and so do the cells around them.
TEST(DistanceField, BoundsNothingWherePointsAreNotKnown) {
  Field field = exact_field();
  const auto hole = static_cast<std::size_t>((18 * 21 + 2) * 21 + 10);  // (1.6, 1.6, 0)
  field.action[hole] = std::numeric_limits<double>::quiet_NaN();
  const DistanceField holed(test::heisenberg_group({0, 0, 0}), kAxes, false, field);
  EXPECT_EQ(holed.lower_bound(std::vector{1.6, 1.6, 0.0}), 0);
  EXPECT_EQ(holed.lower_bound(std::vector{1.5, 1.55, 0.1}), 0);
}

// Modulo whole turns, and against searches.
TEST(DistanceField, BoundsUnicycles) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 0, 0});
  std::vector<FieldAxis> axes{
      axis(2, -kPi, kPi - kPi / 6, 12), axis(0, -2, 2, 11), axis(1, -2, 2, 11)};
  FieldOptions options;
  options.search.mod_angles = true;
  options.check = 0;
  const DistanceField field(problem, axes, true, solve_field(problem, axes, options));
  GeodesicOptions search = options.search;
  search.samples = 0;
  std::mt19937_64 random(3);
  for (int i = 0; i < 8; ++i) {
    std::array<double, 3> q = random_point(random);
    q[2] *= 2 * kPi / 1.5;
    const double bound = field.lower_bound(q);
    const double length = find_geodesics(test::unicycle({0, 0, 0}, {q[0], q[1], q[2]}), search)
                              .geodesics.at(0)
                              .length.value();
    EXPECT_LE(bound, length);
    EXPECT_GT(bound, 0.4 * length);
    q[2] += 2 * kPi;
    EXPECT_NEAR(field.lower_bound(q), bound, 1e-9);
  }
}

struct FieldFile : testing::Test {
  const std::string path =
      (std::filesystem::temp_directory_path() / "carnot_distance_field_test.field").string();
  void TearDown() override { std::filesystem::remove(path); }
  [[nodiscard]] std::string text() const {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void put(const std::string& text) const { std::ofstream(path, std::ios::binary) << text; }
};

TEST_F(FieldFile, ReadsWhatIsWritten) {
  const DistanceField field = heisenberg();
  field.write(path);
  const DistanceField read = DistanceField::read(path);
  EXPECT_EQ(read.scene(), field.scene());
  EXPECT_EQ(read.from(), field.from());
  std::mt19937_64 random(2);
  for (int i = 0; i < 100; ++i) {
    const std::array<double, 3> q = random_point(random);
    EXPECT_EQ(read.lower_bound(q), field.lower_bound(q));
  }
  read.write(path + "2");
  std::ifstream again(path + "2", std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(again), {}), text());
  std::filesystem::remove(path + "2");
}

TEST_F(FieldFile, RefusesWhatIsDamaged) {
  EXPECT_THROW(DistanceField::read(path), std::runtime_error);
  heisenberg().write(path);
  const std::string whole = text();
  for (const std::size_t at : {3U, 30U, 60U, 120U, 2000U}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    put(damaged);
    EXPECT_THROW(DistanceField::read(path), std::runtime_error) << at;
  }
  for (const std::size_t size : {0U, 20U, 100U, 5000U}) {
    put(whole.substr(0, size));
    EXPECT_THROW(DistanceField::read(path), std::runtime_error) << size;
  }
}

TEST(DistanceField, RefusesFieldsWithoutAllAxes) {
  const BoundaryValueProblem problem = test::heisenberg_group({0, 0, 0});
  const Field field = exact_field();
  const auto make = [&](std::vector<FieldAxis> axes, const Field& of) {
    return DistanceField(problem, axes, false, of);
  };
  EXPECT_NO_THROW(make(kAxes, field));
  EXPECT_THROW(make({kAxes[0], kAxes[1]}, field), std::invalid_argument);
  EXPECT_THROW(make({kAxes[0], kAxes[1], kAxes[1]}, field), std::invalid_argument);
  EXPECT_THROW(make({kAxes[0], kAxes[1], axis(2, 0, 1, 2)}, field), std::invalid_argument);
  EXPECT_THROW(make({kAxes[0], kAxes[1], axis(2, 0, 1, 20)}, field), std::invalid_argument);
  Field stopped = field;
  stopped.finished = false;
  EXPECT_THROW(make(kAxes, stopped), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::distance_field_test
