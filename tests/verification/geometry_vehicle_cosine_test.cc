// Symplecticity, tangent and reversibility of the Gauss methods on vehicle-cosine.
#include "testing/geometry_laws.h"

namespace carnot {
namespace {

template <int s>
void check() {
  using Scene = scenes::VehicleCosine;
  test::expect_geometry_laws<Scene::kDof>(test::gauss_run<Scene, s>);
}

TEST(GeometryVehicleCosine, OneStage) { check<1>(); }
TEST(GeometryVehicleCosine, TwoStages) { check<2>(); }
TEST(GeometryVehicleCosine, ThreeStages) { check<3>(); }
TEST(GeometryVehicleCosine, FourStages) { check<4>(); }
TEST(GeometryVehicleCosine, FiveStages) { check<5>(); }
TEST(GeometryVehicleCosine, SixStages) { check<6>(); }
TEST(GeometryVehicleCosine, SevenStages) { check<7>(); }
TEST(GeometryVehicleCosine, EightStages) { check<8>(); }

}  // namespace
}  // namespace carnot
