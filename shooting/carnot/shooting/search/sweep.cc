#include "carnot/shooting/search/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <span>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/path/path_lagrangian.h"
#include "carnot/shooting/problem/dilation.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/manifold.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {
double kinetic_energy(const BoundaryValueProblem& problem, const std::vector<double>& p) {
  const std::vector<double> zero(p.size(), 0.0);
  std::vector<double> velocity(p.size()), lambda(problem.dynamics.multipliers);
  const auto energy = [&](const std::vector<double>& at) {
    return problem.dynamics.evaluate(0, problem.from, at, velocity, lambda).hamiltonian;
  };
  return energy(p) - energy(zero);
}

namespace {

struct Draw {
  std::vector<double> x;  // unknowns of the start
  double miss = std::numeric_limits<double>::infinity();
};

// A random momentum at the start with a kinetic energy in the range; empty where there is none.
std::vector<double> draw_momentum(const BoundaryValueProblem& problem,
                                  const SweepOptions& options,
                                  std::mt19937_64& random) {
  const int n = problem.dynamics.dof;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(options.lowest, options.highest);
  std::vector<double> p(n);
  for (int j = 0; j < n; ++j) {
    p[j] = options.momentum_scale[j] * normal(random);
    if (problem.is_free_from(j)) p[j] = 0;
  }
  if (!(options.highest > 0)) {
    constexpr double kSmallest = 0.1;  // of the standard deviations
    constexpr double kLargest = 3;
    std::uniform_real_distribution<double> magnitude(std::log(kSmallest), std::log(kLargest));
    const double factor = std::exp(magnitude(random));
    for (double& x : p) x *= factor;
    return p;
  }
  if (!bring_to_manifold(problem, p)) return {};
  const double kinetic = kinetic_energy(problem, p);
  if (!(kinetic > 0)) return {};
  const double factor = std::sqrt(uniform(random) / kinetic);
  for (double& x : p) x *= factor;
  return p;
}

}  // namespace

std::vector<double> draw(const BoundaryValueProblem& problem, const SweepOptions& options, int i) {
  std::seed_seq sequence{options.seed,
                         options.seed >> 32U,
                         static_cast<std::uint64_t>(options.round),
                         static_cast<std::uint64_t>(i)};
  std::mt19937_64 random(sequence);
  if (!problem.has_free_ends()) return draw_momentum(problem, options, random);
  const std::vector<double> sizes(problem.from.size(), distance_between_ends(problem));
  const BoundaryValueProblem moved = with_ends_moved(problem, sizes, random);
  std::vector<double> z = moved.from;
  const std::vector<double> p = draw_momentum(moved, options, random);
  if (p.empty()) return {};
  z.insert(z.end(), p.begin(), p.end());
  return start_unknowns(problem, z.data());
}

namespace {

// How far an end is from the target. Where the target is near, coordinates of higher weight are
// much smaller than others; they are dilated first, so that all count alike.
class Miss {
 public:
  explicit Miss(const BoundaryValueProblem& problem) : problem_(problem) {
    constexpr double kNear = 0.1;  // gauge
    if (problem.has_free_ends()) return;
    if (problem.dynamics.has_transcription()) dilation_ = Dilation::at_start(problem);
    if (!dilation_) return;
    to_ = dilation_->coordinates(problem.to.data());
    const double gauge = dilation_->gauge(to_);
    if (gauge > 0 && gauge < kNear) {
      unit_ = 1 / gauge;
    } else {
      dilation_.reset();
    }
  }

  // Of the trajectory from one phase point to another.
  [[nodiscard]] double of(const double* start, const double* q) const {
    if (!dilation_) {
      const double* p = start + problem_.dynamics.dof;
      return carnot::internal::miss(problem_, q, length_per_momentum(problem_, p));
    }
    return dilation_->scaled(dilation_->coordinates(q) - to_, unit_).cwiseAbs().maxCoeff();
  }

 private:
  const BoundaryValueProblem& problem_;
  std::optional<Dilation> dilation_;
  Eigen::VectorXd to_;
  double unit_ = 1;
};

// Runs all of them at once and sets `miss`: infinite where the flow fails.
void run(const BoundaryValueProblem& problem,
         const SweepOptions& options,
         int threads,
         std::vector<Draw>& draws) {
  constexpr double kTolerance = 1e-4;  // only the order of the misses counts
  constexpr long kFewSteps = 16;       // enough to see where a trajectory goes
  // Where there is drift, a quarter of the intervals that follow it are.
  const long steps = problem.dynamics.has_transcription()
                         ? kFewSteps
                         : std::max(kFewSteps, options.intervals / 4L);
  const Dynamics& dynamics = problem.dynamics;
  const int n = dynamics.dof;
  const auto count = static_cast<int>(draws.size());
  std::vector<double> z;
  z.reserve(draws.size() * 2 * n);
  for (const Draw& draw : draws) {
    const std::vector<double> start = phase_point(problem, draw.x);
    z.insert(z.end(), start.begin(), start.end());
  }
  (void)(dynamics.has_adaptive_batch()
             ? dynamics.adaptive_batch(0, problem.time, kTolerance, count, z, threads)
             : dynamics.flow_batch(StepPlan::equal(0, problem.time, steps), count, z, threads));
  const Miss target(problem);
  for (int i = 0; i < count; ++i) {
    const std::vector<double> start = phase_point(problem, draws[i].x);
    const double miss = target.of(start.data(), &z[static_cast<std::size_t>(i) * 2 * n]);
    if (std::isfinite(miss)) draws[i].miss = miss;
  }
}

// The trajectory from x with its end pulled to the target, and its multipliers.
Path pulled(const BoundaryValueProblem& problem, const std::vector<double>& x, int intervals) {
  const Dynamics& dynamics = problem.dynamics;
  const int n = dynamics.dof;
  const int k = PathLagrangian::multipliers(dynamics);
  const Knots knots = knots_of(problem, x, intervals, intervals);
  Path path;
  path.intervals = intervals;
  path.dof = n;
  path.q.resize(static_cast<std::size_t>(intervals + 1) * n);
  path.lambda.resize(static_cast<std::size_t>(intervals) * k);
  path.p.resize(path.q.size());
  for (int i = 0; i <= intervals; ++i) {
    const double share = static_cast<double>(i) / intervals;
    for (int j = 0; j < n; ++j) {
      const double missing = problem.is_free_to(j) ? 0 : problem.to[j] - knots.at(intervals)[j];
      path.configuration(i)[j] = knots.at(i)[j] + share * missing;
      path.p[i * n + j] = knots.at(i)[n + j];
    }
  }
  for (int j = 0; j < n; ++j) {
    if (!problem.is_free_to(j)) path.configuration(intervals)[j] = problem.to[j];
  }
  std::vector<double> middle(2 * n);
  const std::span<const double> z(middle);
  for (int i = 0; i < intervals && k > 0; ++i) {
    for (int j = 0; j < 2 * n; ++j) middle[j] = 0.5 * (knots.at(i)[j] + knots.at(i + 1)[j]);
    const std::span<double> lambda = std::span(path.lambda).subspan(i * k, k);
    if (dynamics.has_transcription()) {
      dynamics.midpoint_multipliers(z.first(n), z.subspan(n), lambda);
    } else {
      std::copy(z.begin() + n, z.end(), lambda.begin());
    }
  }
  return path;
}

}  // namespace

std::vector<Path> near_hits(const BoundaryValueProblem& problem,
                            const SweepOptions& options,
                            int threads) {
  std::vector<Draw> draws(options.flows);
  parallel_for(options.flows, threads, [&](int i) { draws[i].x = draw(problem, options, i); });
  std::erase_if(draws, [](const Draw& draw) { return draw.x.empty(); });
  run(problem, options, threads, draws);
  std::stable_sort(
      draws.begin(), draws.end(), [](const Draw& a, const Draw& b) { return a.miss < b.miss; });
  const auto kept = std::min<std::size_t>(options.keep, draws.size());
  std::vector<Path> paths;
  for (std::size_t i = 0; i < kept && std::isfinite(draws[i].miss); ++i) {
    paths.push_back(pulled(problem, draws[i].x, options.intervals));
  }
  return paths;
}

}  // namespace carnot::internal
