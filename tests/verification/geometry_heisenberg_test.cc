// Symplecticity, tangent and reversibility of every method that claims them, on heisenberg.
#include "testing/geometry_laws.h"

namespace carnot {
namespace {

class GeometryHeisenberg : public ::testing::TestWithParam<std::string> {};

TEST_P(GeometryHeisenberg, Holds) {
  using Scene = scenes::Heisenberg;
  const Tableau<double> tableau = make_tableau(*find_method(GetParam()));
  test::expect_geometry_laws<Scene::kDof>(test::method_run<Scene>(tableau));
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         GeometryHeisenberg,
                         ::testing::ValuesIn(test::geometric_methods()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace carnot
