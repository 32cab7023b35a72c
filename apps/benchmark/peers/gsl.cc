// The GNU Scientific Library, which is under the GPL.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <memory>

#include "benchmark/benchmark_rates.h"
#include "benchmark/peers/peer.h"

namespace carnot::apps {
namespace {

template <class Rate>
int gsl_rate(double /*t*/, const double* z, double* f, void* evaluations) {
  Rate{}(z, f);
  ++*static_cast<long*>(evaluations);
  return GSL_SUCCESS;
}

// A driver, and what it points to.
struct Driver {
  long evaluations = 0;
  gsl_odeiv2_system system{};
  std::unique_ptr<gsl_odeiv2_driver, decltype(&gsl_odeiv2_driver_free)> driver{
      nullptr, gsl_odeiv2_driver_free};
};

template <class Rate>
Peer make_peer(const char* name,
               const gsl_odeiv2_step_type* type,
               double duration,
               double tolerance) {
  constexpr double kFirstStep = 1e-3;  // the control makes it the right one
  const auto own = std::make_shared<Driver>();
  own->system = {gsl_rate<Rate>, nullptr, Rate::kSize, &own->evaluations};
  own->driver.reset(
      gsl_odeiv2_driver_alloc_y_new(&own->system, type, kFirstStep, tolerance, tolerance));
  const auto solve = [own, duration](double* z, const PeerObserver& observe) -> PeerEnd {
    own->evaluations = 0;
    gsl_odeiv2_driver* const driver = own->driver.get();
    gsl_odeiv2_driver_reset(driver);
    double t = 0;
    double h = kFirstStep;
    for (long step = 0; t < duration; ++step) {
      const int status = gsl_odeiv2_evolve_apply(
          driver->e, driver->c, driver->s, &own->system, &t, duration, &h, z);
      if (status != GSL_SUCCESS || step > kMostPeerSteps) return {false, own->evaluations};
      if (observe) observe(z);
    }
    return {true, own->evaluations};
  };
  return {name, solve};
}

}  // namespace

std::vector<Peer> gsl_peers(const BenchmarkTrajectory& trajectory, double tolerance) {
  gsl_set_error_handler_off();  // it would end the process
  return with_rate(trajectory.scene, [&](auto rate) -> std::vector<Peer> {
    using Rate = decltype(rate);
    const double duration = trajectory.duration;
    return {make_peer<Rate>("gsl-rk8pd", gsl_odeiv2_step_rk8pd, duration, tolerance),
            make_peer<Rate>("gsl-rkf45", gsl_odeiv2_step_rkf45, duration, tolerance),
            make_peer<Rate>("gsl-msadams", gsl_odeiv2_step_msadams, duration, tolerance)};
  });
}

}  // namespace carnot::apps
