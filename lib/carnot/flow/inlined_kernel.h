// Kernels that know their system: the compiler sees through each call of it.
#pragma once

#include <span>

#include "carnot/flow/kernel.h"
#include "carnot/step/rattle.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/tableau/make_tableau.h"

namespace carnot {

// Whether make_fixed_kernel() has the method: its stages fill one pack.
inline bool has_fixed_kernel(const Method& method) {
  return method.family == kGaussFamily && method.stages == kernel::kFixed;
}

// The default method, gauss16, with all that the compiler can do for it.
template <class System>
Kernel make_fixed_kernel(const Method& method, std::span<const double> periods) {
  using namespace kernel;
  using M = Direct<RungeKutta<System, kFixed>>;
  const Tableau<double> tableau = make_tableau(method);
  Kernel kernel = kernel_of(M{fixed_stages<kFixed>(tableau), winding_of<System::kDof>(periods)});
  add_automatic_flow<M>(tableau, kernel);
  if constexpr (PacksRates<System>) kernel.calls.adaptive_batch = adaptive_batch<M>;
  return kernel;
}

// Any Runge-Kutta method.
template <class System>
Kernel make_inlined_kernel(const Method& method, std::span<const double> periods) {
  using namespace kernel;
  if (has_fixed_kernel(method)) return make_fixed_kernel<System>(method, periods);
  using M = Direct<RungeKutta<System>>;
  const Tableau<double> tableau = make_tableau(method);
  Kernel kernel = kernel_of(M{tableau, winding_of<System::kDof>(periods)});
  add_automatic_flow<M>(tableau, kernel);
  return kernel;
}

// RATTLE and its compositions.
template <class System>
Kernel make_rattle_kernel(const Method& method, std::span<const double> periods) {
  using namespace kernel;
  using M = Direct<Rattle<System>>;
  return kernel_of(M{make_tableau(method), winding_of<System::kDof>(periods)});
}

}  // namespace carnot
