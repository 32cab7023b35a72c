// Laws of RATTLE, told a scene beside its reduced form (reduced_scenes.h).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "carnot/flow/tangent_flow.h"
#include "carnot/numerics/line_fit.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/tableau/composition_tableau.h"
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
    Compensated<Square> matrix{Square::Identity(), Square::Zero()};
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
      Rate<double, m> rate{Vector<double, m>::Zero(), Vector<double, m>::Zero()};
      EXPECT_EQ(system.rate(0.0,
                            Vector<double, m>(z.template head<m>()),
                            Vector<double, m>(z.template tail<m>()),
                            y,
                            rate),
                RateStatus::kOk);
      Z z_dot;
      z_dot << rate.q_dot, rate.p_dot;
      return z_dot;
    };
    const double h = duration / kSteps;
    Z z;
    z << r, p;
    for (int i = 0; i < kSteps; ++i) {
      const Z k1 = f(z);
      const Z k2 = f(z + h / 2 * k1);
      const Z k3 = f(z + h / 2 * k2);
      const Z k4 = f(z + h * k3);
      z += h / 6 * (k1 + 2 * (k2 + k3) + k4);
    }
    return lift<Pair>(z.template head<m>(), z.template tail<m>());
  }
  // H, |h|, and |Dh q'| relative to p, whose rounding is that of q'.
  struct Measured {
    double energy = 0;
    double holonomic = 0;
    double hidden = 0;
  };
  [[gnu::noinline]] static Measured measure(const Phase& z) {
    const System system(Pair::kFull);
    const Vector<double, n> q = z.value.template head<n>();
    const Vector<double, n> p = z.value.template tail<n>();
    Vector<double, System::kAlgebraic> y = Vector<double, System::kAlgebraic>::Zero();
    Rate<double, n> rate;
    EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    const double size = std::max(1.0, p.cwiseAbs().maxCoeff());
    return {system.hamiltonian(0.0, q, p, y),
            holonomic_residual(Pair::kFull, q),
            hidden_residual(Pair::kFull, q, rate.q_dot) / size};
  }
};

template <class V>
double distance(const V& a, const V& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff());
}

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
    errors.push_back(distance(z.value, exact.value));
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
    EXPECT_LE(distance(z.value, Runs::exact_end(r, p, 1).value), kTolerance);
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
    const double scale = std::max(1.0, m.squaredNorm());
    typename Runs::Square projector;
    ASSERT_TRUE(manifold_projector(system, 0.0, start.value, projector));
    EXPECT_LE(manifold_symplecticity_defect(m, projector), kDefect * scale);
    const typename Runs::Square everywhere = Runs::Square::Identity();
    EXPECT_GT(manifold_symplecticity_defect(m, everywhere), 1e-3) << "no law off the manifold";
    ASSERT_TRUE(manifold_projector(system, 0.0, z.value, projector));
    EXPECT_LE((product(projector, m) - m).cwiseAbs().maxCoeff(), kDefect * scale);
    const double dimension = 2 * (Runs::n - Runs::Method::kHolonomic);
    EXPECT_NEAR(projector.trace(), dimension, kDefect) << "2(n - l)";
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
    const Vector<double, 2 * Runs::n> near = end(i, kStep) - end(i, -kStep);
    const Vector<double, 2 * Runs::n> far = end(i, 2 * kStep) - end(i, -2 * kStep);
    const Vector<double, 2 * Runs::n> column = (8 * near - far) / (12 * kStep);
    EXPECT_LE((column - m.col(i)).cwiseAbs().maxCoeff(), kTolerance) << "column " << i;
  }
}

// Steps of h, then of -h, are the identity; so is h, flip p, h, flip p.
template <class Runs>
void expect_reversible() {
  constexpr long kSteps = 20;
  // A rounding of h(q) is one of p by 1/h = 10; each step rounds; orbits part by |M| up to 100.
  constexpr double kTolerance = 1e4 * std::numeric_limits<double>::epsilon();
  Generator generator(5);
  for (const int order : {2, 4}) {
    const auto start = Runs::random_start(generator);
    auto z = start;
    ASSERT_TRUE(Runs::run(order, 2, kSteps, z).completed());
    auto back = z;
    ASSERT_TRUE(Runs::run(order, -2, kSteps, back).completed());
    EXPECT_LE(distance(back.value, start.value), kTolerance);
    auto flipped = z;
    flipped.value.template tail<Runs::n>() *= -1;
    flipped.compensation.template tail<Runs::n>() *= -1;
    ASSERT_TRUE(Runs::run(order, 2, kSteps, flipped).completed());
    flipped.value.template tail<Runs::n>() *= -1;
    EXPECT_LE(distance(flipped.value, start.value), kTolerance);
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
