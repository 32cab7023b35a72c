#include "carnot/shooting/rays/pair_symmetry.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "carnot/shooting/extremal/symmetry.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

PairSymmetry symmetry_of_pair(const Ray& ray, double t, const Rival& rival) {
  constexpr double kSame = 1e-6;  // relative, of momenta
  constexpr double kEnds = 1e-9;  // of the ends, which are as good as the time is
  const long steps = ray.enough_steps(t);
  const BoundaryValueProblem problem = ray.problem(t, steps);
  const Knots knots = knots_of(problem, ray.p(), 1, steps);
  std::vector<double> place = problem.to;
  for (std::size_t j = 0; j < place.size(); ++j) {
    if (!rival.signs.empty()) place[j] *= rival.signs[j];
    place[j] += rival.offset[j];
  }
  for (const ProblemSymmetry& symmetry : symmetries_onto(problem, place, kEnds)) {
    const std::vector<double> image = partner(ray.dynamics().info, symmetry, knots).p0();
    double size = 0;
    for (const double x : image) size = std::max(size, std::abs(x));
    const int n = static_cast<int>(image.size());
    if (!(largest_difference(image.data(), rival.p.data(), n) <= kSame * size)) continue;
    const bool mirrors = std::any_of(
        symmetry.mirror.begin(), symmetry.mirror.end(), [](double d) { return d != 1; });
    if (!mirrors) return PairSymmetry::kReversal;
    return symmetry.reverses ? PairSymmetry::kMirrorAndReversal : PairSymmetry::kMirror;
  }
  return PairSymmetry::kNone;
}

}  // namespace carnot::internal
