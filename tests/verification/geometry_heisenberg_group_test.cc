// Symplecticity, tangent and reversibility of every method that claims them, on heisenberg-group.
#include "testing/geometry_laws.h"

namespace carnot {
namespace {

class GeometryHeisenbergGroup : public ::testing::TestWithParam<std::string> {};

TEST_P(GeometryHeisenbergGroup, Holds) {
  using Scene = scenes::HeisenbergGroup;
  const Tableau<double> tableau = make_tableau(*find_method(GetParam()));
  test::expect_geometry_laws<Scene::kDof>(test::method_run<Scene>(tableau));
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         GeometryHeisenbergGroup,
                         ::testing::ValuesIn(test::geometric_methods()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace carnot
