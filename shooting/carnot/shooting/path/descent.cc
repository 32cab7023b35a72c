#include "carnot/shooting/path/descent.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include "carnot/shooting/path/discrete_equations.h"
#include "carnot/shooting/path/discrete_newton.h"

namespace carnot::internal {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

class Descent {
 public:
  Descent(const BoundaryValueProblem& problem, const Path& saddle)
      : problem_(problem),
        h_(problem.time / saddle.intervals),
        equations_(problem, saddle.intervals),
        matrix_(equations_.matrix()),
        walled_(in_one_chart(problem.dynamics, saddle)),
        extent_(extent_of(saddle)) {}

  [[nodiscard]] double action(const Path& path) const {
    return discrete_action(problem_.dynamics, h_, path);
  }

  // A direction of negative curvature, of the length of the path; nothing where there is none.
  [[nodiscard]] std::optional<std::vector<double>> downward(const Path& saddle) {
    // Curvatures are relative to B, which makes them 1 for fast wiggles.
    constexpr double kShifts[] = {0.3, 0.03};
    constexpr int kIterations = 12;
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::vector<double> w(equations_.size());
    for (double& x : w) x = normal(random);
    std::vector<double> bw;
    for (const double shift : kShifts) {
      equations_.evaluate(saddle, residual_, &matrix_, {1, shift});
      if (!matrix_.factor()) return std::nullopt;
      double curvature = 0;
      for (int i = 0; i < kIterations; ++i) {
        equations_.metric_product(saddle, w, bw);
        std::vector<double> next = bw;
        matrix_.substitute(next);
        clear(next, true);
        const double overlap = dot(next, bw);
        const double size = length(saddle, next);
        curvature = overlap / (size * size) - shift;
        for (std::size_t j = 0; j < w.size(); ++j) w[j] = extent_ * next[j] / size;
      }
      if (curvature < 0) return w;
    }
    return std::nullopt;
  }

  // A step from the saddle and back to the constraints, where that lowers the action.
  [[nodiscard]] std::optional<Path> aside(const Path& saddle,
                                          const std::vector<double>& direction,
                                          double sign) {
    constexpr double kSteps[] = {0.3, 0.1, 0.03, 0.01, 0.003};
    const double start = action(saddle);
    Path trial = saddle;
    for (const double step : kSteps) {
      equations_.move(saddle, direction, sign * step, trial);
      if (!restore(trial) || !(action(trial) < start)) continue;
      set_multipliers(trial);
      return trial;
    }
    return std::nullopt;
  }

  // Newton steps that lower the action, until nothing is left to gain.
  void descend(Path& path) {
    constexpr int kMaxIterations = 200;
    constexpr double kDone = 1e-13;   // gain relative to the action
    constexpr double kReach = 0.5;    // of the length of the path, longest step
    constexpr double kCurved = 1e-6;  // least curvature along a step
    constexpr double kArmijo = 1e-4;
    constexpr double kShortest = 0.1;
    constexpr double kFirst = 0.01;  // B that is added
    constexpr double kMost = 1e4;
    double reached = action(path);
    double added = 0;
    std::vector<double> direction;
    Path trial = path;
    for (int i = 0; i < kMaxIterations && added < kMost; ++i) {
      equations_.evaluate(path, residual_, &matrix_, {1, added});
      direction = residual_;
      bool accepted = false;
      if (matrix_.factor()) {
        matrix_.substitute(direction);
        double gain = 0;
        for (int j = 0; j < equations_.size(); ++j) {
          if (!equations_.is_multiplier(j)) gain += residual_[j] * direction[j];
        }
        if (std::abs(gain) <= kDone * std::abs(reached)) return;
        const double size = length(path, direction);
        if (added == 0 && gain < 0) {  // along a negative curvature the other way is down
          for (double& x : direction) x = -x;
          gain = -gain;
        }
        if (gain >= kCurved * size * size) {
          double step = std::min(1.0, kReach * extent_ / size);
          for (const double shortest = kShortest * step; step >= shortest; step *= 0.5) {
            equations_.move(path, direction, step, trial);
            if (!restore(trial)) continue;
            const double lower = action(trial);
            accepted = lower <= reached - kArmijo * step * gain;
            if (!accepted) continue;
            reached = lower;
            std::swap(path, trial);
            set_multipliers(path);
            break;
          }
        }
      }
      added = accepted ? (added > kFirst ? 0.3 * added : 0) : std::max(kFirst, 3 * added);
    }
  }

 private:
  // Sets the multipliers, or the nodes, to zero.
  void clear(std::vector<double>& x, bool multipliers) const {
    for (int j = 0; j < equations_.size(); ++j) {
      if (equations_.is_multiplier(j) == multipliers) x[j] = 0;
    }
  }
  // Sets the multipliers by which the constraints balance the slope of the action, as far as they
  // can, in the metric B.
  void set_multipliers(Path& path) {
    std::fill(path.lambda.begin(), path.lambda.end(), 0.0);
    std::vector<double> direction;
    equations_.evaluate(path, direction, &matrix_, {0, 1});
    if (!matrix_.solve(direction)) return;
    clear(direction, false);
    equations_.move(path, direction, 1, path);
  }
  // In the metric B at `path`.
  [[nodiscard]] double length(const Path& path, const std::vector<double>& direction) {
    equations_.metric_product(path, direction, product_);
    return std::sqrt(dot(direction, product_));
  }
  // The length of the path in the same metric, root of twice its kinetic energy.
  [[nodiscard]] double extent_of(const Path& path) const {
    const int n = problem_.dynamics.dof;
    std::vector<double> middle(n), v(n), terms(n + problem_.dynamics.transcribed + 1);
    double sum = 0;
    for (int i = 0; i < path.intervals; ++i) {
      for (int j = 0; j < n; ++j) {
        middle[j] = 0.5 * (path.configuration(i)[j] + path.configuration(i + 1)[j]);
        v[j] = (path.configuration(i + 1)[j] - path.configuration(i)[j]) / h_;
      }
      if (!problem_.dynamics.midpoint(middle, v, terms)) continue;
      for (int j = 0; j < n; ++j) sum += h_ * terms[j] * terms[j];
    }
    return std::sqrt(sum);
  }
  // The nearest path that satisfies the constraints, in the metric B. False when it is not reached.
  [[nodiscard]] bool restore(Path& path) {
    constexpr int kMaxIterations = 8;
    constexpr double kRestored = 1e-8;
    Path bare = path;  // without multipliers, which the constraints of control problems contain
    std::fill(bare.lambda.begin(), bare.lambda.end(), 0.0);
    std::vector<double> direction;
    for (int i = 0; i < kMaxIterations; ++i) {
      if (walled_ && !in_one_chart(problem_.dynamics, bare)) return false;
      equations_.evaluate(bare, direction, &matrix_, {0, 1});
      clear(direction, false);
      if (!matrix_.solve(direction)) return false;
      clear(direction, true);
      const double size = length(bare, direction);
      if (!(size < extent_)) return false;
      equations_.move(bare, direction, 1, bare);
      if (size > kRestored * extent_) continue;
      path.q = bare.q;
      return true;
    }
    return false;
  }

  const BoundaryValueProblem& problem_;
  double h_;
  DiscreteEquations equations_;
  BandedLu matrix_;
  bool walled_;
  double extent_;
  std::vector<double> residual_;
  std::vector<double> product_;
};

}  // namespace

std::vector<Path> ways_down(const BoundaryValueProblem& problem, const Path& saddle) {
  constexpr double kLower = 1e-9;  // relative
  std::vector<Path> paths;
  Descent descent(problem, saddle);
  const auto direction = descent.downward(saddle);
  if (!direction) return paths;
  const double start = descent.action(saddle);
  for (const double sign : {1.0, -1.0}) {
    auto path = descent.aside(saddle, *direction, sign);
    if (!path) continue;
    descent.descend(*path);
    DiscreteNewtonOptions newton;
    newton.max_iterations = 30;
    const bool found = tighten(problem, newton, *path).converged;
    if (found && descent.action(*path) < start - kLower * std::abs(start)) {
      paths.push_back(std::move(*path));
    }
  }
  return paths;
}

}  // namespace carnot::internal
