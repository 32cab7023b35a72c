// A steering function: the questions that a planner asks of the geodesics between configurations.
#include <carnot/make_dynamics.h>
#include <carnot/scenes/unicycle.h>
#include <carnot/shooting/steering_function.h>

#include <iostream>
#include <vector>

int main() {
  const carnot::SteeringFunction steer(carnot::make_dynamics(carnot::scenes::Unicycle{}));
  const std::vector<double> a{0, 0, 0};
  const std::vector<double> b{1, 2, 0.5};

  // The length of the geodesic, and the configuration half-way along it in time.
  std::cout << "distance " << steer.distance(a, b) << '\n';
  std::vector<double> q(3);
  if (steer.interpolate(a, b, 0.5, q)) {
    std::cout << "half-way (" << q[0] << ", " << q[1] << ", " << q[2] << ")\n";
  }

  // One answer with all that is known of it, and the other ways from a to b.
  const carnot::Steering way = steer.steer(a, b);
  if (!way.found()) {
    std::cerr << way.message() << '\n';
    return 1;
  }
  for (const carnot::Steering& other : steer.alternatives(a, b, 3)) {
    std::cout << "a way of length " << other.distance() << '\n';
  }
}
