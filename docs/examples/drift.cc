// A generalized Hamiltonian scene: a polarisable charge that drifts in a strong magnetic field.
//
// Without inertia the two coordinates of the charge are conjugate to each other, and its dipole
// moment w along x has no equation of motion at all. With z = (x, y, w),
//
//        ( 0 -b  0 )
//   J =  ( b  0  0 ),   H = k (x^2 + y^2)/2 - w E(x) + w^2/2 + w^4/4,   E(x) = sin x,
//        ( 0  0  0 )
//
// J z' = grad H reads -b y' = H_x, b x' = H_y and 0 = H_w: the charge drifts along the level lines
// of its energy, and w follows the field, w + w^3 = E(x). H_ww = 1 + 3 w^2 is never zero, so the
// index is one everywhere.
#include <carnot/make_dynamics.h>

#include <cmath>
#include <iostream>
#include <span>
#include <vector>

struct DriftingCharge {
  static constexpr int kSize = 3;  // length of z
  static constexpr int kDof = 1;   // half the rank of J; z has kSize - 2 kDof algebraic variables

  double field = 2;      // b
  double stiffness = 1;  // k

  template <class T>
  T hamiltonian(const carnot::Vector<T, 3>& z) const {
    using std::sin;
    const T half = 0.5;
    const T quarter = 0.25;
    const T w2 = z[2] * z[2];
    const T trap = half * stiffness * (z[0] * z[0] + z[1] * z[1]);
    return trap - z[2] * sin(z[0]) + half * w2 + quarter * w2 * w2;
  }

  carnot::Matrix<double, 3, 3> structure_matrix() const {
    carnot::Matrix<double, 3, 3> j;
    j << 0, -field, 0, field, 0, 0, 0, 0, 0;
    return j;
  }

  // Optional: z = T (q, p, y) with T'J T = (0 -1 0; 1 0 0; 0 0 0). Here q = x, p = b y, y = w.
  carnot::Matrix<double, 3, 3> darboux_basis() const {
    carnot::Matrix<double, 3, 3> t = carnot::Matrix<double, 3, 3>::Identity();
    t(1, 1) = 1 / field;
    return t;
  }
};

int main() {
  const DriftingCharge scene;
  const carnot::Dynamics dynamics = carnot::make_dynamics(scene, "gauss8");
  std::vector<double> z{1, 0};  // q = x and p = b y
  const carnot::FlowSummary summary =
      dynamics.monitored_flow(carnot::StepPlan::equal(0, 1000, 4000), z, {});
  if (!summary.completed()) {
    std::cerr << summary.report.reason() << '\n';
    return 1;
  }

  // The multipliers of such a scene are the variables in the kernel of J.
  std::vector<double> rate(1);
  std::vector<double> w(1);
  const std::span at(z);
  (void)dynamics.evaluate(1000, at.first(1), at.last(1), rate, w);
  std::cout << "x = " << z[0] << ", y = " << z[1] / scene.field << ", w = " << w[0] << '\n'
            << "energy drift below 1e-10: " << (summary.energy_drift < 1e-10 ? "yes" : "no")
            << '\n';
}
