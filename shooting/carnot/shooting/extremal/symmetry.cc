#include "carnot/shooting/extremal/symmetry.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/linear/round_off.h"

namespace carnot::internal {

void turn_plane(const Symmetries& of, double angle, double* x) {
  if (of.x < 0) return;
  const double u = x[of.x];
  const double v = x[of.y];
  x[of.x] = std::cos(angle) * u - std::sin(angle) * v;
  x[of.y] = std::sin(angle) * u + std::cos(angle) * v;
}

namespace {

// R D x, the linear part; x is a configuration without its angles' turn, or a momentum.
std::vector<double> linear(const Symmetries& of, const ProblemSymmetry& s, const double* x) {
  std::vector<double> y(s.mirror.size());
  for (std::size_t j = 0; j < y.size(); ++j) y[j] = s.mirror[j] * x[j];
  turn_plane(of, s.turn, y.data());
  return y;
}

// Whether the ends say by what motion of the plane one is mapped to the other. Where x, y or the
// angle that tells the turn is free they do not, and only maps without a motion are looked for.
bool tells_motion(const BoundaryValueProblem& problem) {
  const Symmetries& of = problem.dynamics.info.symmetries;
  std::vector<int> telling;
  if (of.x >= 0) telling = {of.x, of.y};
  if (!of.angles.empty()) telling.push_back(of.angles.front());
  return std::none_of(telling.begin(), telling.end(), [&](int j) {
    return problem.is_free_from(j) || problem.is_free_to(j);
  });
}

// Completes mirror and reversal to a map of `from` to the image of `from`; false when `to` is then
// not mapped to the image of `to`. The images are the start and `place`.
bool complete_map(const BoundaryValueProblem& problem,
                  const std::vector<double>& place,
                  double tolerance,
                  ProblemSymmetry& s) {
  const Symmetries& of = problem.dynamics.info.symmetries;
  const std::vector<double>& image_from = s.reverses ? place : problem.from;
  const std::vector<double>& image_to = s.reverses ? problem.from : place;
  const bool moved = tells_motion(problem);
  s.shift.assign(problem.from.size(), 0.0);
  if (moved && !of.angles.empty()) {
    const int j = of.angles.front();
    s.turn = image_from[j] - s.mirror[j] * problem.from[j];
  }
  for (const int j : of.angles) s.shift[j] = s.turn;
  const std::vector<double> first = linear(of, s, problem.from.data());
  if (moved && of.x >= 0) {
    s.shift[of.x] = image_from[of.x] - first[of.x];
    s.shift[of.y] = image_from[of.y] - first[of.y];
  }
  const std::vector<double> second = linear(of, s, problem.to.data());
  for (std::size_t j = 0; j < first.size(); ++j) {
    const double size = 1 + std::abs(image_from[j]) + std::abs(image_to[j]);
    const auto apart = [&](double a, double b) {
      return std::abs(a + s.shift[j] - b) > tolerance * size;
    };
    const int k = static_cast<int>(j);
    const bool free_from = problem.is_free_from(k);
    const bool free_to = problem.is_free_to(k);
    if (s.reverses && free_from != free_to) return false;
    if (!free_from && apart(first[j], image_from[j])) return false;
    if (!free_to && apart(second[j], image_to[j])) return false;
  }
  return true;
}

}  // namespace

std::vector<ProblemSymmetry> symmetries_of(const BoundaryValueProblem& problem) {
  return symmetries_onto(problem, problem.to, kSymmetryRoundOff);
}

std::vector<ProblemSymmetry> symmetries_onto(const BoundaryValueProblem& problem,
                                             const std::vector<double>& place,
                                             double tolerance) {
  std::vector<std::vector<double>> mirrors = problem.dynamics.info.symmetries.mirrors;
  mirrors.insert(mirrors.begin(), std::vector<double>(problem.from.size(), 1.0));
  std::vector<ProblemSymmetry> result;
  for (std::size_t i = 0; i < mirrors.size(); ++i) {
    for (const bool reverses : {false, true}) {
      if (i == 0 && !reverses) continue;
      if (reverses && !problem.dynamics.has_transcription()) continue;  // drift, magnetic fields
      ProblemSymmetry symmetry{mirrors[i], 0, {}, reverses};
      if (complete_map(problem, place, tolerance, symmetry)) result.push_back(symmetry);
    }
  }
  return result;
}

Knots partner(const SceneInfo& info, const ProblemSymmetry& symmetry, const Knots& knots) {
  const int n = knots.dof;
  Knots image{knots.segments, n, std::vector<double>(knots.z.size())};
  const double sign = symmetry.reverses ? -1 : 1;
  for (int i = 0; i <= knots.segments; ++i) {
    const double* z = knots.at(symmetry.reverses ? knots.segments - i : i);
    const std::vector<double> q = linear(info.symmetries, symmetry, z);
    const std::vector<double> p = linear(info.symmetries, symmetry, z + n);
    for (int j = 0; j < n; ++j) {
      image.at(i)[j] = q[j] + symmetry.shift[j];
      image.at(i)[n + j] = sign * p[j];
    }
  }
  return image;
}

Path partner(const SceneInfo& info, const ProblemSymmetry& symmetry, const Path& path) {
  Path image{path.intervals, path.dof, std::vector<double>(path.q.size()), {}, {}, path.rung};
  for (int i = 0; i <= path.intervals; ++i) {
    const int source = symmetry.reverses ? path.intervals - i : i;
    const std::vector<double> q = linear(info.symmetries, symmetry, path.configuration(source));
    for (int j = 0; j < path.dof; ++j) image.configuration(i)[j] = q[j] + symmetry.shift[j];
  }
  return image;
}

}  // namespace carnot::internal
