// Symplecticity, tangent and reversibility of every method that claims them, on several scenes.
#include <string>
#include <tuple>

#include "testing/geometry_laws.h"
#include "testing/program_scenes.h"

namespace carnot::geometry_test {
namespace {

template <class Scene>
void expect_laws(const std::string& method) {
  const Dynamics dynamics = test::program_dynamics(test::uneven<Scene>(), method);
  test::expect_geometry_laws<Scene::kDof>(test::run_of<Scene::kDof>(dynamics));
}

struct SceneLaws {
  const char* name;
  void (*expect)(const std::string& method);
};

class Geometry : public ::testing::TestWithParam<std::tuple<SceneLaws, std::string>> {};

TEST_P(Geometry, Holds) {
  const auto& [scene, method] = GetParam();
  scene.expect(method);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes,
    Geometry,
    ::testing::Combine(
        ::testing::Values(SceneLaws{"vehicle", expect_laws<scenes::Vehicle>},
                          SceneLaws{"vehicle_cosine", expect_laws<scenes::VehicleCosine>},
                          SceneLaws{"heisenberg", expect_laws<scenes::Heisenberg>},
                          SceneLaws{"heisenberg_group", expect_laws<scenes::HeisenbergGroup>},
                          SceneLaws{"unicycle", expect_laws<scenes::Unicycle>}),
        ::testing::ValuesIn(test::geometric_methods())),
    [](const auto& of) { return std::get<0>(of.param).name + ("_" + std::get<1>(of.param)); });

}  // namespace
}  // namespace carnot::geometry_test
