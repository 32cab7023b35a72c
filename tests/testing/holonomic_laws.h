// Laws of RATTLE, told a scene beside its reduced form (reduced_scenes.h).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "carnot/flow/tangent_flow.h"
#include "carnot/numerics/line_fit.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/tableau/composition_tableau.h"
#include "testing/distance.h"
#include "testing/order.h"
#include "testing/random_points.h"
#include "testing/reduced_scenes.h"

namespace carnot::test {

// Everything that the laws need of one pair, each compiled once.
template <class Pair_>
struct HolonomicRuns {
  using Pair = Pair_;
  static constexpr int n = FullScene<Pair>::kDof;
  static constexpr int m = ReducedScene<Pair>::kDof;
  using System = VelocityConstraints<FullScene<Pair>>;
  using Method = Rattle<System>;
  using Phase = State<double, n>;
  using Square = Matrix<double, 2 * n, 2 * n>;

  // Attitudes and angles away from the singularities of the reduced coordinates (pi/2, or 0 for the
  // pendulum) for a time of 1.
  static void start(Generator& generator, Vector<double, m>& r, Vector<double, m>& p) {
    r = random_vector<m>(generator, 0.4);
    p = random_vector<m>(generator, 0.8);
    if (m == 2) r[0] += 1.2;
  }
  static Phase random_start(Generator& generator) {
    Vector<double, m> r;
    Vector<double, m> p;
    start(generator, r, p);
    return lift<Pair>(r, p);
  }

  // Equal steps of the composition of this order; `watch(z)` after each.
  [[gnu::noinline]] static FlowReport run(
      int order,
      double duration,
      long steps,
      Phase& z,
      const std::function<void(const Phase&)>& watch = [](const Phase&) {}) {
    const System system(Pair::kFull);
    const Tableau<double> tableau = composition_tableau<double>(order);
    Method method(system, tableau);
    const StepPlan plan = StepPlan::equal(0, duration, steps);
    return flow(method, plan, z, [&watch](long, const auto&, const Phase& node) {
      watch(node);
      return true;
    });
  }
  [[gnu::noinline]] static FlowReport tangent_run(
      int order, double duration, long steps, Phase& z, Square& derivative) {
    const System system(Pair::kFull);
    const Tableau<double> tableau = composition_tableau<double>(order);
    Method method(system, tableau);
    Compensated<Square> matrix{identity<2 * n, double>(), filled<2 * n, 2 * n>(0.0)};
    const auto go_on = [](long, const auto&, const auto&) { return true; };
    const FlowReport report =
        tangent_flow(method, StepPlan::equal(0, duration, steps), z, matrix, go_on);
    derivative = matrix.value;
    return report;
  }
  // The end of the reduced motion, in the full coordinates. By the classical explicit method of
  // order 4: another route, with an error of kSteps^-4.
  [[gnu::noinline]] static Phase exact_end(const Vector<double, m>& r,
                                           const Vector<double, m>& p,
                                           double duration) {
    constexpr int kSteps = 4000;
    using Reduced = VelocityConstraints<ReducedScene<Pair>>;
    using Z = Vector<double, 2 * m>;
    const Reduced system(Pair::kReduced);
    const auto f = [&system](const Z& z) {
      Vector<double, Reduced::kAlgebraic> y;
      Rate<double, m> rate{filled<m>(0.0), filled<m>(0.0)};
      EXPECT_EQ(system.rate(0.0, part<0, m>(z), part<m, m>(z), y, rate), RateStatus::kOk);
      Z z_dot;
      store(rate.q_dot, z_dot.data());
      store(rate.p_dot, z_dot.data() + m);
      return z_dot;
    };
    const auto moved = [](Z z, double time, const Z& slope) {
      for (int i = 0; i < 2 * m; ++i) z[i] += time * slope[i];
      return z;
    };
    const double h = duration / kSteps;
    Z z;
    store(r, z.data());
    store(p, z.data() + m);
    for (int i = 0; i < kSteps; ++i) {
      const Z k1 = f(z);
      const Z k2 = f(moved(z, h / 2, k1));
      const Z k3 = f(moved(z, h / 2, k2));
      const Z k4 = f(moved(z, h, k3));
      for (int j = 0; j < 2 * m; ++j) z[j] += h / 6 * (k1[j] + 2 * (k2[j] + k3[j]) + k4[j]);
    }
    return lift<Pair>(part<0, m>(z), part<m, m>(z));
  }
  // H, |h|, and |Dh q'| relative to p, whose rounding is that of q'.
  struct Measured {
    double energy = 0;
    double holonomic = 0;
    double hidden = 0;
  };
  [[gnu::noinline]] static Measured measure(const Phase& z) {
    const System system(Pair::kFull);
    const Vector<double, n> q = part<0, n>(z.value);
    const Vector<double, n> p = part<n, n>(z.value);
    Vector<double, System::kAlgebraic> y = filled<System::kAlgebraic>(0.0);
    Rate<double, n> rate;
    EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    const double size = std::max(1.0, largest_entry(p));
    return {system.hamiltonian(0.0, q, p, y),
            holonomic_residual(Pair::kFull, q),
            hidden_residual(Pair::kFull, q, rate.q_dot) / size};
  }
};

// Slope of the error against the reduced scene, which is as good as exact.
template <class Runs>
void expect_order(int order, const std::vector<long>& step_counts) {
  constexpr double kSlopeTolerance = 0.25;
  constexpr double kPlateau = 1e-13;  // round-off of a few hundred substeps
  constexpr double kCeiling = 1e-2;
  constexpr double kDuration = 1;
  Generator generator(1);
  Vector<double, Runs::m> r;
  Vector<double, Runs::m> p;
  Runs::start(generator, r, p);
  const auto exact = Runs::exact_end(r, p, kDuration);
  std::vector<double> steps;
  std::vector<double> errors;
  for (const long count : step_counts) {
    auto z = lift<typename Runs::Pair>(r, p);
    ASSERT_TRUE(Runs::run(order, kDuration, count, z).completed());
    steps.push_back(kDuration / static_cast<double>(count));
    errors.push_back(relative_distance(z.value, exact.value));
  }
  const LineFit fit = fit_order(steps, errors, kPlateau, kCeiling);
  EXPECT_GE(fit.points, 3);
  EXPECT_GT(fit.correlation, 0.99);
  EXPECT_NEAR(fit.slope, order, kSlopeTolerance);
}

template <class Runs>
void expect_same_motion_as_reduced() {
  // Order 8 with small steps is at round-off: 60 steps of 17 substeps.
  constexpr double kTolerance = 1e-12;
  Generator generator(2);
  for (int sample = 0; sample < 3; ++sample) {
    Vector<double, Runs::m> r;
    Vector<double, Runs::m> p;
    Runs::start(generator, r, p);
    auto z = lift<typename Runs::Pair>(r, p);
    ASSERT_TRUE(Runs::run(8, 1, 60, z).completed());
    EXPECT_LE(relative_distance(z.value, Runs::exact_end(r, p, 1).value), kTolerance);
  }
}

// M'JM = J on the tangent space of the manifold at the start, and M ends in that at the end.
template <class Runs>
void expect_symplectic_on_manifold() {
  constexpr double kDefect = 2e-14;  // about 100 eps, per |M|^2
  Generator generator(3);
  const typename Runs::System system(Runs::Pair::kFull);
  for (const int order : {2, 4}) {
    const auto start = Runs::random_start(generator);
    auto z = start;
    typename Runs::Square m;
    ASSERT_TRUE(Runs::tangent_run(order, 2, 20, z, m).completed());
    const double scale = std::max(1.0, std::pow(norm(m), 2));
    typename Runs::Square projector;
    ASSERT_TRUE(manifold_projector(system, 0.0, start.value, projector));
    EXPECT_LE(manifold_symplecticity_defect(m, projector), kDefect * scale);
    const typename Runs::Square everywhere = identity<2 * Runs::n, double>();
    EXPECT_GT(manifold_symplecticity_defect(m, everywhere), 1e-3) << "no law off the manifold";
    ASSERT_TRUE(manifold_projector(system, 0.0, z.value, projector));
    EXPECT_LE(largest_change(product(projector, m), m), kDefect * scale);
    const double dimension = 2 * (Runs::n - Runs::Method::kHolonomic);
    double trace = 0;
    for (int i = 0; i < 2 * Runs::n; ++i) trace += projector(i, i);
    EXPECT_NEAR(trace, dimension, kDefect) << "2(n - l)";
  }
}

// M against central differences of fourth order, also in directions that leave the manifold.
template <class Runs>
void expect_tangent_of_the_map() {
  constexpr double kStep = 1e-3;
  // Truncation kStep^4 and round-off eps/kStep below 1e-12, times derivatives of the map; off the
  // manifold those grow like 1/h^5.
  constexpr double kTolerance = 1e-7;
  Generator generator(4);
  const auto start = Runs::random_start(generator);
  const auto end = [&](int i, double d) {
    auto z = start;
    z.value[i] += d;
    EXPECT_TRUE(Runs::run(2, 0.5, 2, z).completed());
    return z.value;
  };
  auto z = start;
  typename Runs::Square m;
  ASSERT_TRUE(Runs::tangent_run(2, 0.5, 2, z, m).completed());
  for (int i = 0; i < 2 * Runs::n; ++i) {
    const auto right = end(i, kStep), left = end(i, -kStep);
    const auto far_right = end(i, 2 * kStep), far_left = end(i, -2 * kStep);
    for (int j = 0; j < 2 * Runs::n; ++j) {
      const double near = right[j] - left[j];
      const double far = far_right[j] - far_left[j];
      EXPECT_NEAR((8 * near - far) / (12 * kStep), m(j, i), kTolerance) << j << " by " << i;
    }
  }
}

// Steps of h, then of -h, are the identity; so is h, flip p, h, flip p.
template <class Runs>
void expect_reversible() {
  constexpr long kSteps = 20;
  // A rounding of h(q) is one of p by 1/h = 10; each step rounds; orbits part by |M| up to 100.
  constexpr double kTolerance = 1e4 * std::numeric_limits<double>::epsilon();
  const auto flip = [](auto& z) {
    for (int i = Runs::n; i < 2 * Runs::n; ++i) {
      z.value[i] *= -1;
      z.compensation[i] *= -1;
    }
  };
  Generator generator(5);
  for (const int order : {2, 4}) {
    const auto start = Runs::random_start(generator);
    auto z = start;
    ASSERT_TRUE(Runs::run(order, 2, kSteps, z).completed());
    auto back = z;
    ASSERT_TRUE(Runs::run(order, -2, kSteps, back).completed());
    EXPECT_LE(relative_distance(back.value, start.value), kTolerance);
    auto flipped = z;
    flip(flipped);
    ASSERT_TRUE(Runs::run(order, 2, kSteps, flipped).completed());
    flip(flipped);
    EXPECT_LE(relative_distance(flipped.value, start.value), kTolerance);
  }
}

// The largest |h| and hidden residual over a long run, whatever its length.
template <class Runs>
void expect_constraints_at_round_off(double h, long steps) {
  // Of h: sums of up to four squares below 2, each rounded. Of Dh q': twice as many products.
  constexpr double kTolerance = 32 * std::numeric_limits<double>::epsilon();
  Generator generator(6);
  auto z = Runs::random_start(generator);
  double holonomic = 0;
  double hidden = 0;
  const auto watch = [&](const auto& node) {
    const auto measured = Runs::measure(node);
    holonomic = std::max(holonomic, measured.holonomic);
    hidden = std::max(hidden, measured.hidden);
  };
  const double duration = h * static_cast<double>(steps);
  ASSERT_TRUE(Runs::run(2, duration, steps, z, watch).completed());
  EXPECT_LE(holonomic, kTolerance);
  EXPECT_LE(hidden, kTolerance);
}

// The energy error reaches its largest value early and forgets the time.
template <class Runs>
void expect_bounded_energy(double h, long steps) {
  Generator generator(7);
  auto z = Runs::random_start(generator);
  const double initial = Runs::measure(z).energy;
  std::vector<double> times;
  std::vector<double> errors;
  const auto watch = [&](const auto& node) {
    times.push_back(h * static_cast<double>(times.size() + 1));
    errors.push_back(Runs::measure(node).energy - initial);
  };
  const double duration = h * static_cast<double>(steps);
  ASSERT_TRUE(Runs::run(2, duration, steps, z, watch).completed());
  double early = 0;
  double all = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (i < errors.size() / 50) early = std::max(early, std::abs(errors[i]));
    all = std::max(all, std::abs(errors[i]));
  }
  EXPECT_GT(early, 1e-8) << "the step is too small to show anything";
  EXPECT_LE(all, 1.25 * early);
  EXPECT_LT(std::abs(fit_line(times, errors).slope) * duration, 0.05 * all);
}

}  // namespace carnot::test
