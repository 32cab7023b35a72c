// Geodesics of scenes from text are those of their compiled twins: actions, momenta and labels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/shooting/find_geodesics.h"
#include "catalogue/scene_choice.h"

namespace carnot::text_scenes_test {
namespace {

struct Problem {
  std::string scene;
  std::vector<double> to;  // from the origin
  int count;
};

class TextGeodesics : public ::testing::TestWithParam<Problem> {};

TEST_P(TextGeodesics, AreThoseOfTheTwin) {
  const Problem& problem = GetParam();
  const std::vector<double> from(problem.to.size(), 0.0);
  const Dynamics text =
      make_dynamics(load_scene(CARNOT_SOURCE_DIR "/lib/carnot/scenes/" + problem.scene + ".scene"));
  const Dynamics twin = apps::find_scene(problem.scene).make({}, "gauss16");
  GeodesicOptions options;
  options.count = problem.count;
  const GeodesicReport found = find_geodesics({text, from, problem.to, 1}, options);
  const GeodesicReport known = find_geodesics({twin, from, problem.to, 1}, options);
  ASSERT_EQ(found.geodesics.size(), known.geodesics.size());
  ASSERT_FALSE(known.geodesics.empty());
  for (std::size_t i = 0; i < known.geodesics.size(); ++i) {
    const Geodesic& a = found.geodesics[i];
    const Geodesic& b = known.geodesics[i];
    EXPECT_NEAR(a.action, b.action, 1e-10 * b.action) << i;
    EXPECT_EQ(a.label, b.label) << i;
    EXPECT_EQ(a.morse_index, b.morse_index) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         TextGeodesics,
                         ::testing::Values(Problem{"vehicle", {0, 1, 0, 0}, 4},
                                           Problem{"unicycle", {1, 1, 0.5}, 3},
                                           Problem{"heisenberg-group", {0.5, 0, 0.3}, 3},
                                           Problem{"martinet", {1, 0.5, 0.3}, 2},
                                           Problem{"engel", {1, 0.5, 0.3, 0.2}, 2},
                                           Problem{"bicycle", {1, 1, 0, 0}, 2},
                                           Problem{"trailer2", {1, 1, 0, 0, 0}, 2},
                                           Problem{"satellite", {0.5, 0.3, 1}, 2},
                                           Problem{"falling-cat", {0.5, 0, 0}, 2}),
                         [](const auto& problem) {
                           std::string name = problem.param.scene;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace carnot::text_scenes_test
