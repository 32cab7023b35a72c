// Boost.odeint.
#include <algorithm>
#include <array>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/stepper/generation/make_controlled.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <stdexcept>

#include "benchmark/benchmark_rates.h"
#include "benchmark/peers/peer.h"

namespace carnot::apps {
namespace {

namespace odeint = boost::numeric::odeint;

template <class Rate, class Stepper>
Peer make_peer(const char* name, const Stepper& stepper, double duration) {
  constexpr double kFirstStep = 1e-2;
  using Point = std::array<double, Rate::kSize>;
  const auto solve = [stepper, duration](double* z, const PeerObserver& observe) -> PeerEnd {
    PeerEnd end;
    Point point;
    std::copy_n(z, Rate::kSize, point.begin());
    const auto rate = [&end](const Point& y, Point& f, double /*t*/) {
      constexpr long kStagesAtMost = 32;
      if (++end.evaluations > kStagesAtMost * kMostPeerSteps) throw std::runtime_error("too many");
      Rate{}(y.data(), f.data());
    };
    try {
      if (observe) {
        odeint::integrate_adaptive(
            stepper, rate, point, 0.0, duration, kFirstStep, [&](const Point& y, double /*t*/) {
              observe(y.data());
            });
      } else {
        odeint::integrate_adaptive(stepper, rate, point, 0.0, duration, kFirstStep);
      }
      end.completed = true;
    } catch (const std::runtime_error&) {  // of odeint: no step is small enough
      end.completed = false;
    }
    std::copy_n(point.begin(), Rate::kSize, z);
    return end;
  };
  return {name, solve};
}

}  // namespace

std::vector<Peer> odeint_peers(const BenchmarkTrajectory& trajectory, double tolerance) {
  return with_rate(trajectory.scene, [&](auto rate) -> std::vector<Peer> {
    using Rate = decltype(rate);
    using Point = std::array<double, Rate::kSize>;
    const double duration = trajectory.duration;
    return {make_peer<Rate>("odeint-rkf78",
                            odeint::make_controlled<odeint::runge_kutta_fehlberg78<Point>>(
                                tolerance, tolerance),
                            duration),
            make_peer<Rate>(
                "odeint-dopri5",
                odeint::make_controlled<odeint::runge_kutta_dopri5<Point>>(tolerance, tolerance),
                duration),
            make_peer<Rate>("odeint-bulirsch-stoer",
                            odeint::bulirsch_stoer<Point>(tolerance, tolerance),
                            duration)};
  });
}

}  // namespace carnot::apps
