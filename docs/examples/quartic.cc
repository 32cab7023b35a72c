// A Lagrangian scene: a particle in a trap whose kinetic energy is not quadratic.
//
//   L(t, q, v) = |v|^2/2 + |v|^4/4 - stiffness |q|^2/2,   q = (x, y).
//
// The momentum p = (1 + |v|^2) v has no simple inverse, so the velocity is an algebraic variable
// that Newton's method finds. There are no constraints here; those of `constraint(q, v)` need not
// be linear in v (lib/carnot/scenes/appell.h has one).
#include <carnot/laws/tangent_map.h>
#include <carnot/make_dynamics.h>

#include <iostream>
#include <vector>

struct QuarticParticle {
  static constexpr int kDof = 2;          // length of q
  static constexpr int kMultipliers = 0;  // number of constraints g(q, v) = 0

  double stiffness = 1;

  template <class T>
  T lagrangian(const T& /*t*/, const carnot::Vector<T, 2>& q, const carnot::Vector<T, 2>& v) const {
    const T half = 0.5;
    const T quarter = 0.25;
    const T speed2 = carnot::dot(v, v);
    const T trap = half * stiffness * carnot::dot(q, q);
    return half * speed2 + quarter * speed2 * speed2 - trap;
  }
};

int main() {
  const carnot::Dynamics dynamics = carnot::make_dynamics(QuarticParticle{}, "gauss6");

  // The momentum of a velocity at the start.
  const std::vector<double> q{1, 0};
  std::vector<double> v{0, 1};
  std::vector<double> p(2);
  dynamics.momentum(0, q, v, {}, p);
  std::cout << "p = (" << p[0] << ", " << p[1] << ")\n";

  // A long run keeps H: its error stays where it is.
  std::cout.precision(4);
  const std::vector<double> start{q[0], q[1], p[0], p[1]};
  for (const double duration : {10, 100, 1000}) {
    std::vector<double> z = start;
    const carnot::StepPlan plan = carnot::StepPlan::of_length(0, duration, 0.25);
    const carnot::FlowSummary summary = dynamics.monitored_flow(plan, z, {});
    if (!summary.completed()) return 1;
    std::cout << "to t = " << duration << ": energy drift " << summary.energy_drift << '\n';
  }

  // The derivative M of the flow is symplectic, M'JM = J, to round-off.
  const carnot::TangentMap map =
      carnot::tangent_along(dynamics, carnot::StepPlan::equal(0, 10, 40), start, {});
  std::cout << "M'JM = J " << (map.relative_defect < 1e-14 ? "holds" : "fails") << '\n';
}
