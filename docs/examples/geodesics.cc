// Geodesics of the Heisenberg group: found without a guess, followed along a line of targets, and
// used as a start for targets nearby.
#include <carnot/make_dynamics.h>
#include <carnot/scenes/heisenberg_group.h>
#include <carnot/shooting/continuation.h>
#include <carnot/shooting/find_geodesics.h>
#include <carnot/shooting/warm_start.h>

#include <iostream>
#include <vector>

int main() {
  const carnot::BoundaryValueProblem problem(
      carnot::make_dynamics(carnot::scenes::HeisenbergGroup{}), {0, 0, 0}, {0.5, 0, 0.5});

  // The two extremals of least action. The search is the same for any number of threads.
  carnot::GeodesicOptions options;
  options.count = 2;
  const carnot::GeodesicReport report = carnot::find_geodesics(problem, options);
  if (report.geodesics.size() < 2) {
    std::cerr << report.message << '\n';
    return 1;
  }
  for (const carnot::Geodesic& geodesic : report.geodesics) {
    std::cout << "action " << geodesic.action
              << (geodesic.label == carnot::Label::kLocallyMinimal ? ", locally minimal\n"
                                                                   : ", with a conjugate time\n");
  }

  // The second one, while the target moves down to z = 0. It turns back at a fold on the way.
  const carnot::ContinuationReport curve =
      carnot::continue_geodesic(carnot::moving_target(problem, {0.5, 0, 0}), report.geodesics[1]);
  for (const carnot::SpecialPoint& fold : curve.folds) {
    std::cout << "fold at z = " << 0.5 * (1 - fold.s) << '\n';
  }

  // The first one, bent to a target nearby in a few flows.
  const carnot::WarmStart warm_start(problem, report.geodesics[0].p0);
  const std::vector<double> target{0.5, 0.01, 0.5};
  std::vector<double> p0(3);
  if (!warm_start.solve(target.data(), p0.data()).converged) return 1;
  std::cout << "p0 (" << p0[0] << ", " << p0[1] << ", " << p0[2] << ")\n";
}
