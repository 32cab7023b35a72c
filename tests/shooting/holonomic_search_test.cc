// Geodesics on manifolds of scenes from text, with labels, against closed forms and RATTLE.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "carnot/load_scene.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/search/drift_starts.h"
#include "catalogue/scene_choice.h"

namespace carnot::holonomic_search_test {
namespace {

constexpr double kPi = std::numbers::pi;

TextScene text(const std::string& name) {
  return load_scene(CARNOT_SOURCE_DIR "/lib/carnot/scenes/" + name + ".scene");
}

TEST(HolonomicSearch, GreatCirclesAreConjugateAtTheAntipode) {
  const Dynamics sphere = make_dynamics(text("spherical-pendulum").with({{"gravity", 0}}));
  constexpr double kAngle = 2;
  GeodesicOptions options;
  options.count = 2;
  const GeodesicReport report =
      find_geodesics({sphere, {1, 0, 0}, {std::cos(kAngle), std::sin(kAngle), 0}}, options);
  ASSERT_EQ(report.geodesics.size(), 2U) << report.message;
  const Geodesic& shorter = report.geodesics[0];
  const Geodesic& longer = report.geodesics[1];
  constexpr double kVerified = 1e-10;
  EXPECT_NEAR(shorter.length.value(), kAngle, kVerified);
  EXPECT_EQ(shorter.label, Label::kLocallyMinimal);
  EXPECT_EQ(shorter.abnormal, false);
  EXPECT_NEAR(longer.length.value(), 2 * kPi - kAngle, kVerified);
  EXPECT_EQ(longer.label, Label::kConjugatePassed);
  ASSERT_EQ(longer.conjugate_times.value().size(), 1U);
  constexpr double kTime = 1e-6;  // to which conjugate times are found
  EXPECT_NEAR(longer.conjugate_times->front(), kPi / (2 * kPi - kAngle), kTime);
  // p is that of RATTLE: tangent to the sphere.
  EXPECT_NEAR(shorter.p0[0], 0, kVerified);
  EXPECT_NEAR(shorter.p0[1], kAngle, kVerified);
}

TEST(HolonomicSearch, AgreesWithRattle) {
  const std::vector<double> from{0, 0, 1, 0};
  const std::vector<double> to{0.5, 1, 0.5, 2};
  const GeodesicReport found = find_geodesics({make_dynamics(text("rod-skate")), from, to});
  const Dynamics rattle = apps::find_scene("rod-skate").make({}, "rattle6");
  GeodesicOptions options;
  ASSERT_FALSE(found.geodesics.empty());
  options.guess = found.geodesics[0].p0;
  const GeodesicReport known = find_geodesics({rattle, from, to}, options);
  ASSERT_FALSE(known.geodesics.empty()) << known.message;
  constexpr double kVerified = 1e-9;
  EXPECT_NEAR(found.geodesics[0].action, known.geodesics[0].action, kVerified);
  for (int j = 0; j < 4; ++j) {
    EXPECT_NEAR(found.geodesics[0].p0[j], known.geodesics[0].p0[j], kVerified) << j;
  }
  EXPECT_EQ(found.geodesics[0].label, Label::kLocallyMinimal);
}

// The same extremals by RATTLE, whose tangents are those of the manifold itself.
void expect_the_same_labels(const std::string& scene,
                            const apps::ParameterValues& parameters,
                            const std::vector<double>& from,
                            const std::vector<double>& to,
                            double time) {
  GeodesicOptions options;
  options.count = 3;
  const GeodesicReport found =
      find_geodesics({make_dynamics(text(scene).with(parameters)), from, to, time}, options);
  const Dynamics rattle = apps::find_scene(scene).make(parameters, "rattle6");
  ASSERT_GE(found.geodesics.size(), 2U) << scene;
  for (const Geodesic& geodesic : found.geodesics) {
    GeodesicOptions guess;
    guess.guess = geodesic.p0;
    const GeodesicReport known = find_geodesics({rattle, from, to, time}, guess);
    ASSERT_FALSE(known.geodesics.empty()) << known.message;
    const Geodesic& same = known.geodesics[0];
    EXPECT_NEAR(same.action, geodesic.action, 1e-8 * (1 + std::abs(geodesic.action)));
    EXPECT_EQ(same.label, geodesic.label);
    EXPECT_EQ(same.abnormal, false);
    EXPECT_EQ(same.morse_index, geodesic.morse_index);
    ASSERT_TRUE(same.conjugate_times && geodesic.conjugate_times);
    ASSERT_EQ(same.conjugate_times->size(), geodesic.conjugate_times->size());
    for (std::size_t i = 0; i < same.conjugate_times->size(); ++i) {
      EXPECT_NEAR((*same.conjugate_times)[i], (*geodesic.conjugate_times)[i], 1e-6 * time);
    }
  }
}

TEST(HolonomicSearch, RattleHasTheSameConjugateTimes) {
  const double sine = std::sin(2.0);
  const double cosine = std::cos(2.0);
  expect_the_same_labels("spherical-pendulum", {{"gravity", 0}}, {1, 0, 0}, {cosine, sine, 0}, 1);
  expect_the_same_labels("spherical-pendulum", {}, {0, 0.6, -0.8}, {0.6, 0, -0.8}, 6);
  expect_the_same_labels("rod-skate", {}, {0, 0, 1, 0}, {0.5, 1, 0.5, 2}, 1);
}

// To a target of skate-on-sphere.
BoundaryValueProblem hard_to_find() {
  return {make_dynamics(text("skate-on-sphere")),
          {0.13904835122266784,
           -0.58048662143565866,
           -0.80230968980592043,
           -0.45112179264171554,
           0.68410125927123644,
           -0.57314448027284848},
          {-0.038776190983581121,
           0.96164835752485467,
           -0.2715305571801343,
           -0.83468916379069147,
           -0.18056281100304727,
           -0.52027980081209579}};
}

// Newton's method on the rotation, from 400 random momenta of the body, finds nothing lower. Of
// paths that are relaxed one in hundreds leads there; momenta do more often.
TEST(HolonomicSearch, MomentaFindWhatPathsMiss) {
  constexpr double kLeast = 10.415928634690527;
  int missed = 0;  // with 99 seeds of 100 it is found
  for (const std::uint64_t seed : {0, 1, 2, 3, 4}) {
    GeodesicOptions options;
    options.seed = seed;
    const GeodesicReport report = find_geodesics(hard_to_find(), options);
    ASSERT_FALSE(report.geodesics.empty()) << report.message;
    EXPECT_GE(report.geodesics[0].action, (1 - 1e-9) * kLeast) << seed;
    if (report.geodesics[0].action > (1 + 1e-9) * kLeast) ++missed;
  }
  EXPECT_LE(missed, 1);
}

// Memory is elsewhere in other threads, and the numbers are the same.
TEST(HolonomicSearch, DoesNotDependOnThreads) {
  GeodesicOptions options;
  options.starts = 24;
  options.threads = 1;
  const GeodesicReport one = find_geodesics(hard_to_find(), options);
  options.threads = 3;
  const GeodesicReport many = find_geodesics(hard_to_find(), options);
  ASSERT_EQ(one.geodesics.size(), many.geodesics.size());
  ASSERT_FALSE(one.geodesics.empty());
  EXPECT_EQ(one.geodesics[0].p0, many.geodesics[0].p0);
  EXPECT_EQ(one.geodesics[0].action, many.geodesics[0].action);
}

TEST(HolonomicSearch, DiscreteExtremalsStayOnTheManifold) {
  // h is of second order, so Dh (q_i + q_{i+1}) / 2 times the step is its change.
  const BoundaryValueProblem problem{
      make_dynamics(text("spherical-pendulum")), {0, 0, -1}, {0.6, 0, -0.8}};
  const internal::DriftStarts starts(problem, 0);
  int found = 0;
  for (int i = 0; i < 8; ++i) {
    const internal::RelaxedStart start = starts.start(i, 32);
    if (!start.found) continue;
    ++found;
    for (int node = 0; node <= 32; ++node) {
      const double* q = start.path.configuration(node);
      EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2], 1, 1e-9);
    }
  }
  EXPECT_GE(found, 4);
}

}  // namespace
}  // namespace carnot::holonomic_search_test
