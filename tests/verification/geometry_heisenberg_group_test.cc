// Symplecticity, tangent and reversibility of the Gauss methods on heisenberg-group.
#include "testing/geometry_laws.h"

namespace carnot {
namespace {

template <int s>
void check() {
  using Scene = scenes::HeisenbergGroup;
  test::expect_geometry_laws<Scene::kDof>(test::gauss_run<Scene, s>);
}

TEST(GeometryHeisenbergGroup, OneStage) { check<1>(); }
TEST(GeometryHeisenbergGroup, TwoStages) { check<2>(); }
TEST(GeometryHeisenbergGroup, ThreeStages) { check<3>(); }
TEST(GeometryHeisenbergGroup, FourStages) { check<4>(); }
TEST(GeometryHeisenbergGroup, FiveStages) { check<5>(); }
TEST(GeometryHeisenbergGroup, SixStages) { check<6>(); }
TEST(GeometryHeisenbergGroup, SevenStages) { check<7>(); }
TEST(GeometryHeisenbergGroup, EightStages) { check<8>(); }

}  // namespace
}  // namespace carnot
