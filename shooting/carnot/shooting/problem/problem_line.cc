#include "carnot/shooting/problem/problem_line.h"

namespace carnot {
namespace {

// The ends themselves at s = 0 and s = 1.
double between(double a, double b, double s) { return (1 - s) * a + s * b; }

std::vector<double> between(const std::vector<double>& a, const std::vector<double>& b, double s) {
  std::vector<double> x(a.size());
  for (std::size_t j = 0; j < a.size(); ++j) x[j] = between(a[j], b[j], s);
  return x;
}

}  // namespace

ProblemLine moving_target(const BoundaryValueProblem& problem, const std::vector<double>& to) {
  return {[=](double s) {
            BoundaryValueProblem moved = problem;
            moved.to = between(problem.to, to, s);
            return moved;
          },
          true};
}

ProblemLine moving_start(const BoundaryValueProblem& problem, const std::vector<double>& from) {
  return {[=](double s) {
    BoundaryValueProblem moved = problem;
    moved.from = between(problem.from, from, s);
    return moved;
  }};
}

ProblemLine moving_time(const BoundaryValueProblem& problem, double time) {
  return {[=](double s) {
    BoundaryValueProblem moved = problem;
    moved.time = between(problem.time, time, s);
    return moved;
  }};
}

}  // namespace carnot
