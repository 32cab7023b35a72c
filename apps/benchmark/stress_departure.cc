// How long the vehicle stays on its unstable circle, in three precisions. Boost's float128 does not
// compile in strict mode, hence a file of its own.
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/float128.hpp>
#include <cmath>
#include <stdexcept>

#include "benchmark/stress_case.h"
#include "carnot/flow/flow.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/step/gauss.h"
#include "carnot/system/velocity_constraints.h"

namespace carnot::apps {
namespace {

constexpr double kFar = 0.1;
// A sixteenth: nodes are not rounded. Of 12 stages: below the round-off of quadruple precision.
constexpr double kStep = 1.0 / 16;
constexpr int kStages = 12;
constexpr double kLongest = 96;

// theta = t, phi = theta + pi/2, (x, y) = (cos theta, sin theta), and p is constant.
template <class T>
State<T, 4> circle(T t) {
  using std::acos;
  using std::cos;
  using std::sin;
  const Vector<T, 4> q(cos(t), sin(t), t, t + acos(T(-1)) / 2);
  const Vector<T, 4> p(T(0), T(0), T(2), T(1));
  return make_state<T, 4>(q, p);
}

template <class T>
double departure() {
  using System = VelocityConstraints<scenes::Vehicle>;
  const System system{scenes::Vehicle{}};
  Gauss<System, kStages, T> stepper(system);
  State<T, 4> z = circle<T>(T(0));
  const StepPlan plan = StepPlan::of_length(0, kLongest, kStep);
  return flow(stepper,
              plan,
              z,
              [&](long i, const auto&, const auto& node) {
                const Vector<T, 8> on = circle<T>(T(plan.time(i + 1))).value;
                for (int j = 0; j < 8; ++j) {
                  const T away = node.value[j] - on[j];
                  if (!(away < T(kFar) && -away < T(kFar))) return false;
                }
                return true;
              })
      .time_reached;
}

}  // namespace

double departure_from_circle(int bits) {
  switch (bits) {
    case 53:
      return departure<double>();
    case 64:
      return departure<long double>();
    case 113:
      return departure<boost::multiprecision::float128>();
    default:
      throw std::invalid_argument("departure_from_circle: bits must be 53, 64 or 113");
  }
}

}  // namespace carnot::apps
