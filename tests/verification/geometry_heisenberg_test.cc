// Symplecticity, tangent and reversibility of the Gauss methods on heisenberg.
#include "testing/geometry_laws.h"

namespace carnot {
namespace {

template <int s>
void check() {
  using Scene = scenes::Heisenberg;
  test::expect_geometry_laws<Scene::kDof>(test::gauss_run<Scene, s>);
}

TEST(GeometryHeisenberg, OneStage) { check<1>(); }
TEST(GeometryHeisenberg, TwoStages) { check<2>(); }
TEST(GeometryHeisenberg, ThreeStages) { check<3>(); }
TEST(GeometryHeisenberg, FourStages) { check<4>(); }
TEST(GeometryHeisenberg, FiveStages) { check<5>(); }
TEST(GeometryHeisenberg, SixStages) { check<6>(); }
TEST(GeometryHeisenberg, SevenStages) { check<7>(); }
TEST(GeometryHeisenberg, EightStages) { check<8>(); }

}  // namespace
}  // namespace carnot
