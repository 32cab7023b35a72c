#include "carnot/shooting/problem/windings.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/problem/scales.h"

namespace carnot::internal {

std::vector<Image> images_of_target(const BoundaryValueProblem& problem, double max_length) {
  constexpr double kSlack = 1e-9;
  constexpr double kMostTurns = 3;
  const std::size_t n = problem.to.size();
  const std::vector<Coordinate>& coordinates = problem.dynamics.info.configuration;
  std::vector<double> per_metre(n, 0.0);
  if (problem.dynamics.has_transcription()) per_metre = start_scales(problem).per_metre;
  std::vector<Image> images{{problem.to, std::vector<int>(n, 0)}};
  for (std::size_t j = 0; j < n; ++j) {
    const double period = coordinates[j].period;
    const auto at = static_cast<int>(j);
    if (!(period > 0) || problem.is_free_from(at) || problem.is_free_to(at)) continue;
    double reach = 1;
    if (std::isfinite(max_length)) reach = std::max(reach, max_length * per_metre[j] / period);
    reach = std::min(reach, kMostTurns) + kSlack;
    const double turns = (problem.to[j] - problem.from[j]) / period;
    std::vector<Image> more;
    for (const Image& image : images) {
      for (double k = std::ceil(-reach - turns); k <= reach - turns; ++k) {
        more.push_back(image);
        more.back().to[j] = problem.to[j] + k * period;
        more.back().windings[j] = static_cast<int>(k);
      }
    }
    images = std::move(more);
  }
  const auto distance = [&](const Image& image) {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double step = image.to[j] - problem.from[j];
      sum += coordinates[j].period > 0 ? step * step : 0;
    }
    return sum;
  };
  std::stable_sort(images.begin(), images.end(), [&](const Image& a, const Image& b) {
    return distance(a) < distance(b);
  });
  if (images.size() > kMostImages) images.resize(kMostImages);
  return images;
}

}  // namespace carnot::internal
