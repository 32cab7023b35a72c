// A scene from text in a program: what parking costs with a hook behind the axle.
#include <carnot/load_scene.h>
#include <carnot/shooting/find_geodesics.h>

#include <iostream>

int main() {
  const carnot::TextScene robot = carnot::load_scene("hooked.scene");
  for (const double hook : {0.0, 0.3, 0.6}) {
    const carnot::Dynamics dynamics = carnot::make_dynamics(robot.with({{"hook", hook}}));
    const carnot::GeodesicReport report =
        carnot::find_geodesics({dynamics, {0, 0, 0, 0}, {0, 1, 0, 0}, 1});
    if (report.geodesics.empty()) {
      std::cerr << report.message << '\n';
      return 1;
    }
    std::cout << "hook " << hook << ": action " << report.geodesics.front().action << '\n';
  }
}
