// A method of one's own, held to its laws.
//
// Crouzeix's diagonally implicit method of order 3 is not symplectic. The triple jump, three steps
// of the midpoint rule of which the second one goes back, is symplectic and of order 4.
#include <carnot/laws/laws.h>
#include <carnot/make_dynamics.h>
#include <carnot/scenes/vehicle.h>
#include <carnot/tableau/own_method.h>

#include <cmath>
#include <iostream>

int main() {
  const double g = (3 + std::sqrt(3.0)) / 6;
  const carnot::OwnMethod crouzeix =
      carnot::own_method({.name = "crouzeix", .a = {{g, 0}, {1 - 2 * g, g}}, .b = {0.5, 0.5}});

  const double out = 1 / (2 - std::cbrt(2.0));
  const double back = 1 - 2 * out;
  const carnot::OwnMethod jump =
      carnot::own_method({.name = "triple-jump",
                          .a = {{out / 2, 0, 0}, {out, back / 2, 0}, {out, back, out / 2}},
                          .b = {out, back, out}});

  const carnot::scenes::Vehicle vehicle;
  const carnot::PhaseStart start{0, {0, 0, 0.3, 0.2, 0.7, 0.7, 0.5, 0.2}};
  const carnot::ReferenceRun reference =
      carnot::reference_run(carnot::make_dynamics(vehicle), start, 2, 4096);
  for (const carnot::OwnMethod& own : {crouzeix, jump}) {
    const carnot::Dynamics dynamics = carnot::make_dynamics(vehicle, own);
    const double slope = carnot::measure_order(dynamics, reference).fit.slope;
    const double defect = carnot::measure_symplecticity(dynamics, start, 0.1, 20);
    std::cout << own.method.name << ": order " << own.method.order << ", measured "
              << std::round(10 * slope) / 10 << ", M'JM - J "
              << (defect < 1e-13 ? "within round-off" : "broken") << '\n';
  }
}
