// The form whose zeros are the caustic, and its singularities.
//
// On a surface of momenta p(u) of unit speed let T = dp/du, n x 2, and (X, P) = d(q, p)/dp(0) at
// the time t. Momenta along which the end does not move are tangent to the surface, for others
// change the length. So t is conjugate where
//
//   E(u, t) = T'P'X T,
//
// a symmetric 2 x 2 matrix since the plane of (X, P) is Lagrangian, has a kernel a. With E a = 0,
// the second derivative of the end along a, seen along P T a, is the cubic form
//
//   C(a) = sum_k a_k a' (dE/du_k) a,
//
// in which the derivative of T has no part, for a'T'P'X = 0. Where C(a) = 0 the kernel is tangent
// to the conjugate momenta: the caustic has a cusp (A3). Where E = 0 there are two kernels, an
// umbilic: hyperbolic (D4+) where C has one real line of zeros, elliptic (D4-) where it has three.
// These are three equations for (u, t), solved by Newton's method. Where the derivative D of C(a)
// along the kernel vanishes, too, the kernel is tangent to the cusp line, which has a cusp itself:
// a swallowtail (A4). D does not depend on the sign of a. Source: Arnold, Gusein-Zade & Varchenko,
// Singularities of Differentiable Maps I (1985), part III.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "carnot/shooting/front/unit_momenta.h"

namespace carnot::internal {

struct CausticForm {
  UnitMomentum at;
  double t = 0;
  Eigen::Vector2d kernel;              // a, of X T
  double other = 0;                    // the other singular value of X T, relative to |X| |T|
  double cubic = 0;                    // C(kernel)
  std::vector<double> kernel_momenta;  // T kernel, along which the end does not move
};

// At a conjugate time t. Nothing where a flow fails.
std::optional<CausticForm> caustic_form(const Dynamics& dynamics,
                                        const std::vector<double>& from,
                                        const UnitMomenta& momenta,
                                        const UnitMomentum& at,
                                        double t);

// D at a momentum of a cusp line. NaN where a flow fails. Good to 1e-6.
double along_kernel(const Dynamics& dynamics,
                    const std::vector<double>& from,
                    const UnitMomenta& momenta,
                    const CausticForm& form);

using ConjugateTime = std::function<double(const UnitMomentum&)>;

struct Swallowtail {
  UnitMomentum at;
  double t = 0;
};

// From a momentum of a cusp line near it: Newton's method on C = 0 and D = 0 along the conjugate
// momenta. Good to 1e-6, since D comes from differences of differences. Nothing where it does not
// converge.
std::optional<Swallowtail> find_swallowtail(const Dynamics& dynamics,
                                            const std::vector<double>& from,
                                            const UnitMomenta& momenta,
                                            UnitMomentum at,
                                            const ConjugateTime& conjugate_time);

struct Umbilic {
  UnitMomentum at;
  double t = 0;
  bool hyperbolic = true;
  double residual = 0;  // of X T, relative to |X| |T|
};

// From a momentum and a time near it. Nothing where Newton's method does not converge.
std::optional<Umbilic> find_umbilic(const Dynamics& dynamics,
                                    const std::vector<double>& from,
                                    const UnitMomenta& momenta,
                                    UnitMomentum at,
                                    double t);

}  // namespace carnot::internal
