// Symplecticity, tangent and reversibility of the Gauss methods on unicycle.
#include "testing/geometry_laws.h"

namespace carnot {
namespace {

template <int s>
void check() {
  using Scene = scenes::Unicycle;
  test::expect_geometry_laws<Scene::kDof>(test::gauss_run<Scene, s>);
}

TEST(GeometryUnicycle, OneStage) { check<1>(); }
TEST(GeometryUnicycle, TwoStages) { check<2>(); }
TEST(GeometryUnicycle, ThreeStages) { check<3>(); }
TEST(GeometryUnicycle, FourStages) { check<4>(); }
TEST(GeometryUnicycle, FiveStages) { check<5>(); }
TEST(GeometryUnicycle, SixStages) { check<6>(); }
TEST(GeometryUnicycle, SevenStages) { check<7>(); }
TEST(GeometryUnicycle, EightStages) { check<8>(); }

}  // namespace
}  // namespace carnot
