// The flow of a scene of the library, with a method chosen by its name.
//
// This is the trajectory of the Heisenberg problem in section 6 of the paper: 1000 steps of 0.1 by
// the midpoint rule.
#include <carnot/make_dynamics.h>
#include <carnot/scenes/heisenberg.h>

#include <iostream>
#include <vector>

int main() {
  const carnot::Dynamics dynamics = carnot::make_dynamics(carnot::scenes::Heisenberg{}, "midpoint");
  std::vector<double> z{0, 0, 0, 0.1, 0.3, 1};  // q, then p; the flow advances them in place
  const carnot::StepPlan plan = carnot::StepPlan::equal(0, 100, 1000);
  const carnot::FlowSummary summary = dynamics.monitored_flow(plan, z, {});
  if (!summary.completed()) {
    std::cerr << summary.report.reason() << '\n';
    return 1;
  }
  std::cout << "q = (" << z[0] << ", " << z[1] << ", " << z[2] << ")\n"
            << "energy drift " << summary.energy_drift << '\n'
            << "constraint error " << summary.constraint_error << '\n';
}
