#include "carnot/shooting/front/level_point.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {
namespace {

constexpr int kIterations = 12;
constexpr double kRoundOff =
    1e-9;  // of a width and a side: after such a step the next is round-off

Motion start_of(const LevelProblem& problem, const Eigen::VectorXd& p) {
  std::vector<double> z = problem.from;
  z.insert(z.end(), p.data(), p.data() + p.size());
  return motion_at(problem.dynamics, z.data());
}

// The end of an extremal, and how its momentum depends on that.
struct ReachedEnd {
  bool known = false;
  Eigen::VectorXd q;
  Eigen::MatrixXd inverse;  // dp(0)/dq(R)
};
ReachedEnd reached_by(const LevelProblem& problem, const Eigen::VectorXd& p, long steps) {
  const Ray ray(problem.dynamics, problem.from, numbers_of(p));
  const auto end = ray.end(problem.length, steps);
  if (!end) return {};
  const int n = problem.dynamics.dof;
  ReachedEnd found;
  found.q = Eigen::Map<const Eigen::VectorXd>(end->z.data(), n);
  found.inverse = lu_inverse(end->tangent.topRows(n));
  found.known = found.inverse.allFinite();
  return found;
}

long steps_for(const LevelProblem& problem, const Eigen::VectorXd& p) {
  return Ray(problem.dynamics, problem.from, numbers_of(p)).enough_steps(problem.length);
}

double size_of(const LevelProblem& problem, const Eigen::VectorXd& dq) {
  return dq.cwiseQuotient(problem.widths).cwiseAbs().maxCoeff();
}

}  // namespace

double excess_energy(const LevelProblem& problem, const Eigen::VectorXd& p) {
  return start_of(problem, p).hamiltonian - 0.5;
}

Eigen::MatrixXd momentum_by_end(const LevelProblem& problem, const Eigen::VectorXd& p) {
  ReachedEnd end = reached_by(problem, p, steps_for(problem, p));
  return end.known ? std::move(end.inverse) : Eigen::MatrixXd();
}

bool settle(const LevelProblem& problem, const Simplex& simplex, LevelPoint& point) {
  constexpr double kFarthest = 3;  // sides away from the corner
  const auto m = static_cast<Eigen::Index>(point.p.size());
  const Eigen::VectorXd corner = vector_of(simplex.corner);
  std::vector<long> steps;
  for (const Eigen::VectorXd& p : point.p) steps.push_back(steps_for(problem, p));
  for (int k = 0; k < kIterations; ++k) {
    std::vector<Eigen::MatrixXd> by_place(m);  // J^-1 D
    std::vector<Eigen::VectorXd> towards(m);   // J^-1 r
    Eigen::MatrixXd a(m, m);
    Eigen::VectorXd b(m);
    double missed = 0;
    for (Eigen::Index i = 0; i < m; ++i) {
      const ReachedEnd end = reached_by(problem, point.p[i], steps[i]);
      if (!end.known) return false;
      const Eigen::VectorXd r = end.q - corner - simplex.sides * point.s;
      missed = std::max(missed, size_of(problem, r));
      by_place[i] = end.inverse * simplex.sides;
      towards[i] = end.inverse * r;
      const Motion start = start_of(problem, point.p[i]);
      a.row(i) = start.velocity.transpose() * by_place[i];
      b[i] = start.velocity.dot(towards[i]) - (start.hamiltonian - 0.5);
    }
    const Eigen::VectorXd ds = lu_solve(a, b);
    if (!ds.allFinite()) return false;
    point.s += ds;
    for (Eigen::Index i = 0; i < m; ++i) point.p[i] += by_place[i] * ds - towards[i];
    if (!(point.s.cwiseAbs().maxCoeff() <= kFarthest)) return false;
    if (missed < kRoundOff && ds.cwiseAbs().maxCoeff() < kRoundOff) return true;
  }
  return false;
}

bool settle_end(const LevelProblem& problem,
                const std::vector<double>& target,
                Eigen::VectorXd& p) {
  const Eigen::VectorXd to = vector_of(target);
  const long steps = steps_for(problem, p);
  for (int k = 0; k < kIterations; ++k) {
    const ReachedEnd end = reached_by(problem, p, steps);
    if (!end.known) return false;
    const Eigen::VectorXd r = end.q - to;
    p -= end.inverse * r;
    if (size_of(problem, r) < kRoundOff) return true;
  }
  return false;
}

std::optional<Eigen::VectorXd> bring(const LevelProblem& problem,
                                     NearExtremal extremal,
                                     const Eigen::VectorXd& to) {
  constexpr double kShortest = 1.0 / 32;
  if (extremal.inverse.size() == 0) return std::nullopt;
  const Eigen::VectorXd from = extremal.q;
  double done = 0;
  double step = 1;
  while (done < 1) {
    const double next = std::min(1.0, done + step);
    Eigen::VectorXd there = extremal.p + extremal.inverse * ((next - done) * (to - from));
    if (settle_end(problem, numbers_of((1 - next) * from + next * to), there)) {
      extremal.p = std::move(there);
      done = next;
      if (done < 1) extremal.inverse = momentum_by_end(problem, extremal.p);
      if (extremal.inverse.size() == 0) return std::nullopt;
    } else {
      step *= 0.5;
      if (step < kShortest) return std::nullopt;
    }
  }
  return extremal.p;
}

std::optional<LevelPoint> lead(const LevelProblem& problem,
                               const Simplex& simplex,
                               const Eigen::VectorXd& s,
                               const std::vector<NearExtremal>& extremals) {
  const Eigen::VectorXd there = vector_of(simplex.corner) + simplex.sides * s;
  LevelPoint point{{}, s};
  for (const NearExtremal& one : extremals) {
    if (one.inverse.size() == 0) return std::nullopt;
    point.p.emplace_back(one.p + one.inverse * (there - one.q));
  }
  if (settle(problem, simplex, point)) return point;
  point = {{}, s};
  for (const NearExtremal& one : extremals) {
    auto brought = bring(problem, one, there);
    if (!brought) return std::nullopt;
    point.p.push_back(std::move(*brought));
  }
  return settle(problem, simplex, point) ? std::optional(std::move(point)) : std::nullopt;
}

}  // namespace carnot::internal
