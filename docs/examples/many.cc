// The lengths of the geodesics of a unicycle to a hundred headings at the same place, on all cores.
#include <carnot/make_dynamics.h>
#include <carnot/scenes/unicycle.h>
#include <carnot/shooting/solve_many.h>

#include <algorithm>
#include <iostream>
#include <span>
#include <vector>

int main() {
  const carnot::Dynamics dynamics = carnot::make_dynamics(carnot::scenes::Unicycle{});
  const carnot::ManyProblems problems{
      100, [&](long i) {
        const double heading = 0.06 * static_cast<double>(i) - 3;
        return carnot::BoundaryValueProblem(dynamics, {0, 0, 0}, {0, 1, heading});
      }};
  std::vector<double> lengths(100);
  const bool done = carnot::solve_many(
      problems, {}, [&](long first, std::span<const carnot::GeodesicReport> reports) {
        for (const carnot::GeodesicReport& report : reports) {
          const bool found = !report.geodesics.empty();
          lengths[first++] = found ? report.geodesics[0].length.value_or(0) : 0;
        }
        return true;  // go on
      });
  std::cout << (done ? "" : "stopped, ") << "the longest is "
            << *std::max_element(lengths.begin(), lengths.end()) << '\n';
}
