// Symplecticity, tangent and reversibility of the Gauss methods on vehicle.
#include "testing/geometry_laws.h"

namespace carnot {
namespace {

template <int s>
void check() {
  using Scene = scenes::Vehicle;
  test::expect_geometry_laws<Scene::kDof>(test::gauss_run<Scene, s>);
}

TEST(GeometryVehicle, OneStage) { check<1>(); }
TEST(GeometryVehicle, TwoStages) { check<2>(); }
TEST(GeometryVehicle, ThreeStages) { check<3>(); }
TEST(GeometryVehicle, FourStages) { check<4>(); }
TEST(GeometryVehicle, FiveStages) { check<5>(); }
TEST(GeometryVehicle, SixStages) { check<6>(); }
TEST(GeometryVehicle, SevenStages) { check<7>(); }
TEST(GeometryVehicle, EightStages) { check<8>(); }

}  // namespace
}  // namespace carnot
